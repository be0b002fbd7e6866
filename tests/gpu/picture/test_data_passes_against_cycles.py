"""Depth, Normal, Position and Vector mean in Aplanat what they mean in Cycles.

Cycles takes its one sample of the pixel near the middle, and a rasteriser moves vertices to a grid
of 1/256 pixel: beside an edge the two may see different things. Pixels whose neighbourhood shows
two objects are left out; inside, the tolerances are that grid's.
"""

import numpy as np
import pytest

from tests.pass_pictures import (
    away_from_edges,
    build_scene,
    render_passes_aplanat,
    render_passes_cycles,
    use_passes,
)

# The scene is a few metres large and a pixel covers up to 0.06 m: 1/256 of that.
GRID = 2.5e-4

TOLERANCE = {
    "Depth": GRID,
    "Position": GRID,
    # The share of the grid in the angle between neighbouring vertices of the bulging ball.
    "Normal": 0.01,
    # In pixels.
    "Vector": 1.0 / 256.0,
}


def _move(thing, scene):
    for frame, offset in ((1, (0.0, 0.0)), (2, (0.1, 0.05)), (3, (0.3, 0.03))):
        x, y, z = thing.location
        thing.location = (x + offset[0], y, z + offset[1])
        thing.keyframe_insert("location", frame=frame)
        thing.location = (x, y, z)
    scene.frame_set(2)


def _deform(thing, scene):
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="Bulge")
    for point in key.data:
        point.co = point.co * (1.0 + point.co.z)
    for frame, value in ((1, 0.0), (2, 0.3), (3, 0.8)):
        key.value = value
        key.keyframe_insert("value", frame=frame)


@pytest.fixture(params=["perspective", "orthographic"])
def passes_of_both(request, empty_scene):
    scene = empty_scene
    things = build_scene(scene)
    _deform(things["Ball"], scene)
    _move(things["Cube"], scene)
    _move(things["Camera"], scene)
    camera = things["Camera"].data
    camera.dof.use_dof = False
    if request.param == "orthographic":
        camera.type = "ORTHO"
        camera.ortho_scale = 4.5
    layer = scene.view_layers[0]
    use_passes(layer, "z", "normal", "position", "vector", "cryptomatte_object")
    cycles, _ = render_passes_cycles(scene, 1)
    aplanat, _ = render_passes_aplanat(scene, 1)
    return cycles, aplanat


def test_data_passes_equal_cycles(passes_of_both):
    cycles, aplanat = passes_of_both
    objects = cycles["ViewLayer.CryptoObject00"][..., 0]
    inside = away_from_edges(objects)
    assert inside.mean() > 0.7
    # Edges inside the cube: both sides belong to one object.
    normals = cycles["ViewLayer.Normal"]
    folds = np.abs(normals - np.roll(normals, 1, (0, 1))).max(axis=-1) > 0.4
    inside &= ~(folds | np.roll(folds, -1, (0, 1)))
    for name, tolerance in TOLERANCE.items():
        difference = np.abs(cycles[f"ViewLayer.{name}"] - aplanat[f"ViewLayer.{name}"])
        assert difference[inside].max() < tolerance, name


def test_movement_is_seen_in_the_vector_pass(passes_of_both):
    cycles, aplanat = passes_of_both
    largest = np.abs(aplanat["ViewLayer.Vector"]).max()
    assert largest > 2.0
    assert largest == pytest.approx(np.abs(cycles["ViewLayer.Vector"]).max(), rel=0.01)


def test_nothing_is_at_the_conventional_values(passes_of_both):
    cycles, aplanat = passes_of_both
    empty = (cycles["ViewLayer.CryptoObject00"][..., 0] == 0.0) & (
        cycles["ViewLayer.Depth"][..., 0] == 1e10
    )
    empty &= away_from_edges(empty)
    assert empty.any()
    assert (aplanat["ViewLayer.Depth"][empty] == np.float32(1e10)).all()
    for name in ("Normal", "Position", "Vector"):
        assert (aplanat[f"ViewLayer.{name}"][empty] == 0.0).all()
