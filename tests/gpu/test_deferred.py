"""Surfaces that are shaded once a pixel against the same shaded triangle by triangle."""

import numpy as np
import pytest

from addon.passes.surface import deferred, surface_target
from benchmarks.scenes.pictures import render_picture
from tests.render.lights.shadow_scenes import diffuse, see_through_card, shadow_scene

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


def _scene(bpy):
    """Lit, glowing, half transparent and held-out surfaces before and behind each other."""
    scene = shadow_scene(bpy, "AREA", pixels=48)
    see_through_card(bpy, 0.5, (-0.6, -1.2, 1.0))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=(0.2, -1.0, 0.2))
    shiny = bpy.data.materials.new("shiny")
    shader = next(n for n in shiny.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = 0.2
    checker = shiny.node_tree.nodes.new("ShaderNodeTexChecker")
    shiny.node_tree.links.new(checker.outputs["Color"], shader.inputs["Base Color"])
    place = shiny.node_tree.nodes.new("ShaderNodeTexCoord")
    shiny.node_tree.links.new(place.outputs["Object"], checker.inputs["Vector"])
    bpy.context.object.data.materials.append(shiny)
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=(0.2, -1.2, 0.2))
    glowing = diffuse(bpy, 0.5)
    shader = glowing.node_tree.nodes.new("ShaderNodeEmission")
    shader.inputs["Strength"].default_value = 3.0
    output = next(n for n in glowing.node_tree.nodes if n.type == "OUTPUT_MATERIAL")
    glowing.node_tree.links.new(shader.outputs["Emission"], output.inputs["Surface"])
    bpy.context.object.data.materials.append(glowing)
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(1.4, -1.3, 0.5))
    bpy.context.object.is_holdout = True
    scene.render.film_transparent = True
    scene.world = bpy.data.worlds.new("world")
    scene.camera.data.dof.use_dof = True
    scene.camera.data.dof.focus_distance = 6.5
    scene.camera.data.dof.aperture_fstop = 0.5
    scene.render.engine = "APLANAT"
    scene.aplanat.method = "ADAPTIVE"
    scene.aplanat.use_target_error = False
    scene.aplanat.render_samples = 6
    return scene


def test_large_pictures_are_shaded_triangle_by_triangle():
    """Their places would take more than a gibibyte."""
    assert surface_target.of_picture(False, False, (3840, 2160)).deferred
    assert not surface_target.of_picture(False, False, (7680, 4320)).deferred


def test_shading_once_a_pixel_changes_no_bit(aplanat_bpy, monkeypatch):
    scene = _scene(aplanat_bpy)
    # With a second target.
    scene.view_layers[0].use_pass_cryptomatte_object = True
    drawn = []
    draw = deferred.draw
    monkeypatch.setattr(deferred, "draw", lambda *given: (drawn.append(1), draw(*given)))
    once = render_picture(scene)
    assert drawn
    drawn.clear()
    # As in a scene of which all other materials come first.
    monkeypatch.setattr(deferred, "MOST_MATERIALS", 0)
    each = render_picture(scene)
    assert not drawn
    np.testing.assert_array_equal(once, each)
