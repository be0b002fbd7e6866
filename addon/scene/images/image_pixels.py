"""Pixels of Blender's images as Cycles keeps them, so that interpolation gives the same values.

8-bit pixels stay 8-bit; sRGB ones, of any depth, stay encoded, and colour is multiplied by alpha in
that encoding. Where an image is read from its file, the file's own numbers are taken: Blender has
multiplied them by alpha already.
"""

import numpy as np

from ...snapshot.surface_graph import LARGEST_RADIANCE
from . import color_spaces


def load_file(path):
    """Read the pixels of an image file as they are stored.

    Parameters
    ----------
    path : str

    Returns
    -------
    ndarray of shape (height, width, 4) or None
        Bottom row first: uint8, or float32 with colour as the file has it, multiplied by alpha or
        not. None where the file cannot be read.
    """
    import imbuf

    pixels = _load_float_file(path)
    return _load_with_blender(imbuf.load, path) if pixels is None else pixels


def load_packed(data):
    """Read the pixels of an image file's bytes, as `load_file` does.

    Parameters
    ----------
    data : bytes

    Returns
    -------
    ndarray of shape (height, width, 4) or None
    """
    import imbuf

    return _load_with_blender(imbuf.load_from_buffer, data)


def _load_float_file(path):
    """Read a file of more than 8 bits a channel; None for another one."""
    oiio = color_spaces.bundled_module("OpenImageIO")
    if oiio is None:
        return None
    hints = oiio.ImageSpec()
    hints["oiio:UnassociatedAlpha"] = 1
    source = oiio.ImageInput.open(path, hints)
    if source is None:
        # Nobody else asks for the message, and then it is printed at exit.
        oiio.geterror()
        return None
    try:
        spec = source.spec()
        if spec.format.basetype == oiio.UINT8 or spec.nchannels == 0:
            return None
        pixels = source.read_image("float")
        names = [name.rpartition(".")[2].upper() for name in spec.channelnames]
    finally:
        source.close()
    if pixels is None:
        return None
    pixels = np.asarray(pixels, np.float32).reshape(spec.height, spec.width, spec.nchannels)[::-1]
    if {"R", "G", "B"} <= set(names):
        chosen = [names.index(name) for name in "RGBA" if name in names]
        pixels = pixels[..., chosen]
    return with_four_channels(pixels[..., :4])


def _load_with_blender(load, source):
    try:
        buffer = load(source)
        with buffer.with_buffer() as view:
            pixels = np.array(view)
        buffer.free()
    except (OSError, ValueError, RuntimeError):
        return None
    return with_four_channels(pixels)


def read_pixels(image):
    """Read the pixels that Blender holds of an image.

    Parameters
    ----------
    image : bpy.types.Image

    Returns
    -------
    ndarray of shape (height, width, 4) or None
        uint8 in the image's encoding, straight; or float32, scene linear and, of a file, multiplied
        by alpha.
    """
    width, height = image.size
    if width == 0 or height == 0 or image.channels == 0:
        return None
    pixels = np.empty(width * height * image.channels, np.float32)
    if len(image.pixels) != pixels.size:
        return None
    image.pixels.foreach_get(pixels)
    pixels = with_four_channels(pixels.reshape(height, width, image.channels))
    if not image.is_float:
        # Exact: these are bytes over 255.
        return np.rint(pixels * 255.0).astype(np.uint8)
    return pixels


def with_four_channels(pixels):
    """Return pixels of 1 to 4 channels as RGBA: grey, grey and alpha, RGB, RGBA."""
    channels = pixels.shape[2]
    if channels == 4:
        return np.ascontiguousarray(pixels)
    out = np.full((*pixels.shape[:2], 4), 255 if pixels.dtype == np.uint8 else 1.0, pixels.dtype)
    out[..., :3] = pixels[..., :3] if channels >= 3 else pixels[..., :1]
    if channels == 2:
        out[..., 3] = pixels[..., 1]
    return out


def encode(pixels, image, as_stored):
    """Convert pixels to the encoding in which they are interpolated.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 4)
        Not changed.
    image : bpy.types.Image
        Whose colour space and alpha mode count.
    as_stored : bool
        The pixels are those of `load_file`, not of `read_pixels`.

    Returns
    -------
    pixels : ndarray of shape (height, width, 4)
        uint8 in the image's own encoding, or float32.
    srgb : bool
        They are sRGB encoded, else scene linear.
    associated : bool
        Colour is multiplied by alpha, and some pixel's alpha is not 1.
    notes : list of str
        Warnings about settings of the image that cannot be met, without its name.
    """
    notes = []
    mode, space = image.alpha_mode, image.colorspace_settings.name
    working = color_spaces.working_space()
    is_byte = pixels.dtype == np.uint8
    data = space in color_spaces.DATA_SPACES
    if mode == "NONE":
        pixels = pixels.copy()
        pixels[..., 3] = 255 if is_byte else 1.0
    opaque = bool((pixels[..., 3] == (255 if is_byte else 1.0)).all())
    associated = not (opaque or data or mode in {"NONE", "CHANNEL_PACKED"})
    # Cycles reads files itself; what is packed, painted or generated it takes from Blender, which
    # keeps 8-bit pixels straight and float pixels multiplied, and trusts the mode.
    from_file = image.source != "GENERATED" and not image.packed_file and not image.is_dirty
    straight = is_byte if from_file and not as_stored else mode == "STRAIGHT"
    srgb = space == color_spaces.SRGB and working == color_spaces.REC709
    if is_byte and not data and space != working and not srgb:
        converted = color_spaces.convert(pixels.astype(np.float32) / 255.0, space, working)
        if converted is None:
            notes.append(f"colour space '{space}' is not known; it is read as sRGB")
            srgb = True
        else:
            pixels = converted
    elif not is_byte and as_stored and not data and space != working and not srgb:
        converted = _convert_stored(pixels, space, working, associated and not straight)
        if converted is None:
            notes.append(f"colour space '{space}' is not known; its numbers are used as they are")
        else:
            pixels = converted
    elif not is_byte and srgb and not as_stored:
        # Blender has decoded what Cycles keeps encoded, of a file.
        srgb = from_file
        if srgb:
            multiplied = associated and not straight
            pixels = _with_straight_color(pixels, multiplied, encode_srgb)
            # Decoded straight, whatever the mode said of the file.
    if pixels.dtype != np.uint8:
        pixels, dropped = without_infinite(pixels)
        if dropped:
            notes.append(
                f"{dropped} of its pixels are not finite; they are black and transparent, as in"
                " Cycles"
            )
    if associated and straight:
        pixels = _associate(pixels)
    return pixels, srgb, associated, notes


def _convert_stored(pixels, space, working, multiplied):
    def converted(straight):
        return color_spaces.convert(straight, space, working)

    return _with_straight_color(pixels, multiplied, converted)


def _with_straight_color(pixels, multiplied, function):
    """Apply a function to the straight colour of pixels, multiplied by alpha or not."""
    if not multiplied:
        return function(pixels)
    alpha = pixels[..., 3:]
    # Light without opacity, such as a flame's, is converted as it is.
    alpha = np.where(alpha == 0.0, np.float32(1.0), alpha)
    straight = pixels.copy()
    straight[..., :3] /= alpha
    result = function(straight)
    if result is not None:
        result[..., :3] *= alpha
    return result


def encode_srgb(pixels):
    """Return pixels with the sRGB encoding of their colour, also beyond 0 to 1."""
    out = pixels.copy()
    color = pixels[..., :3]
    high = 1.055 * np.maximum(color, 0.0031308) ** (1.0 / 2.4) - 0.055
    out[..., :3] = np.where(color <= 0.0031308, color * 12.92, high)
    return out


def without_infinite(pixels):
    """Clear the pixels with a channel that is not finite or exceeds the largest radiance.

    All channels are cleared, as in Cycles, so that no false colour appears.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 4)
        float32; not changed.

    Returns
    -------
    pixels : ndarray of shape (height, width, 4)
    dropped : int
        How many were cleared.
    """
    # NaN fails every comparison.
    if np.abs(pixels).max(initial=0.0) <= LARGEST_RADIANCE:
        return pixels, 0
    bad = ~(np.abs(pixels) <= LARGEST_RADIANCE).all(axis=-1)
    pixels = pixels.copy()
    pixels[bad] = 0.0
    return pixels, int(bad.sum())


def reduced(pixels, largest):
    """Average an image down to at most `largest` texels a side, by squares of texels.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 4)
    largest : int

    Returns
    -------
    ndarray of shape (h, w, 4)
        Of the same type. Texels at the far edges are means of fewer.
    """
    step = -(-max(pixels.shape[:2]) // largest)
    if step <= 1:
        return pixels
    rows = np.arange(0, pixels.shape[0], step)
    columns = np.arange(0, pixels.shape[1], step)
    out = np.empty((len(rows), len(columns), 4), pixels.dtype)
    widths = np.diff(np.append(columns, pixels.shape[1]))[:, None]
    for i, first in enumerate(rows):
        # A band at a time: images that need this are large.
        band = pixels[first : first + step].astype(np.float64).sum(axis=0)
        mean = np.add.reduceat(band, columns, axis=0) / (widths * min(step, len(pixels) - first))
        out[i] = np.rint(mean) if pixels.dtype == np.uint8 else mean
    return out


def _associate(pixels):
    alpha = pixels[..., 3:]
    out = pixels.copy()
    if pixels.dtype == np.uint8:
        # Rounded down, as Cycles does.
        out[..., :3] = (pixels[..., :3].astype(np.uint16) * alpha) // 255
    else:
        out[..., :3] *= alpha
    return out
