"""Ray visibility of lights and portals against Cycles, on a glossy floor under one lamp."""

import pytest

from tests.pictures import energy_ratio, render_aplanat, render_cycles

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


def build(bpy, kind):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 32, 24
    bpy.ops.mesh.primitive_plane_add(size=4, location=(0, 0, -4))
    material = bpy.data.materials.new("floor")
    material.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.3
    bpy.context.object.data.materials.append(material)
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", kind))
    lamp.data.energy, lamp.location = 100.0, (0, 0, -1)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    for thing in (lamp, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera
    # Cycles crashes with a portal and no world.
    scene.world = bpy.data.worlds.new("World")
    sky = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
    sky.inputs["Color"].default_value = (0.1, 0.1, 0.1, 1.0)
    return scene, lamp


def no_diffuse(lamp):
    lamp.visible_diffuse = False


def no_glossy(lamp):
    lamp.visible_glossy = False


def portal(lamp):
    lamp.data.cycles.is_portal = True


@pytest.mark.parametrize(
    ("change", "kind"),
    [(no_diffuse, "POINT"), (no_glossy, "POINT"), (portal, "AREA")],
    ids=["diffuse off", "glossy off", "portal"],
)
def test_lamp_gives_the_light_that_cycles_gives(aplanat_bpy, change, kind):
    pictures = []
    for render, samples in ((render_aplanat, 16), (render_cycles, 64)):
        scene, lamp = build(aplanat_bpy, kind)
        change(lamp)
        pictures.append(render(scene, samples)[..., :3])
    # Cycles' noise with 64 samples of a smooth picture; the switches change it by 6 % and more.
    assert energy_ratio(*pictures) == pytest.approx(1.0, abs=0.003)
