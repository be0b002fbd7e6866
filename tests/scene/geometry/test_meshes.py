"""Meshes that Blender evaluated, as the renderer gets them."""

import numpy as np
import pytest

from addon.scene.extract import SceneExtractor
from addon.scene.geometry.meshes import read_mesh, used_slots
from tests import scene_builders as scenes


@pytest.fixture
def bpy(aplanat_bpy, empty_scene):
    return aplanat_bpy


def grid(bpy, count=3):
    """A grid of quads on z = x y, with its middle at the origin."""
    side = np.linspace(-1, 1, count + 1)
    vertices = [(x, y, x * y) for y in side for x in side]
    faces = [
        (i, i + 1, i + count + 2, i + count + 1)
        for i in range(len(vertices) - count - 2)
        if i % (count + 1) < count
    ]
    return scenes.mesh(bpy, "grid", vertices, faces)


def triangles_of(reading):
    snapshot = reading.snapshot
    return snapshot.positions[snapshot.triangles]


def test_only_the_attributes_asked_for_are_read_and_nothing_is_split_without_them(bpy):
    data = grid(bpy)
    data.uv_layers.new(name="seams").uv.foreach_set(
        "vector", np.random.default_rng(1).uniform(size=2 * len(data.loops)).astype(np.float32)
    )
    data.shade_flat()
    snapshot = read_mesh(data, (), "o").snapshot
    assert snapshot.attributes == {}
    assert len(snapshot.positions) == len(data.vertices)
    assert len(snapshot.triangles) == 2 * len(data.polygons)
    split = read_mesh(data, {"uv:seams"}, "o").snapshot
    assert set(split.attributes) == {"uv:seams"}
    assert len(split.positions) == len(data.loops)


def test_generated_coordinates_run_over_the_texture_space_and_split_nothing(bpy):
    data = grid(bpy)
    data.use_auto_texspace = False
    # Half its extent; none along z, where everything is in the middle.
    data.texspace_location, data.texspace_size = (1.0, 0.0, 0.0), (2.0, 1.0, 0.0)
    read = read_mesh(data, {"generated"}, "o").snapshot
    x, y, _ = read.positions.T
    expected = np.stack([(x + 1.0) / 4.0, (y + 1.0) / 2.0, np.full(len(x), 0.5)], axis=1)
    np.testing.assert_allclose(read.attributes["generated"], expected, atol=1e-6)
    assert len(read.positions) == len(data.vertices)


def test_where_nothing_was_carried_generated_coordinates_are_those_of_the_base(bpy):
    base = grid(bpy)
    deformed = base.copy()
    scenes.set_coordinate(deformed, 5, 7.0)
    # A viewport: Blender carries coordinates through modifiers for renders only.
    read = read_mesh(deformed, {"generated"}, "o", base, carried=False).snapshot
    expected = read_mesh(base, {"generated"}, "o").snapshot
    np.testing.assert_array_equal(read.attributes["generated"], expected.attributes["generated"])
    subdivided = grid(bpy, 4)
    read = read_mesh(subdivided, {"generated"}, "o", base, carried=False).snapshot
    expected = read_mesh(subdivided, {"generated"}, "o").snapshot
    np.testing.assert_array_equal(read.attributes["generated"], expected.attributes["generated"])


def test_smooth_normals_split_nothing_and_flat_ones_every_corner(bpy):
    data = grid(bpy)
    data.shade_smooth()
    smooth = read_mesh(data, {"normal"}, "o").snapshot
    assert len(smooth.positions) == len(data.vertices)
    assert np.allclose(np.linalg.norm(smooth.attributes["normal"], axis=1), 1, atol=1e-6)
    data.shade_flat()
    flat = read_mesh(data, {"normal"}, "o")
    assert len(flat.snapshot.positions) == len(data.loops)
    normals = flat.snapshot.attributes["normal"][flat.snapshot.triangles]
    assert (normals == normals[:, :1]).all()


def test_sharp_edges_and_custom_normals_arrive_at_their_corners(bpy):
    data = grid(bpy, 2)
    wanted = np.random.default_rng(3).normal(size=(len(data.loops), 3))
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    data.normals_split_custom_set(wanted.tolist())
    snapshot = read_mesh(data, {"normal"}, "o").snapshot
    assert len(snapshot.positions) == len(data.loops)
    data.calc_loop_triangles()
    for triangle, indices in zip(data.loop_triangles, snapshot.triangles, strict=True):
        # Blender packs custom normals into two 16-bit angles.
        found = snapshot.attributes["normal"][indices]
        assert np.abs(found - wanted[list(triangle.loops)]).max() < 1e-3


def test_uv_without_name_is_the_layer_active_for_rendering(bpy):
    data = grid(bpy)
    for name, value in (("first", 0.25), ("second", 0.75)):
        layer = data.uv_layers.new(name=name)
        layer.uv.foreach_set("vector", np.full(2 * len(data.loops), value, np.float32))
    data.uv_layers["second"].active_render = True
    data.uv_layers["first"].active = True
    attributes = read_mesh(data, {"uv:", "uv:first", "uv:none"}, "o").snapshot.attributes
    assert set(attributes) == {"uv:", "uv:first"}
    assert (attributes["uv:"] == 0.75).all()
    assert (attributes["uv:first"] == 0.25).all()


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
@pytest.mark.parametrize("kind", ["BYTE_COLOR", "FLOAT_COLOR"])
def test_colour_attributes_are_scene_linear(bpy, kind, domain):
    data = grid(bpy)
    attribute = data.color_attributes.new("tint", kind, domain)
    for element in attribute.data:
        element.color_srgb = (0.5, 0.25, 1.0, 0.5)
    data.color_attributes.render_color_index = 0
    values = read_mesh(data, {"color:"}, "o").snapshot.attributes["color:"]
    linear = [((c + 0.055) / 1.055) ** 2.4 for c in (0.5, 0.25, 1.0)]
    # Half a step of 8 bits where the slope of the curve is largest.
    assert np.abs(values - [*linear, 0.5]).max() < (0.005 if kind == "BYTE_COLOR" else 1e-5)


@pytest.mark.parametrize(
    ("kind", "member", "value", "expected"),
    [
        ("FLOAT", "value", 0.5, (0.5, 0.5, 0.5, 1)),
        ("INT", "value", 3, (3, 3, 3, 1)),
        ("INT8", "value", 3, (3, 3, 3, 1)),
        ("BOOLEAN", "value", True, (1, 1, 1, 1)),
        ("FLOAT_VECTOR", "vector", (1, 2, 3), (1, 2, 3, 1)),
    ],
)
@pytest.mark.parametrize("domain", ["POINT", "CORNER", "FACE"])
def test_any_attribute_can_be_a_colour(bpy, kind, member, value, expected, domain):
    data = grid(bpy)
    attribute = data.attributes.new("generic", kind, domain)
    for element in attribute.data:
        setattr(element, member, value)
    values = read_mesh(data, {"color:generic"}, "o").snapshot.attributes["color:generic"]
    assert (values == expected).all()


def test_face_values_reach_the_corners_of_their_face(bpy):
    data = grid(bpy)
    attribute = data.attributes.new("number", "FLOAT", "FACE")
    numbers = np.arange(len(data.polygons), dtype=np.float32)
    attribute.data.foreach_set("value", numbers)
    snapshot = read_mesh(data, {"color:number"}, "o").snapshot
    data.calc_loop_triangles()
    expected = [t.polygon_index for t in data.loop_triangles]
    found = snapshot.attributes["color:number"][snapshot.triangles][..., 0]
    assert (found == np.array(expected)[:, None]).all()


def test_values_that_are_not_finite_are_drawn_as_0_and_reported(bpy):
    data = grid(bpy)
    attribute = data.attributes.new("broken", "FLOAT", "POINT")
    attribute.data[2].value = float("nan")
    reading = read_mesh(data, {"color:broken"}, "thing")
    assert np.isfinite(reading.snapshot.attributes["color:broken"]).all()
    (note,) = reading.notes
    assert "'thing'" in note
    assert "'grid'" in note
    assert "broken" in note


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf")])
def test_triangles_at_a_coordinate_that_is_not_finite_are_left_out(bpy, bad):
    data = grid(bpy)
    whole = triangles_of(read_mesh(data, (), "thing"))
    scenes.set_coordinate(data, 5, bad)
    reading = read_mesh(data, (), "thing")
    (note,) = reading.notes
    # Vertex 5 of the 4 x 4 is inside: two quads of three have one triangle there, two have both.
    assert "object 'thing': 1 vertices of mesh 'grid'" in note and "the 6 triangles" in note
    kept = triangles_of(reading)
    assert len(kept) == len(whole) - 6
    assert np.isfinite(kept).all()
    ((_, first, count),) = reading.snapshot.slots
    assert (first, count) == (0, len(kept))


def test_triangles_are_sorted_by_slot_and_keep_their_order(bpy):
    data = grid(bpy)
    plain = triangles_of(read_mesh(data, (), "o"))
    slots = np.array([2, 0, 2, 0, 0, 2, 2, 2, 0], np.int32)
    data.attributes.new("material_index", "INT", "FACE").data.foreach_set("value", slots)
    reading = read_mesh(data, (), "o")
    assert reading.snapshot.slots == ((0, 0, 8), (2, 8, 10))
    assert used_slots(data) == (0, 2)
    order = np.argsort(np.repeat(slots, 2), kind="stable")
    assert np.array_equal(triangles_of(reading), plain[order])


def test_polygons_become_triangles_that_cover_them(bpy):
    corners = [(0, 0, 0), (4, 0, 0), (4, 3, 0), (2, 1, 0), (0, 3, 0)]
    data = scenes.mesh(bpy, "concave", corners, [(0, 1, 2, 3, 4)])
    a, b, c = np.moveaxis(triangles_of(read_mesh(data, (), "o")), 1, 0)
    # 12 less the notch of 4.
    assert np.cross(b - a, c - a)[:, 2].sum() / 2 == pytest.approx(8.0)


@pytest.mark.parametrize("vertices", [[], [(0, 0, 0)], [(0, 0, 0), (1, 0, 0)]])
def test_a_mesh_without_faces_is_empty(bpy, vertices):
    data = scenes.mesh(bpy, "bare", vertices, [])
    snapshot = read_mesh(data, {"normal", "uv:", "color:"}, "o").snapshot
    assert snapshot.slots == ()
    assert snapshot.triangles.shape == (0, 3)
    assert used_slots(data) == ()


def test_degenerate_faces_are_no_error(bpy):
    data = scenes.mesh(bpy, "degenerate", [(0, 0, 0)] * 3, [(0, 1, 2)])
    assert len(read_mesh(data, {"normal"}, "o").snapshot.triangles) == 1


def test_a_mesh_that_shape_keys_deform_tells_how_it_is_at_rest_in_every_frame(empty_scene):
    import bpy

    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8)
    thing = bpy.context.object
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="long")
    for point in key.data:
        point.co.z *= 2.0
    for frame, value in ((1, 0.0), (3, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    rests = []
    for frame in (3, 2):
        empty_scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        (mesh,) = SceneExtractor().extract_content(depsgraph).meshes.values()
        assert np.abs(mesh.positions[:, 2]).max() == pytest.approx(2.0 if frame == 3 else 1.5)
        assert np.abs(mesh.rest[:, 2]).max() == pytest.approx(1.0)
        rests.append(mesh.rest.tobytes())
    assert rests[0] == rests[1]


def test_what_nothing_deforms_and_what_has_other_faces_than_its_base_has_no_rest(empty_scene):
    import bpy

    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.modifiers.new("smooth", "SUBSURF").levels = 2
    depsgraph = bpy.context.evaluated_depsgraph_get()
    meshes = SceneExtractor().extract_content(depsgraph).meshes.values()
    assert [mesh.rest for mesh in meshes] == [None, None]
