"""`aplanat lens bake`: the bokeh tables of a lens, made and written."""

from ..bokeh.profile import make_profile


def lens_profile(read, arguments, console):
    """Make the bokeh profile of a lens.

    Parameters
    ----------
    read : LensFile
    arguments : argparse.Namespace
        With ``chromatic`` and ``zoom``.
    console : Console

    Returns
    -------
    LensProfile
    """
    return make_profile(
        read.prescription.configuration(arguments.zoom),
        name=read.prescription.name,
        focus_group=read.prescription.focus,
        chromatic=arguments.chromatic,
        progress=lambda share: console.progress(f"bokeh profile: {share:.0%}"),
    )
