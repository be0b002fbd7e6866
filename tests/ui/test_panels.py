"""Panels and properties: what is shown for the engine, and that it goes when Aplanat goes."""

import pytest


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
        *("EEVEE_MATERIAL_PT_context_material", "EEVEE_WORLD_PT_surface"),
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
        assert not hasattr(bpy.types.Scene, "aplanat")
        assert not hasattr(bpy.types.ViewLayer, "aplanat")
        assert not hasattr(bpy.types, "APLANAT_RENDER_PT_sampling")
        assert not bpy.utils.preset_paths("aplanat/sampling")
    finally:
        addon.register()
    assert "APLANAT" in engines(bpy, "DATA_PT_camera_dof")


def test_every_property_has_a_name_a_tooltip_and_bounds(scene):
    for group in (scene.aplanat, scene.view_layers[0].aplanat):
        for prop in group.bl_rna.properties:
            if prop.identifier in {"rna_type", "name"}:
                continue
            assert prop.name and prop.description, prop.identifier
            assert not prop.description.endswith("."), f"{prop.identifier}: Blender adds the dot"
            if prop.type in {"INT", "FLOAT"}:
                assert prop.hard_min <= prop.default <= prop.hard_max
                assert prop.soft_max < 2**31 - 1 or prop.identifier == "seed"
            if prop.type == "ENUM":
                assert all(item.description for item in prop.enum_items)


def test_panels_of_ours_have_a_poll_for_the_engine(scene, aplanat_bpy):
    from addon.ui.panels import panels

    for panel in panels.CLASSES:
        assert panel.is_registered
        assert set(panel.COMPAT_ENGINES) == {"APLANAT"}
        assert panel.bl_label


def test_presets_are_found_and_set_the_scene(scene, aplanat_bpy):
    bpy = aplanat_bpy
    samples = {}
    for name in ("Draft", "Preview", "Final"):
        path = bpy.utils.preset_find(name, "aplanat/sampling")
        assert path, name
        bpy.ops.script.execute_preset(filepath=path, menu_idname="APLANAT_PT_sampling_presets")
        samples[name] = (scene.aplanat.preview_samples, scene.aplanat.render_samples)
    assert samples["Draft"] < samples["Preview"] < samples["Final"]


def test_presets_leave_the_lens_alone(scene, aplanat_bpy):
    bpy = aplanat_bpy
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.dof.aperture_fstop = 1.25
    path = bpy.utils.preset_find("Draft", "aplanat/sampling")
    bpy.ops.script.execute_preset(filepath=path, menu_idname="APLANAT_PT_sampling_presets")
    assert camera.data.dof.aperture_fstop == 1.25


def test_own_preset_is_saved_and_loaded(scene, aplanat_bpy, tmp_path, monkeypatch):
    bpy = aplanat_bpy
    monkeypatch.setattr(
        bpy.utils, "user_resource", lambda *_, path="", **__: str(make(tmp_path / path))
    )
    scene.aplanat.render_samples = 77
    assert bpy.ops.render.aplanat_sampling_preset_add(name="Mine") == {"FINISHED"}
    saved = next(tmp_path.rglob("Mine.py"))
    scene.aplanat.render_samples = 5
    bpy.ops.script.execute_preset(filepath=str(saved), menu_idname="APLANAT_PT_sampling_presets")
    assert scene.aplanat.render_samples == 77


def make(folder):
    folder.mkdir(parents=True, exist_ok=True)
    return folder


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
