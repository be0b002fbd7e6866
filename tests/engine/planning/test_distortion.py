"""The raster without distortion that a distorted picture is made of."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.engine.planning.distortion import plan_distortion
from addon.engine.planning.plan import plan_frame, region_projection
from addon.optics.distortion import is_invertible, undistorted
from tests.gpu.conftest import some_triangles, triangles_snapshot

WIDTH, HEIGHT = 120, 80
ONE = st.floats(-0.5, 0.25).filter(lambda k: abs(k) > 1e-6)
# As the curves of real lenses: higher terms that are smaller.
SEVERAL = st.tuples(
    st.floats(-0.2, 0.1), st.floats(-0.05, 0.05), st.floats(-0.02, 0.02), st.floats(-0.01, 0.01)
).filter(lambda terms: abs(terms[0]) > 1e-6 and is_invertible(terms, 1.0))
COEFFICIENTS = st.one_of(ONE, SEVERAL)


def snapshot_of(k, region=None, parallel=False, shift=(0.0, 0.0)):
    snapshot = triangles_snapshot(
        *some_triangles(), WIDTH, HEIGHT, region=region, parallel=parallel
    )
    projection = snapshot.camera.projection.copy()
    projection[:2, 3 if parallel else 2] += shift
    camera = replace(
        snapshot.camera, projection=projection, distortion=k if isinstance(k, tuple) else (k,)
    )
    return replace(snapshot, camera=camera)


def test_without_distortion_the_plan_draws_the_picture_itself():
    snapshot = snapshot_of(0.0)
    assert plan_distortion(snapshot) == (None, snapshot)
    plan = plan_frame(snapshot)
    assert plan.distortion is None and plan.size == (plan.width, plan.height) == (WIDTH, HEIGHT)


@given(COEFFICIENTS, st.booleans())
def test_pixels_come_from_where_the_model_says(k, parallel):
    distortion, drawn = plan_distortion(snapshot_of(k, parallel=parallel))
    places = np.random.default_rng(1).uniform(0.0, (WIDTH, HEIGHT), (50, 2))
    middle, corner = 0.5 * np.array([WIDTH, HEIGHT]), 0.5 * np.hypot(WIDTH, HEIGHT)
    wanted = undistorted((places - middle) / corner, k if isinstance(k, tuple) else (k,)) * corner
    # Both cameras put a point of their axis where the axis meets the picture.
    size = np.array([drawn.film.width, drawn.film.height])
    matrix = drawn.camera.projection
    axis = (matrix[:2, 3] if parallel else -matrix[:2, 2]) * 0.5 * size + 0.5 * size
    found = (distortion.sources(places) - axis) / distortion.fineness
    assert np.allclose(found, wanted, rtol=0, atol=1e-9)


@given(COEFFICIENTS, st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)))
def test_the_raster_covers_the_picture_and_the_way_back_is_the_inverse(k, shift):
    snapshot = snapshot_of(k, region=(10, 20, 70, 50), shift=shift)
    distortion, drawn = plan_distortion(snapshot)
    assert (distortion.width, distortion.height) == (70, 50)
    places = distortion.centres()
    sources = distortion.sources(places)
    assert (sources > 2.0).all()
    assert (sources < np.array([drawn.film.width, drawn.film.height]) - 2.0).all()
    assert np.allclose(distortion.pictured(sources), places, rtol=0, atol=1e-6)


@given(COEFFICIENTS)
def test_growth_is_that_of_the_map(k):
    distortion, _ = plan_distortion(snapshot_of(k))
    places = distortion.centres()[::7, ::7]
    away = places - 0.5 * np.array([WIDTH, HEIGHT])
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    step = 1e-4
    for axis, direction in enumerate((away, np.stack([-away[..., 1], away[..., 0]], axis=-1))):
        ahead, behind = (distortion.sources(places + s * step * direction) for s in (1, -1))
        found = np.linalg.norm(ahead - behind, axis=-1) / (2.0 * step)
        assert np.allclose(found, distortion.growth(places)[..., axis], rtol=1e-5, atol=0)


@pytest.mark.parametrize("k", [0.05, 0.1, 0.25])
def test_a_pincushion_is_as_fine_as_its_corners_need_within_a_limit(k):
    distortion, _ = plan_distortion(snapshot_of(k))
    finest = distortion.growth(np.zeros((1, 2)))
    assert finest.min() == pytest.approx(1.0, abs=0.05) or distortion.fineness == 2.0


def test_all_parts_of_a_frame_have_the_same_pixels():
    whole, drawn = plan_distortion(snapshot_of(0.1))
    part, drawn_part = plan_distortion(snapshot_of(0.1, region=(30, 20, 40, 40)))
    moved = part.from_field - whole.from_field
    assert np.allclose(moved, np.rint(moved), rtol=0, atol=1e-9)
    film = replace(
        drawn.film, region=(*(-np.rint(moved[2:])).astype(int), *drawn_part.film.region[2:])
    )
    projection = region_projection(drawn.camera.projection, film)
    assert np.allclose(projection, drawn_part.camera.projection, rtol=0, atol=1e-9)


def test_beyond_the_corner_of_a_viewports_camera_the_scale_stays():
    snapshot = snapshot_of(-0.5)
    camera = replace(snapshot.camera, field_radius=0.2)
    distortion, _ = plan_distortion(replace(snapshot, camera=camera))
    middle = 0.5 * np.array([WIDTH, HEIGHT])
    far = middle + (55.0, 0.0)
    centre = distortion.sources(middle)
    assert np.allclose(distortion.sources(far) - centre, 2.0 * (far - middle))
    assert np.allclose(distortion.pictured(distortion.sources(far)), far)
