"""Fixtures of the tests of what a user meets."""

from types import SimpleNamespace

import pytest


@pytest.fixture
def preset_folder(aplanat_bpy, tmp_path, monkeypatch):
    """A folder of the user's presets, in place of the real one."""

    def user_resource(*_, path="", **__):
        (tmp_path / path).mkdir(parents=True, exist_ok=True)
        return str(tmp_path / path)

    def preset_paths(subdir):
        folder = tmp_path / "presets" / subdir
        return [str(folder)] if folder.is_dir() else []

    monkeypatch.setattr(aplanat_bpy.utils, "user_resource", user_resource)
    monkeypatch.setattr(aplanat_bpy.utils, "preset_paths", preset_paths)
    return tmp_path / "presets"


@pytest.fixture
def context(aplanat_bpy, empty_scene):
    """What panels read of Blender's context, with a camera, a material, a light and a world."""
    bpy = aplanat_bpy
    empty_scene.render.engine = "APLANAT"
    camera = bpy.data.cameras.new("Camera")
    obj = bpy.data.objects.new("Camera", camera)
    empty_scene.collection.objects.link(obj)
    empty_scene.camera = obj
    camera.dof.use_dof = True
    world = bpy.data.worlds.new("World")
    empty_scene.world = world
    return SimpleNamespace(
        engine="APLANAT",
        scene=empty_scene,
        view_layer=empty_scene.view_layers[0],
        camera=camera,
        object=obj,
        material=bpy.data.materials.new("Material"),
        light=bpy.data.lights.new("Light", "POINT"),
        world=world,
        space_data=SimpleNamespace(image=None, overlay=SimpleNamespace(show_overlays=True)),
        region=SimpleNamespace(width=400),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
    )
