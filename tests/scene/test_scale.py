"""Large scenes: work that does not grow with the number of elements, memory that stays in bounds.

Counts and bytes, not seconds. 10 million triangles took 1.1 s (unlit) to 5.1 s (flat shaded, every
corner a vertex of its own) on two cores of a cloud machine, and 0.9 to 2.6 GB at the peak.
"""

import cProfile
import pstats
import tracemalloc

import numpy as np
import pytest

from addon.scene.extract import SceneExtractor
from addon.scene.geometry.meshes import read_mesh
from tests import scene_builders as scenes


@pytest.fixture
def bpy(aplanat_bpy, empty_scene):
    return aplanat_bpy


def grid(bpy, count, corners):
    """A wavy grid of count x count quads, or twice as many triangles, with UVs."""
    first = np.arange(count * count, dtype=np.int32)
    first += first // count
    quads = np.stack([first, first + 1, first + count + 2, first + count + 1], axis=1)
    faces = quads if corners == 4 else np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    data = bpy.data.meshes.new("grid")
    data.vertices.add((count + 1) ** 2)
    data.loops.add(faces.size)
    data.polygons.add(len(faces))
    y, x = np.divmod(np.arange((count + 1) ** 2), count + 1)
    places = np.stack([x / count, y / count, np.sin(9 * x / count)], axis=1).astype(np.float32)
    data.attributes["position"].data.foreach_set("vector", places.ravel())
    data.loops.foreach_set("vertex_index", faces.ravel())
    data.polygons.foreach_set("loop_start", np.arange(0, faces.size, corners, dtype=np.int32))
    data.uv_layers.new(name="map").uv.foreach_set("vector", places[faces.ravel(), :2].ravel())
    data.update(calc_edges=True)
    return data


def python_calls(function):
    profile = cProfile.Profile()
    profile.runcall(function)
    return pstats.Stats(profile).total_calls


@pytest.mark.parametrize("corners", [3, 4])
def test_reading_a_mesh_takes_as_many_steps_whatever_its_size(bpy, corners):
    keys = {"normal", "uv:"}
    counts = []
    for size in (4, 64):
        data = grid(bpy, size, corners)
        data.shade_smooth()
        counts.append(python_calls(lambda data=data: read_mesh(data, keys, "grid")))
    assert counts[0] == counts[1]


@pytest.mark.parametrize(
    ("corners", "smooth", "keys", "bytes_a_triangle"),
    [
        (3, True, (), 100),
        (4, True, ("uv:",), 140),
        (4, True, ("normal", "uv:"), 150),
        # 72 bytes of position and normal and 12 of indices remain.
        (3, False, ("normal",), 260),
    ],
)
def test_memory_of_reading_is_a_few_times_the_result(bpy, corners, smooth, keys, bytes_a_triangle):
    # 10 million triangles and their picture must fit into 8 GB, Blender's own copy included.
    data = grid(bpy, 300, corners)
    (data.shade_smooth if smooth else data.shade_flat)()
    tracemalloc.start()
    try:
        reading = read_mesh(data, keys, "grid")
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak / len(reading.snapshot.triangles) < bytes_a_triangle


def test_many_instances_are_one_mesh_one_group_and_few_steps_each(bpy):
    paint = scenes.emission(bpy, "paint", (1, 0, 0))
    rng = np.random.default_rng(1)
    scenes.instancer(bpy, None, paint, rng.uniform(size=(5000, 3)).tolist())
    depsgraph = bpy.context.evaluated_depsgraph_get()
    extractor = SceneExtractor()
    calls = python_calls(lambda: extractor.extract_content(depsgraph))
    content = extractor.extract_content(depsgraph)
    assert len(content.meshes) == len(content.groups) == 1
    assert len(content.instances.world) == 5000
    assert calls / 5000 < 20
    assert python_calls(lambda: extractor.extract_content(depsgraph)) < 10
