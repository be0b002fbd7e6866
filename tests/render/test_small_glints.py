"""Small lit objects out of focus: the light that is splatted is what the lens samples leave out."""

import math

import numpy as np
import pytest

from addon.engine.shared_resources import listen

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

SAMPLES = 128


def build(bpy, seed, parallel):
    """Build small balls and balls of wire, glossy and matt, lit by a sun and a lamp."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, rng = bpy.context.scene, np.random.default_rng(seed)
    scene.render.engine = "APLANAT"
    scene.render.resolution_x = scene.render.resolution_y = 32
    scene.render.resolution_percentage = 100
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.rotation_euler = (math.pi / 2, 0.0, 0.0)
    scene.camera = camera
    data = camera.data
    data.lens, data.clip_start = 60.0, 0.5
    # Discs of some pixels in radius.
    data.dof.use_dof, data.dof.focus_distance = True, 0.5 if parallel else 2.0
    data.dof.aperture_fstop = 7.0 if parallel else 0.15
    if parallel:
        data.type, data.ortho_scale = "ORTHO", 3.0
    items = [camera]
    for kind, strength in (("SUN", 4.0), ("POINT", 800.0)):
        light = bpy.data.lights.new(kind, kind)
        light.energy = strength
        item = bpy.data.objects.new(kind, light)
        item.location = (*rng.uniform(-2.0, 2.0, 2), rng.uniform(1.0, 3.0))
        item.rotation_euler = (rng.uniform(0.2, 0.8), 0.0, rng.uniform(-1.0, 1.0))
        items.append(item)
    for number in range(3):
        material = bpy.data.materials.new("m")
        shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        shader.inputs["Roughness"].default_value = rng.uniform(0.15, 0.4)
        shader.inputs["Metallic"].default_value = float(number == 0)
        shader.inputs["Specular IOR Level"].default_value = 0.5 * (number != 2)
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=rng.uniform(0.06, 0.12))
        item = bpy.context.object
        item.location = (rng.uniform(-0.6, 0.6), rng.uniform(3.5, 4.5), 0.5 * number - 0.5)
        item.data.materials.append(material)
        item.data.polygons.foreach_set("use_smooth", np.ones(len(item.data.polygons), bool))
        if rng.random() < 0.4:
            item.modifiers.new("wires", "WIREFRAME").thickness = 0.01
    for item in items[:3]:
        scene.collection.objects.link(item)
    settings = scene.aplanat
    settings.method, settings.use_reference_bokeh = "REFERENCE", True
    settings.use_target_error, settings.render_samples = False, SAMPLES
    data.aplanat.bokeh.threshold = 0.5
    layer = scene.view_layers[0].aplanat
    layer.use_pass_bokeh = layer.use_pass_defocus = True
    return scene


def render(bpy):
    with listen(keep_pictures=True) as heard:
        bpy.ops.render.render()
    if heard.error is not None:
        raise heard.error
    return {
        name: made.pixels[..., :3].sum(axis=(0, 1), dtype=np.float64)
        for name, made in heard.layers[0].passes.items()
    }


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("seed", [1, 2])
def test_what_samples_leave_out_is_what_the_search_finds(seed, parallel, aplanat_bpy):
    scene = build(aplanat_bpy, seed, parallel)
    split = render(aplanat_bpy)
    scene.camera.data.aplanat.bokeh.use = False
    whole = render(aplanat_bpy)["Combined"]
    left_out = whole - split["Defocus"]
    assert (left_out > 0.2 * whole).all()
    # Samples with other seeds differ by 2 %. When only lamps were searched finely, 34 % less was
    # found, or 24 % more.
    np.testing.assert_allclose(split["Bokeh"], left_out, rtol=0.05)
    np.testing.assert_allclose(split["Combined"], whole, rtol=0.04)
