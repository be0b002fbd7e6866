"""What Cycles or EEVEE obey and Aplanat does not draw is told, once, with its name."""

from pathlib import Path

import numpy as np
import pytest

from addon.scene.extract import SceneExtractor
from tests import scene_builders as scenes


@pytest.fixture
def bpy(aplanat_bpy, empty_scene):
    return aplanat_bpy


def report(bpy):
    return SceneExtractor().extract_content(bpy.context.evaluated_depsgraph_get()).report


def add_light(bpy, kind, name="Lamp"):
    lamp = bpy.data.objects.new(name, bpy.data.lights.new(name, kind))
    bpy.context.scene.collection.objects.link(lamp)
    lamp.data.energy = 10.0
    return lamp


def test_a_plain_scene_has_no_warnings(bpy):
    bpy.ops.wm.read_factory_settings()
    assert report(bpy) == ()


def test_motion_blur_is_told_unless_the_view_layer_has_it_off(bpy):
    bpy.context.scene.render.use_motion_blur = True
    (line,) = report(bpy)
    assert line.startswith("scene 'Scene': motion blur is not drawn")
    bpy.context.view_layer.use_motion_blur = False
    assert report(bpy) == ()


def test_passes_not_offered_are_named_in_one_line(bpy):
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_cryptomatte_object = True
    assert report(bpy) == ()
    layer.use_pass_mist = layer.use_pass_uv = True
    layer.cycles.denoising_store_passes = True
    layer.aovs.add().name = "mask"
    layer.lightgroups.add(name="key")
    (line,) = report(bpy)
    assert line.startswith("view layer 'ViewLayer': passes that Aplanat does not offer")
    for name in ("UV", "Mist", "Denoising Data", "AOV 'mask'", "light group 'key'"):
        assert name in line


def test_every_switch_of_a_pass_is_offered_or_told(bpy):
    layer = bpy.context.view_layer
    from addon.scene.unsupported import _OFFERED

    for owner in (layer, layer.cycles, layer.eevee):
        for prop in owner.bl_rna.properties:
            if not prop.identifier.startswith("use_pass_") or prop.identifier in _OFFERED:
                continue
            before = getattr(owner, prop.identifier)
            setattr(owner, prop.identifier, True)
            assert any("left out" in line for line in report(bpy)), prop.identifier
            setattr(owner, prop.identifier, before)


def test_film_exposure_and_distance_culling_of_cycles_are_told(bpy):
    scene = bpy.context.scene
    scene.cycles.film_exposure = 1.5
    scene.cycles.use_distance_cull = True
    (line,) = report(bpy)
    assert "film exposure" in line and "1.5" in line
    scene.render.use_simplify = True
    assert any("distance culling" in line for line in report(bpy))


def test_ray_visibility_of_the_world_is_told(bpy):
    world = bpy.data.worlds.new("Sky")
    bpy.context.scene.world = world
    assert report(bpy) == ()
    world.cycles_visibility.camera = False
    (line,) = report(bpy)
    assert line.startswith("world 'Sky'") and "camera" in line


def test_ray_visibility_of_lights_is_heeded(bpy):
    lamp = add_light(bpy, "POINT")

    def factors():
        depsgraph = bpy.context.evaluated_depsgraph_get()
        (light,) = SceneExtractor().extract_content(depsgraph).lights
        return light.diffuse_factor, light.specular_factor

    assert factors() == (1.0, 1.0)
    lamp.visible_diffuse = False
    assert factors() == (0.0, 1.0)
    lamp.visible_diffuse, lamp.visible_glossy = True, False
    assert factors() == (1.0, 0.0)
    assert report(bpy) == ()


def test_lamps_seen_by_the_camera_and_light_linking_are_told(bpy):
    lamp = add_light(bpy, "AREA")
    lamp.visible_camera = True
    lamp.light_linking.receiver_collection = bpy.data.collections.new("lit")
    seen, linked = report(bpy)
    assert seen.startswith("object 'Lamp'") and "camera" in seen
    assert linked.startswith("object 'Lamp'") and "light linking" in linked


def test_a_portal_gives_no_light_and_is_told(bpy):
    add_light(bpy, "AREA", "Window").data.cycles.is_portal = True
    content = SceneExtractor().extract_content(bpy.context.evaluated_depsgraph_get())
    assert content.lights == ()
    (line,) = content.report
    assert line.startswith("object 'Window'") and "portal" in line


def test_adaptive_subdivision_and_probes_are_told(bpy):
    bpy.ops.object.lightprobe_add(type="SPHERE")
    rock = scenes.add(bpy, "rock", scenes.cube(bpy))
    rock.modifiers.new("Subdivision", "SUBSURF").use_adaptive_subdivision = True
    lines = report(bpy)
    assert any(line.startswith("object 'rock': adaptive subdivision") for line in lines)
    assert any("light probe" in line for line in lines)


def test_missing_library_and_what_it_lacks_are_told_by_name(bpy, tmp_path):
    wm = bpy.ops.wm
    collection = bpy.data.collections.new("Props")
    bpy.context.scene.collection.children.link(collection)
    wm.save_as_mainfile(filepath=str(tmp_path / "props.blend"))
    wm.read_factory_settings(use_empty=True)
    wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    library = str(tmp_path / "props.blend")
    with bpy.data.libraries.load(library, link=True, relative=True) as (_, to):
        to.collections = ["Props"]
    place = bpy.data.objects.new("Place", None)
    place.instance_type, place.instance_collection = "COLLECTION", bpy.data.collections["Props"]
    bpy.context.scene.collection.objects.link(place)
    wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    assert report(bpy) == ()

    wm.open_mainfile(filepath=str(tmp_path / "props.blend"))
    bpy.data.collections["Props"].name = "Renamed"
    wm.save_as_mainfile(filepath=str(tmp_path / "props.blend"))
    wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    (line,) = report(bpy)
    assert line == "library '//props.blend' lacks what is linked: collection 'Props'"

    (tmp_path / "props.blend").unlink()
    wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    (line,) = report(bpy)
    assert line.startswith("library '//props.blend' cannot be read")
    assert "collection 'Props'" in line


def test_missing_fonts_and_caches_are_told_by_name(bpy, tmp_path):
    text = bpy.data.objects.new("Text", bpy.data.curves.new("Text", "FONT"))
    bpy.context.scene.collection.objects.link(text)
    assert report(bpy) == ()
    path = tmp_path / "letters.ttf"
    # Blender looks into the file when it loads it, and keeps what it found.
    system = next(Path("/usr/share/fonts").rglob("*.ttf"), None) or next(
        Path(bpy.utils.system_resource("DATAFILES", path="fonts")).glob("*.woff2"), None
    )
    if system is None:
        pytest.skip("there is no font to copy")
    path.write_bytes(system.read_bytes())
    text.data.font = bpy.data.fonts.load(str(path))
    assert report(bpy) == ()
    path.unlink()
    (line,) = report(bpy)
    assert line.startswith("font '") and "letters.ttf" in line

    cube = scenes.add(bpy, "cube", scenes.cube(bpy))
    bpy.ops.wm.alembic_export(filepath=str(tmp_path / "cube.abc"), as_background_job=False)
    bpy.data.objects.remove(text)
    bpy.ops.cachefile.open(filepath=str(tmp_path / "cube.abc"))
    (cache,) = bpy.data.cache_files
    cube.modifiers.new("cache", "MESH_SEQUENCE_CACHE").cache_file = cache
    assert not any("cache file" in line for line in report(bpy))
    (tmp_path / "cube.abc").unlink()
    assert any(line.startswith("cache file 'cube.abc'") for line in report(bpy))


def test_custom_distance_of_eevee_is_told(bpy):
    add_light(bpy, "POINT").data.use_custom_distance = True
    (line,) = report(bpy)
    assert line.startswith("object 'Lamp'") and "custom distance" in line


def test_grease_pencil_and_freestyle_are_drawn_by_blender_as_for_every_engine(bpy, tmp_path):
    from tests.pictures import render_aplanat

    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera, camera.location = camera, (0, -6, 0)
    camera.rotation_euler = (np.pi / 2, 0, 0)
    scene.render.film_transparent = True
    assert not render_aplanat(scene, 1).any()
    bpy.ops.object.grease_pencil_add(type="STROKE")
    assert render_aplanat(scene, 1)[..., 3].any()
    scene.render.use_freestyle = bpy.context.view_layer.use_freestyle = True
    bpy.context.view_layer.freestyle_settings.linesets.new("lines")
    assert not report(bpy)
