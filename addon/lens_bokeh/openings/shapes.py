"""One opening for lens samples and discs.

Lens samples are spread over an opening by its `spread`, discs are drawn by its `coverage`: both
know one shape.
"""

from dataclasses import replace

from ...sampling.iris import Iris
from .blades import BladedIris


def iris_of(opening, rotation=0.0, ratio=1.0):
    """Return an opening as the `Iris` of lens samples.

    Parameters
    ----------
    opening : BladedIris or PictureIris
    rotation : float
        Of the camera's aperture, in radians; the opening is turned already.
    ratio : float
        Anamorphic ratio.

    Returns
    -------
    Iris
    """
    blades = getattr(opening, "blades", 0)
    plain = opening == BladedIris(blades, 0.0, rotation) or opening == BladedIris()
    return Iris(blades, rotation, ratio, None if plain else opening)


def opening_of(iris):
    """Return the opening that lens samples are spread over, as `BladedIris` or `PictureIris`."""
    if iris.opening is not None:
        return iris.opening
    return BladedIris(iris.blades, 0.0, iris.rotation) if iris.blades >= 3 else BladedIris()


def stopped_down(opening, closing):
    """Return an opening at another f-number.

    Parameters
    ----------
    opening : BladedIris or PictureIris
    closing : float or None
        F-number over that of the lens wide open; None: there is no such lens.

    Returns
    -------
    BladedIris or PictureIris
        Without a round stop the same.
    """
    if getattr(opening, "closing", None) is None:
        return opening
    return replace(opening, closing=closing)
