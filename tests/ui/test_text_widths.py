"""Texts of panels fit into the properties editor; panels of the camera stand where they belong."""

from types import MethodType, SimpleNamespace

import pytest

from addon.engine.shared_resources import shelf
from addon.registration import _MODULES
from addon.ui.panels import panel_order

from .panel_drawing import Layout, draw, panels_of, states

# In pixels at a scale of 1: the tabs, both margins of a panel with its scroll bar, an icon, the box
# of a switch.
TABS, MARGINS, ICON, BOX = 38, 24, 20, 18
# The gap that Blender keeps on both sides of a text.
GAP = 4


@pytest.mark.parametrize("width", [280, 400])
def test_no_text_is_cut(context, width, aplanat_bpy):
    import blf

    blf.size(0, aplanat_bpy.context.preferences.ui_styles[0].widget.points)
    context.region = SimpleNamespace(width=width - TABS)
    room = width - TABS - MARGINS
    cut = set()
    for _ in states(context):
        for panel in panels_of(_MODULES, {"PROPERTIES"}):
            layout = draw(panel, context)
            shown = [(text, ICON * (icon != "NONE"), share) for text, icon, share in layout.texts]
            shown += [(text, BOX * (kind == "BOOLEAN"), s) for text, kind, s in layout.names]
            for text, beside, share in shown:
                needed = blf.dimensions(0, text)[0] + beside
                if needed > share * room - GAP:
                    cut.add((panel.__name__, text, round(needed), round(share * room)))
    assert cut == set()


def test_only_the_real_lens_opens_by_itself(aplanat_bpy):
    panels = [p for p in panels_of(_MODULES, {"PROPERTIES"}) if p.bl_context == "data"]
    cameras = [p for p in panels if "_CAMERA_" in p.__name__]
    opened = [p.__name__ for p in cameras if "DEFAULT_CLOSED" not in getattr(p, "bl_options", ())]
    assert len(cameras) > 15 and opened == ["APLANAT_CAMERA_PT_lens"]


def test_panels_of_the_camera_follow_depth_of_field(aplanat_bpy, monkeypatch):
    bpy = aplanat_bpy
    registered = []

    def register(cls):
        registered.append(cls.__name__)
        original(cls)

    original = bpy.utils.register_class
    monkeypatch.setattr(bpy.utils, "register_class", register)
    panel_order.register()
    families = [name for name in registered if name in panel_order.BEHIND]
    assert families == list(panel_order.BEHIND)
    # With what hangs on them.
    assert "DATA_PT_camera_safe_areas_center_cut" in registered
    for name in registered:
        cls = getattr(bpy.types, name)
        assert cls.is_registered and "APLANAT" in cls.COMPAT_ENGINES


def test_lines_are_filled_by_the_width_of_what_is_drawn(aplanat_bpy):
    import blf

    from addon.ui.panels.sentences import wrapped

    text = "Object 'lily': little illuminated hills will fill this till it is full, i.e. still"
    lines = wrapped(text, 24)
    assert " ".join(lines) == text
    widths = [blf.dimensions(0, line)[0] for line in lines]
    # The next word would not have fitted into 24 letters of 6.5 px.
    words = [line.split()[0] for line in lines[1:]]
    assert max(widths) <= 24 * 6.5
    for line, word in zip(lines, words, strict=False):
        assert blf.dimensions(0, f"{line} {word}")[0] > 24 * 6.5
    # Narrow letters: more than 24 of them.
    assert max(map(len, lines)) > 30
    assert "".join(wrapped("W" * 60, 24)) == "W" * 60 and len(wrapped("W" * 60, 24)) > 3


def test_every_lens_has_a_cell_in_the_popup_with_texts_that_fit(aplanat_bpy, empty_scene):
    import blf

    from addon.ui.panels.lens_browser_panel import APLANAT_OT_browse_lenses

    camera = aplanat_bpy.data.cameras.new("camera")
    camera.aplanat.lens = "tessar-50mm-f2.8"
    popup = SimpleNamespace(layout=Layout())
    MethodType(APLANAT_OT_browse_lenses.draw, popup)(SimpleNamespace(camera=camera))
    lenses = [button.lens for button in popup.layout.operators]
    assert lenses == ["", *shelf().ids()] and len(lenses) > 30
    texts = [text for text, _, _ in popup.layout.texts]
    buttons = [button.text for button in popup.layout.operators]
    blf.size(0, aplanat_bpy.context.preferences.ui_styles[0].widget.points)
    # Seven columns in 920 pixels, and what Blender keeps free beside a text.
    for text in (*texts, *buttons):
        assert 0 < blf.dimensions(0, text)[0] < 920 / 7 - 12, text
    # What tells lenses of one name apart.
    assert len(set(zip(texts, buttons, strict=True))) == len(lenses)
    assert "50 mm f/2.8" in buttons and "Tessar type" in texts
