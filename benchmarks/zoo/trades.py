"""Settings by which a scene asks for less than the reference method's picture."""

from contextlib import ExitStack, contextmanager

# Settings that trade exactness for speed by their own words, and the least of each at which the
# picture is promised to be that of the reference method: the defaults.
_SCENE_TRADES = {
    "level_bias": lambda value: max(value, 0.0),
    "render_error": lambda value: min(value, 0.01),
    "render_min_samples": lambda value: max(value, 16),
    # Not more either: noise is bought off cheaper by more pictures.
    "render_max_samples": lambda value: 256,
    "render_time_limit": lambda value: 0.0,
    "render_samples": lambda value: max(value, 64),
    "sharing_cells": lambda value: max(value, 2),
    "subsamples": lambda value: min(value, 4),
    "least_triangles": lambda value: max(value, 256),
}
_AUTOMATIC = frozenset({"render_error", "render_min_samples", "render_max_samples"})
_BOKEH_TRADES = {
    "model": lambda value: "POINT",
    "visibility": lambda value: "AUTO",
    "layers": lambda value: max(value, 4),
    "overscan": lambda value: max(value, 0.25),
    "lens_views": lambda value: max(value, 4),
    # Marks on a picture are no picture.
    "debug_view": lambda value: "NONE",
}


def _within_soft_limits(value):
    return min(max(value, -10.0), 10.0)


# Asked of the layered method: what lies beyond the sliders bends rays across the whole picture and
# far beyond it, where its layers end.
_LAYERED_LENS = dict.fromkeys(
    ("spherical", "coma", "astigmatism", "field_curvature"), _within_soft_limits
)
_LAYERED_COLORS = dict.fromkeys(("axial", "lateral"), _within_soft_limits)
# Looks of a disc that samples of the lens know nothing of: with any of these the reference method
# draws its highlights one by one, too, and the check is of all the rest.
_PLAIN_LOOKS = {
    "gain": 1.0,
    "hardness": 0.0,
    "grain": 0.0,
    "dust": 0.0,
    "diffraction": 0.0,
    "onion": 0.0,
}


@contextmanager
def fit_to_compare(scene):
    """Take back what trades exactness for speed; yields whether that changed anything.

    Parameters
    ----------
    scene : bpy.types.Scene
    """
    camera = scene.camera.data.aplanat
    groups = [(scene.aplanat, _SCENE_TRADES), (camera.bokeh, _BOKEH_TRADES)]
    if scene.aplanat.method == "LAYERED":
        groups += [(camera, _LAYERED_LENS), (camera.chromatic, _LAYERED_COLORS)]
    # What does not count: the samples or the noise threshold, and the bokeh where there is none.
    automatic = scene.aplanat.use_target_error
    idle = {"render_samples"} if automatic else set(_AUTOMATIC)
    if not camera.bokeh.use:
        idle |= _BOKEH_TRADES.keys()
    changed = False
    with ExitStack() as stack:
        for group, trades in groups:
            stack.enter_context(kept(group, trades))
            for name, bound in trades.items():
                value = getattr(group, name)
                if bound(value) != value:
                    setattr(group, name, bound(value))
                    changed |= name not in idle
        yield changed


@contextmanager
def kept(group, names):
    """Put properties back afterwards.

    Parameters
    ----------
    group : bpy.types.PropertyGroup
    names : iterable of str
    """
    values = {name: getattr(group, name) for name in names}
    try:
        yield
    finally:
        for name, value in values.items():
            setattr(group, name, value)


def has_plain_look(camera):
    """Whether samples of the lens alone give the discs of a camera's highlights.

    Parameters
    ----------
    camera : bpy.types.Camera

    Returns
    -------
    bool
    """
    bokeh = camera.aplanat.bokeh
    if not bokeh.use:
        return True
    real_lens = bool(camera.aplanat.lens)
    bent = (real_lens and bokeh.profile_strength > 0.0) or (
        bokeh.vignetting == "ANALYTIC" or (bokeh.vignetting == "LENS" and real_lens)
    )
    return not bent and all(getattr(bokeh, k) == value for k, value in _PLAIN_LOOKS.items())
