"""How alike two pictures are, as the references of the test scenes are judged.

Structural similarity (Wang et al., IEEE TIP 13(4), 2004; Gaussian window, sigma 1.5) of the
sRGB-encoded pictures, over all pixels and in the worst tile of a grid of 8 x 6, and the ratio of
their energies. scikit-image computes it: a package of development, not of the extension.
"""

import numpy as np

from addon.errors import InputError

_TILES = (6, 8)
# Of the structural similarity as published, for values of 0 to 1, and of its window.
_C1, _C2 = 0.01**2, 0.03**2
_SIGMA, _TRUNCATE = 1.5, 3.5


def read_picture(path):
    """Read the colour of an EXR file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    ndarray of shape (height, width, 3)
        Scene linear, top row first: channels R, G, B, or those of the first Combined pass.

    Raises
    ------
    InputError
        If the file has no such channels or is no EXR file.
    """
    import OpenEXR

    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            for part in file.parts:
                channels = part.channels
                prefixes = [name[:-1] for name in channels if name.endswith("Combined.R")]
                for prefix in ["", *sorted(prefixes)]:
                    if prefix + "R" in channels:
                        planes = [channels[prefix + letter].pixels for letter in "RGB"]
                        return np.stack(planes, axis=-1).astype(np.float64)
    except (RuntimeError, ValueError) as error:
        raise InputError(f"'{path}' is not a readable EXR file ({error})") from error
    raise InputError(f"'{path}' has no colour: neither channels R, G, B nor a Combined pass")


def srgb(linear):
    """Encode scene-linear values for viewing, clipped to 0..1."""
    x = np.clip(np.nan_to_num(np.asarray(linear, np.float64), posinf=1e6), 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def compare(picture, reference):
    """Compare a picture with a reference.

    Parameters
    ----------
    picture, reference : ndarray of shape (height, width, 3)
        Scene linear.

    Returns
    -------
    dict
        ``ssim_srgb``, ``ssim_tile``, ``energy``.

    Raises
    ------
    InputError
        If their sizes differ or scikit-image is missing.
    """
    try:
        from skimage.metrics import structural_similarity
    except ImportError as error:
        raise InputError(
            "comparing with a reference needs scikit-image, which only a checkout has"
            " (pip install scikit-image)"
        ) from error
    _check_size(picture, reference)
    mean, full = structural_similarity(
        srgb(picture),
        srgb(reference),
        data_range=1.0,
        channel_axis=2,
        gaussian_weights=True,
        sigma=_SIGMA,
        use_sample_covariance=False,
        full=True,
    )
    return _told(mean, full, picture, reference)


def compare_with_two(picture, first, second):
    """Compare a picture with what two noisy references have in common.

    Noise of a reference counts as unlikeness in `compare`: two pictures by Cycles with 512 samples
    each may be less alike than each is like ours. Here the reference's variance is the covariance
    of two references with independent noise, which the noise of neither is in, and the
    picture's covariance is that with their mean.

    Parameters
    ----------
    picture : ndarray of shape (height, width, 3)
        Scene linear.
    first, second : ndarray of shape (height, width, 3)
        Of the same lens with other seeds.

    Returns
    -------
    dict
        As of `compare`. Covariances are estimates: single tiles may come out above 1, and the mean
        too low by up to 0.01 where the noise of a reference is as large as 0.02 (sRGB).

    Raises
    ------
    InputError
        If sizes differ.
    """
    from scipy.ndimage import gaussian_filter

    _check_size(picture, first)
    _check_size(second, first)

    def mean_of(values):
        return gaussian_filter(values, (_SIGMA, _SIGMA, 0.0), truncate=_TRUNCATE)

    def covariance(one, other):
        return mean_of(one * other) - mean_of(one) * mean_of(other)

    seen, *truths = map(srgb, (picture, first, second))
    truth = 0.5 * (truths[0] + truths[1])
    means, held = (mean_of(seen), mean_of(truth)), covariance(*truths)
    full = (2.0 * means[0] * means[1] + _C1) * (2.0 * covariance(seen, truth) + _C2)
    full /= means[0] ** 2 + means[1] ** 2 + _C1
    full /= covariance(seen, seen) + np.maximum(held, 0.0) + _C2
    # As the usual measure, without pixels whose window is cut off.
    edge = int(_TRUNCATE * _SIGMA + 0.5)
    inner = full[edge:-edge, edge:-edge]
    return _told(inner.mean(), full, picture, 0.5 * (first + second))


def _check_size(picture, reference):
    if picture.shape != reference.shape:
        height, width = reference.shape[:2]
        raise InputError(
            f"the reference is {width} x {height} pixels; give --resolution {width}x{height}"
        )


def _told(mean, full, picture, reference):
    tiles = [
        block.mean()
        for row in _split(full, _TILES[0], 0)
        for block in _split(row, _TILES[1], 1)
        if block.size
    ]
    energy = np.nan_to_num(picture).sum(dtype=np.float64) / reference.sum(dtype=np.float64)
    return {"ssim_srgb": float(mean), "ssim_tile": float(min(tiles)), "energy": float(energy)}


def _split(array, count, axis):
    size = array.shape[axis]
    return np.split(array, [size * i // count for i in range(1, count)], axis=axis)
