"""What the renderer reads of a camera's real lens: bokeh profile and pupil, from the cache."""

from ..lens_io import profile_cache


def lens_profile(lens, chromatic):
    """Return the bokeh profile of a lens, traced if the cache does not have it.

    Parameters
    ----------
    lens : LensSettings
    chromatic : bool

    Returns
    -------
    LensProfile

    Raises
    ------
    PrescriptionError
        If the lens forms no image.
    """
    return profile_cache.profile(
        lens.prescription, lens.label, chromatic=chromatic, lens_id=lens.id
    )


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
