"""Settings of a camera: real lens and zoom position, chromatic aberration, bokeh."""

import bpy
from bpy.props import EnumProperty, PointerProperty, StringProperty

from ...engine.shared_resources import shelf
from ...settings.scene_part_settings import ABERRATIONS, DISTORTION, LENS
from ..previews import lens_thumbnails
from .bokeh_properties import APPEARANCE_NAMES, AplanatBokehSettings
from .chromatic_properties import SETTING_NAMES, AplanatChromaticSettings
from .declared import properties
from .lens_memory import remember
from .overrides import OVERRIDABLE, SHARED, setting_changed

_THIN = "thin"
_LENS = "lens:"
_THIN_LENS = (
    "An ideal lens of any focal length and f-number, without a prescription: sharp at one distance,"
    " without aberrations of its own"
)

# Blender keeps no reference to the texts of a dynamic enum: they must live somewhere. Numbers stay
# the same while the library changes, so that a menu that is open means what it shows.
_texts = {}
_numbers = {}


def _kept(text):
    return _texts.setdefault(text, text)


def _number(identifier):
    return _numbers.setdefault(identifier, len(_numbers))


def _item(identifier, name, description, icon=0):
    identifier = _kept(identifier)
    return identifier, _kept(name), _kept(description), icon, _number(identifier)


def _lens_items(camera, _context):
    library = shelf()
    items = [
        _item(
            _THIN,
            "Thin Lens",
            _THIN_LENS,
            "CAMERA_DATA",
        )
    ]
    ids = library.ids()
    for lens_id in ids:
        found = library.find(lens_id)
        if found is None:
            continue
        icon = lens_thumbnails.icon_id(found) if found.lens else "ERROR"
        items.append(_item(_LENS + lens_id, found.title, _describe(found), icon))
    if camera.lens and camera.lens not in ids:
        items.append(_item(_LENS + camera.lens, camera.lens, "Not in the library", "ERROR"))
    return items


def _describe(found):
    if found.lens is None:
        return f"{found.id}: the file cannot be used"
    prescription = found.lens.prescription
    made = ", ".join(str(part) for part in (prescription.designer, prescription.year) if part)
    return f"{found.id}: {made}" if made else found.id


def _chosen_lens(camera):
    return _number(_LENS + camera.lens if camera.lens else _THIN)


def _choose_lens(camera, number):
    identifier = next((key for key, value in _numbers.items() if value == number), _THIN)
    camera.lens = identifier.removeprefix(_LENS) if identifier != _THIN else ""


def _found_lenses(camera, _context, typed):
    library = shelf()
    # Before anything is typed the field holds the lens that is there: then all are wanted.
    typed = "" if typed == camera.lens else typed.casefold()
    for lens_id in library.ids():
        found = library.find(lens_id)
        if found and all(word in found.search_text for word in typed.split()):
            yield lens_id, found.title


def _labels(camera):
    found = shelf().find(camera.lens) if camera.lens else None
    if found is None or found.lens is None:
        return ()
    return tuple(label for label in found.lens.prescription.labels if label)


def _zoom_items(camera, _context):
    labels = _labels(camera)
    items = [_item(label, label, "Position of the zoom ring") for label in labels]
    if camera.zoom_label and camera.zoom_label not in labels:
        items.append(
            _item(camera.zoom_label, camera.zoom_label, "The lens has no such position", "ERROR")
        )
    return items


def _chosen_zoom(camera):
    labels = _labels(camera)
    return _number(camera.zoom_label or (labels[0] if labels else ""))


def _choose_zoom(camera, number):
    camera.zoom_label = next((key for key, value in _numbers.items() if value == number), "")


def _lens_changed(camera, context):
    labels = _labels(camera)
    if camera.zoom_label and labels and camera.zoom_label not in labels:
        camera.zoom_label = ""
    remember(camera, "bokeh", APPEARANCE_NAMES)
    remember(camera, "chromatic", SETTING_NAMES)
    setting_changed(camera, context)


def _group_with_memory(which, label, kind, description):
    """Return the properties of a group of settings of which each lens keeps its own."""
    hidden = {"options": {"HIDDEN"}, "override": OVERRIDABLE}
    return {
        which: PointerProperty(
            name=label, type=kind, description=description, override=OVERRIDABLE
        ),
        f"{which}_lens": StringProperty(
            name=f"Lens of the {label}", description="Lens for which they were set", **hidden
        ),
        f"{which}_memory": StringProperty(
            name=f"{label} of Other Lenses",
            description="What was set for lenses that were used before, as JSON",
            **hidden,
        ),
    }


class AplanatCameraSettings(bpy.types.PropertyGroup):
    """The real lens of a camera, how it parts the colours, and its bokeh."""

    __annotations__ = {
        **properties(
            LENS,
            ABERRATIONS,
            DISTORTION,
            callbacks={"lens": {"search": _found_lenses, "update": _lens_changed}},
            **SHARED,
        ),
        "lens_choice": EnumProperty(
            name="Lens",
            description="Choose a lens by its cross-section and its bokeh; the field below finds it"
            " by name, focal length, f-number, kind and year",
            items=_lens_items,
            get=_chosen_lens,
            set=_choose_lens,
            options=set(),
        ),
        "compared_lens": StringProperty(
            name="Compare With",
            description="Another lens, whose pictures are shown beside those of the camera's;"
            " nothing else is changed",
            search=_found_lenses,
            override=OVERRIDABLE,
        ),
        "zoom": EnumProperty(
            name="Zoom",
            description="Position of the zoom ring. The camera's focal length stays as it is",
            items=_zoom_items,
            get=_chosen_zoom,
            set=_choose_zoom,
            options=set(),
        ),
        **_group_with_memory(
            "bokeh", "Bokeh", AplanatBokehSettings, "How the camera's highlights are drawn"
        ),
        **_group_with_memory(
            "chromatic",
            "Chromatic Aberration",
            AplanatChromaticSettings,
            "How colours part in the camera",
        ),
    }
