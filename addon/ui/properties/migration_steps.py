"""The steps that bring stored settings from version to version; see `migrations`."""

from .moved_settings import move, move_animation

_NONE = 0
_LONGEST_WAVELENGTH = 0
_THRESHOLD = 1


def distortion_to_lens(kind, block, stored):
    """To version 2: distortion belongs to a camera's lens, and no longer to its bokeh.

    Without bokeh there was none, and there is none then.
    """
    if kind != "cameras":
        return
    bokeh = stored.get("bokeh", {})
    if "distortion_source" in bokeh and not bokeh.get("use", True):
        bokeh["distortion_source"] = _NONE
    for old, new in (
        ("bokeh.distortion_source", "distortion"),
        ("bokeh.distortion", "distortion_k"),
    ):
        move(stored, old, new)
        move_animation(block, old, new)


def focus_of_longest_wavelength(kind, block, stored):
    """To version 3: which light is in focus can be chosen; it was the longest wavelength."""
    chromatic = stored.get("chromatic") if kind == "cameras" else None
    if chromatic is not None and "use" in chromatic and "focus_light" not in chromatic:
        chromatic["focus_light"] = _LONGEST_WAVELENGTH


def highlights_of_threshold(kind, block, stored):
    """To version 4: highlights are found automatically, but for who has chosen a threshold."""
    bokeh = stored.get("bokeh") if kind == "cameras" else None
    if bokeh is not None and "threshold" in bokeh and "highlights" not in bokeh:
        bokeh["highlights"] = _THRESHOLD


# By the version that it leads to: called as step(kind, block, stored) for each data-block that has
# stored settings. `kind` is the name of its collection in bpy.data, or "view_layers"; `stored`
# holds the stored values by name, groups inside as groups, and also those whose property is gone.
# Keys and drivers of the block name a setting, too: `moved_settings` moves both.
STEPS = {
    2: distortion_to_lens,
    3: focus_of_longest_wavelength,
    4: highlights_of_threshold,
}
