import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from addon.scene.geometry.vertex_split import split_all, split_vertices


@st.composite
def meshes(draw):
    vertex_count = draw(st.integers(1, 6))
    count = draw(st.integers(0, 24))
    corner_vertices = draw(arrays(np.int32, count, elements=st.integers(0, vertex_count - 1)))
    # Few different values, so that corners often agree; both zeros and not-a-number among them.
    numbers = st.sampled_from([0.0, -0.0, 1.0, 2.0, float("nan")])
    values = [
        draw(arrays(np.float32, (count, k), elements=numbers))
        for k in draw(st.lists(st.integers(1, 4), max_size=3))
    ]
    return corner_vertices, vertex_count, values


def bits(values):
    return np.ascontiguousarray(values).view(np.int32)


@given(meshes())
def test_every_corner_finds_its_vertex_and_its_values(mesh):
    corner_vertices, vertex_count, values = mesh
    split = split_vertices(corner_vertices, vertex_count, values)
    assert np.array_equal(split.vertices[split.index], corner_vertices)
    for column in values:
        if len(column):
            assert np.array_equal(bits(split.of_corners(column)[split.index]), bits(column))


@given(meshes())
def test_no_two_new_vertices_are_equal_and_old_ones_keep_their_number(mesh):
    corner_vertices, vertex_count, values = mesh
    split = split_vertices(corner_vertices, vertex_count, values)
    rows = {
        (v, *(x.tobytes() for x in (c[i] for c in values)))
        for i, v in enumerate(corner_vertices.tolist())
    }
    unused = vertex_count - len(set(corner_vertices.tolist()))
    assert len(split.vertices) == len(rows) + unused
    assert np.array_equal(split.vertices[:vertex_count], np.arange(vertex_count))
    assert split.unsplit == (len(split.vertices) == vertex_count)
    assert split.index.dtype == np.int32


@given(meshes())
def test_the_same_input_gives_the_same_split(mesh):
    first, second = split_vertices(*mesh), split_vertices(*mesh)
    assert np.array_equal(first.index, second.index)
    assert np.array_equal(first.corners, second.corners)


def test_vertices_without_corner_values_are_not_copied():
    corner_vertices = np.array([0, 1, 2, 2, 1, 3], np.int32)
    split = split_vertices(corner_vertices, 4)
    positions = np.zeros((4, 3), np.float32)
    assert split.index is corner_vertices
    assert split.of_vertices(positions) is positions


def test_flat_shading_gives_every_corner_its_own_vertex():
    # As many corners as vertices, in another order: nothing may be taken for unsplit.
    corner_vertices = np.array([2, 0, 1], np.int32)
    split = split_all(corner_vertices)
    positions = np.arange(9, dtype=np.float32).reshape(3, 3)
    assert np.array_equal(split.of_vertices(positions), positions[corner_vertices])
    assert np.array_equal(split.index, [0, 1, 2])


def test_corners_of_a_cones_tip_are_grouped_by_value():
    # One vertex with very many corners of few values: time must not grow with their product.
    count = 200_000
    values = (np.arange(count) % 1000).astype(np.float32)[:, None]
    split = split_vertices(np.zeros(count, np.int32), 1, [values])
    assert len(split.vertices) == 1000
