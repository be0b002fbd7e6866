"""What the renderer reads of a camera's real lens: bokeh profile and pupil, from the cache."""

from ...lens_io import profile_cache


def lens_profile(lens):
    """Return the bokeh profile of a lens, traced if the cache does not have it.

    That of one wavelength: the colors of a picture are chromatic aberration's, which discs and all
    the rest share.

    Parameters
    ----------
    lens : LensSettings

    Returns
    -------
    LensProfile

    Raises
    ------
    PrescriptionError
        If the lens forms no image.
    """
    return profile_cache.profile(lens.prescription, lens.label, chromatic=False, lens_id=lens.id)


def lens_pupil(lens):
    """Return the off-axis pupil of a lens that stands at infinity, traced if need be.

    Parameters
    ----------
    lens : LensSettings

    Returns
    -------
    PupilTables

    Raises
    ------
    PrescriptionError
        If the lens forms no image.
    """
    return profile_cache.pupil_tables(lens.prescription, lens.label, lens_id=lens.id)
