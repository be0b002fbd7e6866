"""The compositor in Blender's window: buttons, the Add menu, undo, and the asset library."""

from pathlib import Path

import pytest

STAGE = Path(__file__).parents[1].joinpath("stage.py").read_text()

# Runs inside Blender.
EDITOR = """
groups = module("compositor.node_groups")
library = module("compositor.asset_library")

# No other tab in the sidebar than ours.
for name in dir(bpy.types):
    cls = getattr(bpy.types, name)
    if getattr(cls, "bl_space_type", "") == "NODE_EDITOR" and "_PT_" in name:
        if getattr(cls, "bl_region_type", "") == "UI" and not name.startswith("APLANAT"):
            if cls.is_registered:
                bpy.utils.unregister_class(cls)

def editor():
    return max(window().screen.areas, key=lambda area: area.width * area.height)

def in_editor():
    editor().ui_type = "CompositorNodeTree"
    editor().spaces.active.show_region_ui = True
    region = next(r for r in editor().regions if r.type == "WINDOW")
    return bpy.context.temp_override(window=window(), area=editor(), region=region)

def kinds():
    tree = bpy.context.scene.compositing_node_group
    return sorted(n.node_tree.name if n.type == "GROUP" else n.type for n in tree.nodes)

def wire():
    with in_editor():
        answer = list(bpy.ops.scene.aplanat_wire_compositor("EXEC_DEFAULT", True))
        editor().spaces.active.node_tree = bpy.context.scene.compositing_node_group
        bpy.ops.wm.redraw_timer(type="DRAW", iterations=2)
        bpy.ops.node.view_all()
    return answer

def add(operator, **options):
    with in_editor():
        return list(getattr(bpy.ops.node, operator)("EXEC_DEFAULT", True, **options))

def undo():
    with in_editor():
        bpy.ops.ed.undo()
    return bpy.context.scene.compositing_node_group is None
"""


@pytest.fixture
def stage(window):
    window.run(STAGE + EDITOR)
    window.run("build(); bpy.context.scene.render.engine = 'APLANAT'")
    window.run("with in_editor(): bpy.ops.ed.undo_push(message='Begin')")
    yield window
    log = window.log.read_text()
    assert "Traceback" not in log, log


def test_buttons_set_up_add_and_are_undone(stage, tmp_path):
    assert stage.run("result = wire()") == ["FINISHED"]
    wired = ["Aplanat Mix", "GROUP_OUTPUT", "R_LAYERS"]
    assert stage.run("result = kinds()") == wired
    assert stage.run("result = add('aplanat_add_group', group='Aplanat Fringe')") == ["FINISHED"]
    assert stage.run("result = add('aplanat_add_bokeh_sprite', size=64)") == ["FINISHED"]
    every = sorted([*wired, "Aplanat Bokeh Sprite", "Aplanat Fringe"])
    assert stage.run("result = kinds()") == every
    stage.run("result = 1")
    stage.screenshot(tmp_path / "compositor.png")
    assert (tmp_path / "compositor.png").stat().st_size > 0
    stage.run("undo()")
    assert stage.run("result = kinds()") == sorted([*wired, "Aplanat Fringe"])
    stage.run("undo()")
    assert stage.run("result = undo()")


def test_a_node_of_the_menu_follows_the_pointer_until_a_click(stage):
    stage.run("wire()")
    stage.xdotool("mousemove", 300, 500)
    # As the Add menu calls it.
    code = "bpy.ops.node.aplanat_add_group('INVOKE_DEFAULT', True, group='Aplanat Fringe')"
    stage.run(f"with in_editor(): {code}")
    stage.wait_for("len(window().modal_operators)")
    places = []
    for x in (500, 600):
        stage.xdotool("mousemove", x, 500)
        stage.run("with in_editor(): bpy.ops.wm.redraw_timer(type='DRAW', iterations=1)")
        code = "list(bpy.context.scene.compositing_node_group.nodes.active.location)"
        places.append(stage.run(f"result = {code}")[0])
    assert places[1] > places[0] + 20.0
    stage.xdotool("click", 1)
    stage.wait_for("not window().modal_operators")
    assert "Aplanat Fringe" in stage.run("result = kinds()")


def test_the_asset_library_is_added_by_its_button_only(stage, tmp_path):
    assert stage.run("result = library.bundled_folder() is not None")
    names = "[l.name for l in bpy.context.preferences.filepaths.asset_libraries]"
    assert "Aplanat" not in stage.run(f"result = {names}")
    assert stage.run("result = list(bpy.ops.preferences.aplanat_add_asset_library())") == [
        "FINISHED"
    ]
    assert stage.run(f"result = {names}").count("Aplanat") == 1
    assert not stage.run("result = bpy.ops.preferences.aplanat_add_asset_library.poll()")
    stage.run("wire()")
    stage.run("result = 1")
    stage.screenshot(tmp_path / "assets.png")
