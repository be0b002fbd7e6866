"""The highlight threshold: which light lens samples keep, and which is splatted (methods 9 and 10).

A picture averaged over n places on the lens shows the disc of a bright point as n dots. Where they
do not fill the disc, the light above a threshold is therefore taken out of the samples and splatted
as a disc of its own. No energy is lost: at every surface the radiance `I` with the signed circle of
confusion `C` (px) is divided into

``base = I (1 - share(C)) + share(C) kept(I)`` and ``highlight = I - base``,

``share(C) = smoothstep(c0, 1.5 c0, |C|)``, ``c0 = max(1, sqrt(samples / (16 pi)))``.

``kept(I)`` is ``I`` up to the threshold and 0 from twice the threshold on: light of a lamp that
samples kept would be a bright dot in each of them, and most of the noise. A gain multiplies
only the light above the threshold.

An automatic threshold is `contrast` times the mean brightness within the point's own circle of
confusion, as the lens' middle sees the picture, and at least `WHITE`. Of light that fills the share
f of a circle, n samples hit f n times: they draw it unless f is small, and where f is small the
mean is f times the light. So wide bright surfaces stay in the samples, their edges (f = 1/2) and
corners (f = 1/4) too, and lamps and glints do not. Light above the threshold counts in the mean
only as the threshold: what is splatted is no noise, and hides none.

The same functions for the graphics device are in ``lib/bokeh/highlight_lib.glsl``.
"""

import numpy as np

# Least radius of a disc that is splatted, px: the splat of a smaller one errs by more than 10 % of
# the peak of a lamp of a pixel.
_LEAST_COC = 1.0
# Lens samples for each pixel of a disc that show it without dots: the picture of a lamp of a pixel
# then has an error of a quarter, its splat one of 2 %. Subsamples do not count: they only see what
# their lens sample shows, which may miss a light that is smaller than a pixel.
_SAMPLES_A_PIXEL = 16.0
# Least threshold, where it is automatic: no light is a highlight that is not brighter than white.
WHITE = 1.0
# Least contrast: the corner of a wide surface fills a quarter of the circle around it, and must
# stay below the threshold.
_LEAST_CONTRAST = 5.0
# Lens samples for which light that fills half of a circle has an error of a sixteenth.
_SAMPLES_OF_HALF = 256.0
# The share grows from 0 to 1 while the circle grows by this factor, so that nothing pops.
_TRANSITION = 1.5


def least_coc(samples):
    """Return the radius of the circle of confusion from which on light is splatted.

    Parameters
    ----------
    samples : float
        Number of lens samples.

    Returns
    -------
    float
        In pixels.
    """
    return max(_LEAST_COC, float(np.sqrt(samples / (_SAMPLES_A_PIXEL * np.pi))))


def contrast(samples):
    """Return how many times brighter than its surroundings light is that samples cannot draw.

    Parameters
    ----------
    samples : float
        Number of lens samples, n.

    Returns
    -------
    float
        1 / f for light that fills the share f of a circle of confusion of which n samples, chosen
        by chance, make sqrt((1 - f) / (f n)) = 1 / 16 of noise; at least 5.
    """
    return max(_LEAST_CONTRAST, 1.0 + samples / _SAMPLES_OF_HALF)


def highlight_share(coc_px, least):
    """Return which share of the light above the threshold is splatted.

    Parameters
    ----------
    coc_px : ndarray of shape (...)
        Signed radius of the circle of confusion, px.
    least : float
        See `least_coc`.

    Returns
    -------
    ndarray of shape (...)
        0 to 1.
    """
    t = np.clip((np.abs(coc_px) / least - 1.0) / (_TRANSITION - 1.0), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def highlight_light(radiance, threshold, gain=1.0):
    """Return the light that is splatted where the share is 1, in the colour of the whole.

    Parameters
    ----------
    radiance : ndarray of shape (..., 3)
    threshold : float
        Threshold of the largest channel; greater than 0.
    gain : float
        Factor of the light above the threshold.

    Returns
    -------
    ndarray of shape (..., 3)
    """
    radiance = np.asarray(radiance)
    below = _below(radiance, threshold)
    return radiance * (below - _kept(radiance, threshold) + gain * (1.0 - below))


def highlight_base(radiance, share, threshold):
    """Return what the lens samples keep: the radiance without the splatted part.

    Parameters
    ----------
    radiance : ndarray of shape (..., 3)
    share : ndarray of shape (...)
        See `highlight_share`.
    threshold : float

    Returns
    -------
    ndarray of shape (..., 3)
        ``radiance - share * highlight_light(radiance, threshold)``, without the loss of digits
        that this difference has for radiances far above the threshold.
    """
    radiance, share = np.asarray(radiance), np.asarray(share)[..., None]
    return radiance * ((1.0 - share) + share * _kept(radiance, threshold))


def amplify(radiance, amplification, luminance):
    """Restore the brightness of clipped whites: *Amplify Whites*.

    Parameters
    ----------
    radiance : ndarray of shape (..., 3)
        Scene linear, 1 where the picture is white.
    amplification : float
        White becomes 1 + this; 0 changes nothing.
    luminance : sequence of 3 float
        Luminance weights of the channels.

    Returns
    -------
    ndarray of shape (..., 3)
        ``radiance (1 + amplification L^10)`` with the luminance L clamped to 1: what is brighter
        than white was not clipped, and is multiplied as white is.

    References
    ----------
    Jeong et al., TVCG 2020, section 4.1.
    """
    radiance = np.asarray(radiance)
    white = np.clip(radiance @ np.asarray(luminance, radiance.dtype), 0.0, 1.0)
    return radiance * (1.0 + amplification * white[..., None] ** 10)


def _below(radiance, threshold):
    peak = np.maximum(radiance.max(axis=-1, keepdims=True), 1e-30)
    return np.minimum(threshold / peak, 1.0)


def _kept(radiance, threshold):
    below = _below(radiance, threshold)
    return below * np.clip(2.0 - 1.0 / below, 0.0, 1.0)
