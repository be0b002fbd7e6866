"""Everything drawn covers the pixels that Cycles covers, in the colours of its materials."""

import json

import numpy as np
import OpenEXR
import pytest

from tests import scene_builders as scenes
from tests.pass_pictures import (
    read_passes,
    render_passes,
    render_passes_cycles,
    use_passes,
    write_passes,
)
from tests.pictures import render_aplanat, render_cycles, save_side_by_side

# Unlit colours are exact in both engines; only how much of a pixel on an outline is covered is
# sampled, by 16 and 64 places. A pixel wholly inside or outside a shape must agree: a shape that is
# missing, mirrored, in another place or of another colour differs in far more.
SAMPLES = 16
INSIDE = 1e-4
OUTLINE_MEAN = 0.012


def compare(scene, tmp_path, width=160, height=120, transparent=True):
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.film_transparent = transparent
    ours = render_aplanat(scene, SAMPLES)
    cycles = render_cycles(scene, 64)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    difference = np.abs(ours - cycles).max(axis=2)
    outlines = outline(ours) | outline(cycles)
    assert (ours[..., 3] > 0).any()
    assert difference[~outlines].max() < INSIDE, tmp_path
    assert difference.mean() < OUTLINE_MEAN, tmp_path
    return ours, cycles


def outline(picture):
    """Pixels that differ from a neighbour."""
    edge = np.zeros(picture.shape[:2], bool)
    for axis in (0, 1):
        differs = (np.abs(np.diff(picture, axis=axis)) > INSIDE).any(axis=2)
        low = [slice(None)] * 2
        high = [slice(None)] * 2
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        edge[tuple(low)] |= differs
        edge[tuple(high)] |= differs
    return edge


@pytest.fixture
def bpy(aplanat_bpy, empty_scene):
    scenes.look_along_y(aplanat_bpy, 8.0)
    return aplanat_bpy


def palette(bpy, count):
    rng = np.random.default_rng(5)
    colors = rng.uniform(0.15, 0.9, (count, 3)).tolist()
    return [scenes.emission(bpy, f"color {i}", color) for i, color in enumerate(colors)]


def test_every_kind_of_geometry_is_drawn_where_cycles_draws_it(bpy, tmp_path):
    scene = bpy.context.scene
    paint = palette(bpy, 12)
    bevelled = bpy.data.curves.new("bevelled", "CURVE")
    bevelled.dimensions = "3D"
    spline = bevelled.splines.new("POLY")
    spline.points.add(2)
    for point, place in zip(
        spline.points, ((-0.5, 0, 0), (0, 0, 0.5), (0.5, 0, -0.2)), strict=True
    ):
        point.co = (*place, 1.0)
    bevelled.bevel_depth = 0.12
    scenes.add(bpy, "bevelled", bevelled, paint[0], (-3, 2))
    wire = bpy.data.curves.new("wire", "CURVE")
    wire.splines.new("POLY").points.add(2)
    scenes.add(bpy, "wire", wire, paint[1], (0, 0))
    filled = bpy.data.curves.new("filled", "CURVE")
    filled.dimensions = "2D"
    filled.fill_mode = "BOTH"
    spline = filled.splines.new("POLY")
    spline.use_cyclic_u = True
    spline.points.add(2)
    for point, place in zip(spline.points, ((-0.5, -0.4), (0.5, -0.4), (-0.2, 0.5)), strict=True):
        point.co = (*place, 0.0, 1.0)
    scenes.add(bpy, "filled", filled, paint[2], (-1.5, 2)).rotation_euler.x = np.pi / 2
    text = bpy.data.curves.new("text", "FONT")
    text.body = "Rq"
    text.size = 1.4
    scenes.add(bpy, "text", text, paint[3], (-0.7, 1.6)).rotation_euler.x = np.pi / 2
    bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=0.5, location=(1.7, 0, 2))
    bpy.context.object.data.materials.append(paint[4])
    for x in (2.8, 3.4):
        ball = bpy.data.metaballs.new("ball")
        ball.elements.new().radius = 0.8
        ball.render_resolution = 0.15
        scenes.add(bpy, f"ball.{x:.0f}", ball, paint[5], (x, 2))
    left = scenes.add(bpy, "mirrored", scenes.triangle(bpy), paint[6], (-3, 0))
    left.scale = (-1.0, 1.0, 1.3)
    two = scenes.cube(bpy, "two")
    two.materials.append(paint[7])
    two.materials.append(paint[8])
    two.polygons[4].material_index = 1
    two.polygons[2].material_index = 1
    scenes.add(bpy, "two", two, at=(-1.5, 0)).rotation_euler = (0.5, 0.3, 0.8)
    beyond = scenes.add(bpy, "slot beyond", scenes.triangle(bpy, "beyond"), paint[9], (0, 0))
    beyond.data.polygons[0].material_index = 7
    by_object = scenes.add(bpy, "slot of object", two, at=(1.5, 0))
    by_object.rotation_euler = (0.5, 0.3, 0.8)
    by_object.material_slots[0].link = "OBJECT"
    by_object.material_slots[0].material = paint[10]
    smooth = scenes.add(bpy, "subdivided", scenes.cube(bpy, "round", 1.1), paint[11], (3, 0))
    smooth.modifiers.new("round", "SUBSURF").render_levels = 3
    for kind in ("edges only", "nothing"):
        scenes.add(
            bpy, kind, scenes.mesh(bpy, kind, [(0, 0, 0), (1, 0, 1)] * (kind != "nothing"), [])
        )
    compare(scene, tmp_path)


def test_instances_are_drawn_where_cycles_draws_them(bpy, tmp_path):
    scene = bpy.context.scene
    paint = palette(bpy, 8)
    kept, kept_layer = scenes.collection(bpy, "sources")
    source = scenes.add(bpy, "source", scenes.triangle(bpy), paint[0], collection=kept)
    second = scenes.add(bpy, "second", scenes.cube(bpy), paint[1], (0.8, 0), kept)
    second.scale = (1, 1, -1.4)
    kept_layer.exclude = True
    for i, (scale, turn) in enumerate(((1.0, 0.0), (-0.8, 0.3), (0.6, 1.0))):
        empty = scenes.add(bpy, f"empty {i}", None, at=(-3 + 2.5 * i, 2.1))
        empty.instance_type, empty.instance_collection = "COLLECTION", kept
        empty.scale = (scale, 1, 1)
        empty.rotation_euler.y = turn
    points = [(-3 + i, 0, 0.7 + 0.1 * i) for i in range(7)]
    scenes.instancer(bpy, None, paint[2], points, "balls")
    hidden = scenes.add(bpy, "hidden", scenes.triangle(bpy, "hidden"), paint[3])
    hidden.hide_render = True
    scenes.instancer(bpy, hidden, None, [(-3 + i, 0, -0.5) for i in range(7)], "triangles")
    emitter = scenes.add(bpy, "emitter", scenes.cube(bpy, "emitter", 1.2), paint[4], (-2.5, -2))
    particles = emitter.modifiers.new("particles", "PARTICLE_SYSTEM").particle_system.settings
    particles.count, particles.frame_start, particles.frame_end = 30, -20, 0
    particles.lifetime = 200
    particles.render_type, particles.instance_object = "OBJECT", source
    particles.particle_size = 0.4
    particles.use_rotations = True
    emitter.show_instancer_for_render = False
    shown = scenes.add(bpy, "shown", scenes.cube(bpy, "shown", 0.8), paint[5], (1.0, -2))
    particles = shown.modifiers.new("particles", "PARTICLE_SYSTEM").particle_system.settings
    particles.count, particles.frame_start, particles.frame_end = 20, -20, 0
    particles.render_type, particles.instance_object = "OBJECT", second
    particles.particle_size = 0.3
    faces = scenes.add(bpy, "faces", scenes.cube(bpy, "faces", 1.6), paint[6], (3, -2))
    faces.rotation_euler = (0.4, 0.2, 0.5)
    child = scenes.add(bpy, "child", scenes.triangle(bpy, "child"), paint[7])
    child.parent = faces
    faces.instance_type = "FACES"
    faces.show_instancer_for_render = False
    # Blender simulates particles anew for the first render, whichever engine it is.
    render_cycles(scene, 1)
    compare(scene, tmp_path)


def test_visibility_holdout_and_collections_act_as_in_cycles(bpy, tmp_path):
    scene = bpy.context.scene
    paint = palette(bpy, 8)
    big = scenes.cube(bpy, "big", 1.0)
    row = {}
    for i, name in enumerate(("plain", "hidden", "no camera", "holdout", "cut", "hidden parent")):
        row[name] = scenes.add(bpy, name, big.copy(), paint[i], (-3.2 + 1.25 * i, 2))
    row["hidden"].hide_render = True
    row["no camera"].visible_camera = False
    row["holdout"].is_holdout = True
    row["cut"].hide_viewport = True
    row["hidden parent"].hide_viewport = row["hidden parent"].hide_render = True
    backdrop = scenes.add(bpy, "backdrop", big.copy(), paint[6], (0, 1.9))
    backdrop.scale, backdrop.location.y = (7.4, 1, 0.5), 3
    for i, flag in enumerate(("holdout", "indirect_only", "exclude", "hide_viewport")):
        folder, layer = scenes.collection(bpy, flag)
        at = (-3 + 1.6 * i, 0)
        scenes.add(bpy, f"in {flag}", big.copy(), paint[i], at, folder)
        empty = scenes.add(bpy, f"of {flag}", None, at=(0.3, -2))
        empty.instance_type, empty.instance_collection = "COLLECTION", folder
        empty.scale = (0.7, 1, 0.7)
        setattr(layer, flag, True)
    folder, layer = scenes.collection(bpy, "hidden collection")
    scenes.add(bpy, "in hidden collection", big.copy(), paint[5], (3.2, 0), folder)
    folder.hide_render = True
    folder, layer = scenes.collection(bpy, "instancers held out")
    source = bpy.data.collections["exclude"]
    empty = scenes.add(bpy, "held out instance", None, at=(-0.4, 0.2), collection=folder)
    empty.instance_type, empty.instance_collection = "COLLECTION", source
    layer.holdout = True
    behind = scenes.add(bpy, "behind", big.copy(), paint[7], (0, -0.2))
    behind.scale, behind.location.y = (7.4, 1, 0.4), 3
    ours, _ = compare(scene, tmp_path)
    assert (ours[..., 3] == 0).any()


def test_each_view_layer_has_its_own_collections_and_material(bpy, tmp_path):
    scene = bpy.context.scene
    paint = palette(bpy, 3)
    folder, _ = scenes.collection(bpy, "left")
    scenes.add(bpy, "left", scenes.triangle(bpy, "left"), paint[0], (-2, 0), folder)
    scenes.add(bpy, "right", scenes.cube(bpy, "right", 1.5), paint[1], (2, 0))
    other = scene.view_layers.new("other")
    other.layer_collection.children["left"].exclude = True
    other.material_override = paint[2]
    for name in ("ViewLayer", "other"):
        for layer in scene.view_layers:
            layer.use = layer.name == name
        compare(scene, tmp_path, 80, 60)


@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("switch", ["none", "use_sky", "use_solid", "world_override"])
def test_a_view_layer_without_surfaces_or_world_or_with_its_own(bpy, tmp_path, switch, transparent):
    scene = bpy.context.scene
    worlds = []
    for color in ((0.1, 0.2, 0.7), (0.2, 0.6, 0.1)):
        world = bpy.data.worlds.new("world")
        world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)
        worlds.append(world)
    scene.world = worlds[0]
    scenes.add(bpy, "cube", scenes.cube(bpy, size=2), palette(bpy, 1)[0])
    if switch != "none":
        value = worlds[1] if switch == "world_override" else False
        setattr(scene.view_layers[0], switch, value)
    scene.render.film_transparent = transparent
    ours = render_aplanat(scene, 4)
    cycles = render_cycles(scene, 4)
    assert np.abs(ours - cycles)[[2, 32], [2, 48]].max() < INSIDE


def test_an_animated_world_has_the_value_of_the_frame_that_is_rendered(bpy, tmp_path):
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    strength = scene.world.node_tree.nodes["Background"].inputs["Strength"]
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    for frame in (1, 2):
        strength.default_value = frame / 4
        strength.keyframe_insert("default_value", frame=frame)
    # As in a render of an animation, the scene itself stays at another frame.
    scene.frame_set(1)
    assert render_aplanat(scene, 1)[0, 0, 0] == pytest.approx(0.25, abs=1e-6)
    scene.frame_start, scene.frame_end = 2, 2
    scene.render.filepath = str(tmp_path / "frame_")
    scene.render.use_file_extension = True
    bpy.ops.render.render(animation=True)
    with OpenEXR.File(str(tmp_path / "frame_0002.exr")) as file:
        assert file.channels()["RGBA"].pixels[0, 0, 0] == pytest.approx(0.5, abs=1e-6)


def test_colour_attributes_of_every_kind_have_cycles_values(bpy, tmp_path):
    scene = bpy.context.scene
    rng = np.random.default_rng(2)
    kinds = [(t, d) for t in ("BYTE_COLOR", "FLOAT_COLOR") for d in ("POINT", "CORNER")]
    for i, (kind, domain) in enumerate(kinds):
        data = scenes.cube(bpy, f"{kind} {domain}", 1.3)
        attribute = data.color_attributes.new("tint", kind, domain)
        values = rng.uniform(0.1, 0.9, (len(attribute.data), 4)).astype(np.float32)
        attribute.data.foreach_set("color", values.ravel())
        paint = scenes.emission(bpy, f"paint {i}", (0, 0, 0), attribute="tint")
        obj = scenes.add(bpy, data.name, data, paint, (-3 + 2 * i, 0))
        obj.rotation_euler = (0.5, 0.3, 0.8)
    ours, cycles = (render_aplanat(scene, 64), render_cycles(scene, 64))
    save_side_by_side(tmp_path / "colors.png", ours, cycles)
    covered = (ours[..., 3] == 1) & (cycles[..., 3] == 1)
    assert covered.mean() > 0.1
    # Colours vary over a pixel and jump between faces, where both engines sample them.
    difference = np.abs(ours - cycles)[covered]
    assert np.quantile(difference, 0.98) < 0.02
    assert difference.mean() < 2e-3


def test_the_hull_of_a_volume_is_not_seen_but_a_material_without_surface_is_black(bpy, tmp_path):
    scene = bpy.context.scene
    for name, x in (("fog", -2), ("nothing", 2)):
        paint = scenes.emission(bpy, name, (1, 0, 0))
        tree = paint.node_tree
        tree.links.clear()
        if name == "fog":
            fog = tree.nodes.new("ShaderNodeVolumeScatter")
            fog.inputs["Density"].default_value = 0.0
            output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
            tree.links.new(fog.outputs["Volume"], output.inputs["Volume"])
        scenes.add(bpy, name, scenes.cube(bpy, name, 1.5), paint, (x, 0))
    ours, _ = compare(scene, tmp_path, 80, 60)
    assert ours[30, 20].tolist() == [0, 0, 0, 0]
    assert ours[30, 60].tolist() == [0, 0, 0, 1]


def test_copies_have_the_names_of_cycles_manifest(bpy, tmp_path):
    scene = bpy.context.scene
    (paint,) = palette(bpy, 1)
    source = scenes.add(bpy, "source", scenes.cube(bpy), paint)
    source.hide_render = True
    folder = bpy.data.collections.new("folder")
    scenes.add(bpy, "inside", scenes.triangle(bpy), paint, collection=folder)
    empty = scenes.add(bpy, "empty", None, at=(2, 2))
    empty.instance_type, empty.instance_collection = "COLLECTION", folder
    scenes.instancer(bpy, None, paint, [(-2, 0, -1)], "made")
    scenes.instancer(bpy, source, paint, [(-2, 0, 2)], "placed")
    text = bpy.data.curves.new("text", "FONT")
    text.body = "T"
    scenes.add(bpy, "text object", text, paint).rotation_euler.x = np.pi / 2
    emitter = scenes.add(bpy, "emitter", scenes.cube(bpy, "emitter"), paint, (2, -2))
    particles = emitter.modifiers.new("particles", "PARTICLE_SYSTEM").particle_system.settings
    particles.frame_start, particles.frame_end, particles.count = -5, 0, 5
    particles.render_type, particles.instance_object = "OBJECT", source
    use_passes(scene.view_layers[0], "cryptomatte_object")
    manifests = {}
    for engine in ("APLANAT", "CYCLES"):
        scene.render.engine = engine
        scene.cycles.samples = scene.aplanat.render_samples = 1
        write_passes(scene, tmp_path / f"{engine}.exr")
        _, header = read_passes(tmp_path / f"{engine}.exr")
        (key,) = (key for key in header if key.endswith("/manifest"))
        manifests[engine] = json.loads(header[key])
    ours, cycles = manifests["APLANAT"], manifests["CYCLES"]
    assert set(ours) == {"source", "inside", "made", "text object", "emitter"}
    # Cycles also lists objects without faces.
    assert ours.items() <= cycles.items()


def test_normals_of_every_kind_are_those_of_cycles(bpy, tmp_path):
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    (paint,) = palette(bpy, 1)
    import bmesh

    rng = np.random.default_rng(4)

    def ball(name, x, z, subdivisions=2):
        data = bpy.data.meshes.new(name)
        shape = bmesh.new()
        bmesh.ops.create_icosphere(shape, subdivisions=subdivisions, radius=0.9)
        shape.to_mesh(data)
        shape.free()
        return scenes.add(bpy, name, data, paint, (x, z))

    ball("flat", -3, 2, 1).data.shade_flat()
    ball("smooth", -1, 2).data.shade_smooth()
    mirrored = ball("mirrored", 1, 2)
    mirrored.data.shade_smooth()
    mirrored.scale = (-1.0, 1.0, 0.6)
    sharp = ball("sharp", 3, 2)
    sharp.data.shade_smooth()
    for edge in sharp.data.edges:
        edge.use_edge_sharp = edge.index % 3 == 0
    custom = ball("custom", -3, -1)
    wanted = rng.normal(size=(len(custom.data.vertices), 3)) * 0.3 + (0, -1, 0)
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    custom.data.normals_split_custom_set_from_vertices(wanted.tolist())
    mixed = ball("mixed", -1, -1)
    for polygon in mixed.data.polygons:
        polygon.use_smooth = polygon.index % 2 == 0
    text = bpy.data.curves.new("text", "FONT")
    text.body, text.extrude, text.size = "R", 0.2, 1.5
    scenes.add(bpy, "text", text, paint, (0.6, -1.5)).rotation_euler = (1.4, 0.3, 0.2)
    turned = ball("turned inside out", 3, -1)
    turned.data.shade_smooth()
    turned.scale = (-1.0, -1.0, -1.0)
    use_passes(scene.view_layers[0], "normal")
    scene.render.engine = "APLANAT"
    scene.aplanat.method = "REFERENCE"
    scene.aplanat.render_samples = 1
    ours = render_passes(scene)[0]["ViewLayer.Normal"]
    cycles = render_passes_cycles(scene, 64)[0]["ViewLayer.Normal"]
    save_side_by_side(tmp_path / "normals.png", ours * 0.5 + 0.5, cycles * 0.5 + 0.5)
    length = np.linalg.norm(cycles, axis=2)
    # Cycles takes the mean over a pixel, which is shorter where normals jump: at outlines and sharp
    # edges. What is left differs by where in a pixel each engine looks.
    steady = length > 0.998
    assert steady.mean() > 0.15
    difference = np.abs(ours - cycles)[steady]
    assert np.quantile(difference, 0.97) < 0.02
    assert difference.mean() < 4e-3
