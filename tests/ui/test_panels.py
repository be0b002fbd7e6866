"""Panels and properties: what is shown for the engine, and that it goes when Aplanat goes."""

import importlib.util
from pathlib import Path
from types import SimpleNamespace

import pytest

from addon.capture.settings import ENGINES
from addon.registration import _MODULES
from addon.ui.panels import render_panels
from addon.ui.panels.capture_panel import APLANAT_RENDER_PT_layers

from .panel_drawing import draw


@pytest.fixture
def scene(empty_scene):
    empty_scene.render.engine = "APLANAT"
    return empty_scene


def engines(bpy, name):
    return getattr(bpy.types, name).COMPAT_ENGINES


@pytest.mark.parametrize(
    "name",
    [
        *("DATA_PT_lens", "DATA_PT_camera", "DATA_PT_camera_dof", "DATA_PT_camera_dof_aperture"),
        *("DATA_PT_EEVEE_light", "DATA_PT_spot", "EEVEE_MATERIAL_PT_surface"),
        *("EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_volume"),
        "EEVEE_WORLD_PT_surface",
        *("WORLD_PT_context_world", "VIEWLAYER_PT_layer", "VIEWLAYER_PT_layer_passes"),
        *("RENDER_PT_format", "RENDER_PT_output", "RENDER_PT_color_management"),
        *("APLANAT_RENDER_PT_simplify", "RENDER_PT_post_processing", "OBJECT_PT_visibility"),
        *("DATA_PT_context_mesh", "DATA_PT_uv_texture", "PARTICLE_PT_render"),
        *("RENDER_PT_stereoscopy", "RENDER_PT_output_views", "DATA_PT_camera_stereoscopy"),
        # Blender draws the lines, whatever the engine.
        *("RENDER_PT_freestyle", "VIEWLAYER_PT_freestyle"),
    ],
)
def test_blenders_panel_is_shown(aplanat_bpy, name):
    assert "APLANAT" in engines(aplanat_bpy, name)


@pytest.mark.parametrize(
    "name",
    [
        "DATA_PT_lightprobe",
        *("RENDER_PT_eevee_sampling", "CYCLES_RENDER_PT_sampling"),
    ],
)
def test_panel_of_what_aplanat_lacks_is_not_shown(aplanat_bpy, name):
    panel = getattr(aplanat_bpy.types, name, None)
    assert panel is None or "APLANAT" not in panel.COMPAT_ENGINES


def test_nothing_stays_after_unregistering(aplanat_bpy):
    import addon

    bpy = aplanat_bpy
    addon.unregister()
    try:
        for panel in bpy.types.Panel.__subclasses__():
            if panel.__module__.startswith("bl_ui"):
                assert "APLANAT" not in getattr(panel, "COMPAT_ENGINES", ())
        for owner in ("Scene", "ViewLayer", "Camera", "Material", "Light", "World"):
            assert not hasattr(getattr(bpy.types, owner), "aplanat")
        assert not hasattr(bpy.types, "APLANAT_RENDER_PT_sampling")
        for name in dir(bpy.app.handlers):
            handlers = getattr(bpy.app.handlers, name)
            if isinstance(handlers, list):
                assert not [f for f in handlers if f.__module__.startswith("addon.")], name
    finally:
        addon.register()
    assert "APLANAT" in engines(bpy, "DATA_PT_camera_dof")


def test_panels_of_ours_are_for_aplanat_only(scene):
    panels = [
        cls
        for module in _MODULES
        for cls in getattr(module, "CLASSES", ())
        if "_PT_" in cls.__name__ and not cls.__name__.endswith("_presets")
    ]
    assert len(panels) > 20
    for panel in panels:
        assert panel.is_registered and panel.bl_label
        if panel.bl_space_type in ("IMAGE_EDITOR", "NODE_EDITOR", "VIEW_3D"):
            # Captures of all engines are refocused there, pictures of all are composited, and
            # cameras of all are focused.
            assert not hasattr(panel, "COMPAT_ENGINES")
            continue
        # Whatever engine renders them, layers are captured by Aplanat.
        engines = ENGINES if panel is APLANAT_RENDER_PT_layers else {"APLANAT"}
        assert set(panel.COMPAT_ENGINES) == set(engines)


def test_switching_a_pass_on_changes_the_compositors_sockets(scene, aplanat_bpy):
    bpy = aplanat_bpy
    tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
    node = tree.nodes.new("CompositorNodeRLayers")
    scene.compositing_node_group = tree
    layer = scene.view_layers[0]
    layer.aplanat.use_pass_coc = True
    layer.aplanat.use_pass_focus_matte = True
    layer.use_pass_z = True
    bpy.context.view_layer.update_render_passes()
    enabled = {socket.name for socket in node.outputs if socket.enabled}
    assert {"Image", "Depth", "CoC", "Focus Matte"} <= enabled
    layer.aplanat.use_pass_coc = False
    enabled = {socket.name for socket in node.outputs if socket.enabled}
    assert "CoC" not in enabled


def test_every_panel_of_blender_that_is_not_shown_has_a_reason_in_the_docs(aplanat_bpy):
    page = _script("panels_page")
    unexplained = [
        panel.__name__
        for listed in page.panels().values()
        for panel, shown in listed
        if not shown and page.reason(panel.__name__) is None
    ]
    assert unexplained == []
    assert page.PAGE.read_text() == page.write(), "run scripts/pages/panels_page.py"


def _script(name):
    path = Path(__file__).resolve().parents[2] / "scripts" / "pages" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_panels_of_ours_draw_what_is_followed(scene, aplanat_bpy):
    bpy = aplanat_bpy
    light = bpy.data.lights.new("lamp", "POINT")
    context = SimpleNamespace(
        engine="APLANAT", scene=scene, view_layer=scene.view_layers[0], light=light
    )
    drawn = {
        name
        for panel in (
            render_panels.APLANAT_VIEWLAYER_PT_filter,
            render_panels.APLANAT_VIEWLAYER_PT_override,
            render_panels.APLANAT_LIGHT_PT_influence,
            render_panels.APLANAT_RENDER_PT_performance,
        )
        for _, name in draw(panel, context).drawn
    }
    assert {"use_sky", "use_solid", "material_override", "world_override"} <= drawn
    assert {"diffuse_factor", "specular_factor", "preview_pixel_size"} <= drawn
