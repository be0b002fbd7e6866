"""Bokeh profile and off-axis pupil of a camera's real lens, from the cache or traced."""

from ...lens_io import profile_cache


def lens_profile(lens):
    """Return the bokeh profile of a lens, traced if the cache does not have it.

    It is that of one wavelength: colours come from `ChromaticAberration`, which discs and lens
    samples share.

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
    """Return the off-axis pupil of a lens focused at infinity, traced if need be.

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
