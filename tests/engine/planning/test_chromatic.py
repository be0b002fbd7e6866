"""The chromatic plan: the model over the field, and how far its wavelengths reach."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.drawing import culling
from addon.engine.layered.layer_raster import plan_reach
from addon.engine.planning.field_table import diamond_angles, diamond_turn, field_of_raster
from addon.engine.planning.plan import plan_frame
from addon.engine.sharing.raster_boxes import raster_rectangles
from addon.levels.choosing import choose_levels, coc_ends, extents
from addon.sampling.chromatic import ChromaticAberration, Dispersion
from addon.sampling.field_maps import FIELD_PRESETS, FieldMap, field_corner
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.boxes import InstanceBoxes
from addon.snapshot.film import Sampling
from benchmarks.reference.chromatic import displaced

from .test_plan import HEIGHT, WIDTH, snapshot

LENS = ThinLens(0.1, 4.0)
STRONG = Dispersion((380.0, 780.0), (0.95, 1.0))


def chromatic_snapshot(parallel=False, region=(0, 0, WIDTH, HEIGHT), samples=48, **aberration):
    found = snapshot(LENS, region, parallel)
    chromatic = ChromaticAberration("SPECTRAL", 0.5, 0.1, STRONG, 0.05)
    camera = replace(found.camera, chromatic=replace(chromatic, **aberration))
    return replace(found, camera=camera, sampling=Sampling("REFERENCE", samples, 0))


def presets():
    return [
        pytest.param({"axial_map": axial, "lateral_map": lateral}, id=name)
        for name, (_, axial, lateral) in FIELD_PRESETS.items()
    ]


def random_points(count=400, seed=2, parallel=False):
    rng = np.random.default_rng(seed)
    depth = rng.uniform(0.5, 30.0, count)
    away = rng.uniform(-1.0, 1.0, (count, 2)) * (0.5, 0.28)
    scale = 1.0 if parallel else depth[:, None]
    return np.column_stack([away * scale, -depth])


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("maps", presets())
def test_the_plan_moves_points_as_the_model_does(maps, parallel):
    found = chromatic_snapshot(parallel, **maps)
    plan = plan_frame(found)
    points = random_points(parallel=parallel)
    moved = plan.chromatic.displaced(points, plan.lens_positions)
    corner = field_corner(found.camera.projection, parallel)
    for i in range(0, plan.samples, 7):
        wanted = displaced(
            points,
            plan.lens_positions[i],
            plan.chromatic.wavelengths_nm[i],
            found.camera.chromatic,
            LENS.focus_distance,
            corner,
            parallel,
        )
        # Straight lines between the places of the field table, and its 32 bit floats; where 1/t
        # bends into its limit, a hundredth.
        scale = np.abs(wanted - points).max(axis=1) + np.abs(points).max(axis=1)
        error = np.abs(moved[i] - wanted).max(axis=1) / scale
        assert np.quantile(error, 0.98) < 2e-4
        assert error.max() < 2e-2


@pytest.mark.parametrize("maps", presets())
def test_no_point_of_a_box_leaves_its_ranges(maps):
    plan = plan_frame(chromatic_snapshot(**maps))
    rng = np.random.default_rng(5)
    centers = random_points(60)
    centers[:10, 2] *= -0.05
    halves = rng.uniform(0.01, 1.5, (60, 3))
    signs = np.stack(np.meshgrid(*[(-1, 1)] * 3, indexing="ij"), axis=-1).reshape(8, 3)
    ranges = plan.chromatic.ranges(centers[:, None] + signs * halves[:, None])
    inside = centers[:, None] + rng.uniform(-1.0, 1.0, (60, 300, 3)) * halves[:, None]
    axial, lateral = np.moveaxis(plan.chromatic.strengths(inside), -1, 0)
    for i in range(plan.samples):
        focus = plan.chromatic.inverse_focus_at(plan.chromatic.focal_errors[i], axial)
        assert (focus >= ranges.inverse_focus[0][:, None] - 1e-9).all()
        assert (focus <= ranges.inverse_focus[1][:, None] + 1e-9).all()
        scale = np.maximum(1.0 + plan.chromatic.lateral_strengths[i] * lateral, 0.05)
        assert (scale >= ranges.scale[0][:, None] - 1e-9).all()
        assert (scale <= ranges.scale[1][:, None] + 1e-9).all()
    overall = plan.chromatic.overall()
    assert overall.inverse_focus[0] <= ranges.inverse_focus[0].min()
    assert overall.scale[1] >= ranges.scale[1].max()


def raster(points, plan):
    clip = np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1) @ plan.projection.T
    size = np.array([plan.width, plan.height])
    return (clip[..., :2] / clip[..., 3:] + plan.jitter[:, None] + 1.0) / 2.0 * size


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("maps", presets())
def test_what_samples_see_is_within_the_reach_of_layers(maps, parallel):
    # The layered method draws the frame from the lens' middle, with its reach around it.
    found = chromatic_snapshot(parallel, lateral=0.5, **maps)
    # A small opening, so that lateral color and no parallax decides.
    camera = replace(found.camera, lens=ThinLens(0.002, 4.0))
    plan = plan_frame(replace(found, camera=camera))
    points = random_points(3000, 4, parallel) * (1.5, 1.5, 1.0)
    reach = plan_reach(plan, 0.5, 30.0)
    seen = raster(plan.chromatic.displaced(points, plan.lens_positions), plan)
    size = np.array([plan.width, plan.height])
    inside = ((seen >= 0.0) & (seen <= size)).all(axis=-1).any(axis=0)
    at = raster(points[None], plan)[0][inside]
    assert 100 < np.count_nonzero(inside) < len(points)
    # A pixel: raster() has the samples' jitter, up to half a pixel each way.
    assert (at >= -reach - 1.0).all() and (at <= size + reach + 1.0).all()


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("maps", presets())
def test_no_sample_draws_a_box_outside_its_rectangle(maps, parallel):
    plan = plan_frame(chromatic_snapshot(parallel, **maps))
    signs = np.stack(np.meshgrid(*[(-1, 1)] * 3, indexing="ij"), axis=-1).reshape(8, 3)
    for center in random_points(40, 8, parallel):
        corners = center + 0.1 * signs
        (rectangle,), _ = raster_rectangles(corners[None], plan)
        places = raster(plan.chromatic.displaced(corners, plan.lens_positions), plan)
        inside = (places > 0.0) & (places < (plan.width, plan.height))
        places = places[inside.all(axis=-1)]
        if len(places):
            x, y, width, height = rectangle
            assert (places >= (x, y)).all() and (places <= (x + width, y + height)).all()


@pytest.mark.parametrize("maps", presets())
def test_nothing_that_a_sample_sees_is_culled(maps):
    plan = plan_frame(chromatic_snapshot(**maps))
    rng = np.random.default_rng(9)
    centers = random_points(500, 10) * (2.5, 2.5, 1.0)
    spheres = culling.BoundingSpheres.__new__(culling.BoundingSpheres)
    spheres.centers, spheres.radii = centers, rng.uniform(0.0, 0.2, 500)
    visible = culling.seen(spheres, plan)
    places = raster(plan.chromatic.displaced(centers, plan.lens_positions), plan)
    shown = ((places > 0.0) & (places < (plan.width, plan.height))).all(axis=-1).any(axis=0)
    assert shown.sum() > 50
    assert not (shown & ~visible).any()
    if maps["axial_map"] == FieldMap():
        assert (~visible).sum() > 50


def box(depth, half=0.1):
    return InstanceBoxes(np.array([[0.0, 0.0, -depth]]), half * np.eye(3)[:, None])


def test_an_object_that_any_wavelength_has_in_focus_keeps_its_full_detail():
    still = FieldMap("CURVE", curve_f=(0.0, 0.0))
    found = chromatic_snapshot(axial_map=still, lateral=0.0)
    sharp = plan_frame(found)
    chromatic = found.camera.chromatic
    drawn = sharp.chromatic.wavelengths_nm
    ends = np.array([drawn.min(), drawn.max()])
    blue, red = chromatic.focus_distances(LENS.focus_distance, ends)
    plain = plan_frame(replace(found, camera=replace(found.camera, chromatic=None)))
    triangles = np.array([200000.0])
    for depth, is_sharp in ((red, True), (blue, True), (blue / 3.0, False)):
        seen = extents(box(depth), sharp.view, sharp.chromatic)
        level = choose_levels(seen, triangles, sharp)
        assert (level[0] == 0.0) == is_sharp
    # Without chromatic aberration the object at blue's distance is blurred.
    seen = extents(box(blue), plain.view)
    assert choose_levels(seen, triangles, plain)[0] > 0.0


@pytest.mark.parametrize("parallel", [False, True])
def test_circles_of_confusion_lie_between_those_of_the_extreme_wavelengths(parallel):
    plan = plan_frame(chromatic_snapshot(parallel))
    boxes = box(7.0, 0.3)
    corners = boxes.corners()[0]
    seen = extents(boxes, plan.view, plan.chromatic)
    low, high = coc_ends(seen.nearest, seen.farthest, plan, seen.inverse_focus)
    for i in range(plan.samples):
        axial = plan.chromatic.strengths(corners)[:, 0]
        focus = plan.chromatic.inverse_focus_at(plan.chromatic.focal_errors[i], axial)
        depth = -corners[:, 2]
        radius = plan.coc_scale * (depth * focus - 1.0)
        radius = radius if parallel else radius / depth
        assert (radius >= low - 1e-6).all() and (radius <= high + 1e-6).all()


def test_the_field_is_that_of_the_whole_picture_in_any_region():
    whole = plan_frame(chromatic_snapshot())
    part = plan_frame(chromatic_snapshot(region=(40, 10, 30, 20)))
    assert part.chromatic.radius == whole.chromatic.radius
    pixel = np.array([5.5, 7.5])
    a = pixel * part.chromatic.raster[:2] + part.chromatic.raster[2:]
    b = (pixel + (40, 10)) * whole.chromatic.raster[:2] + whole.chromatic.raster[2:]
    assert np.allclose(a, b)


def test_pixels_find_their_place_in_the_field_whatever_the_shift():
    found = snapshot()
    matrix = found.camera.projection.copy()
    matrix[0, 2], matrix[1, 2] = 0.3, -0.4
    raster_of = field_of_raster(matrix, found.film)
    point = np.array([0.13, -0.08, -1.0, 1.0])
    clip = matrix @ point
    pixel = (clip[:2] / clip[3] + 1.0) / 2.0 * (WIDTH, HEIGHT)
    assert np.allclose(pixel * raster_of[:2] + raster_of[2:], point[:2])


def test_rows_of_the_field_table_go_round_the_axis():
    angles = diamond_angles(64)
    places = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    assert np.allclose(diamond_turn(places) * 16.0, np.arange(64))


def test_a_sweep_in_two_parts_is_the_sweep():
    for parallel in (False, True):
        plan = plan_frame(snapshot(LENS, parallel=parallel))
        base, gain = plan.sweep_parts
        assert np.allclose(base + gain / plan.focus_distance, plan.sweep)


def test_colour_weights_of_a_frame_sum_to_its_samples():
    for mode in ("RGB", "SPECTRAL"):
        for samples in (1, 16, 17, 100):
            plan = plan_frame(chromatic_snapshot(samples=samples, mode=mode))
            assert np.allclose(plan.weight(samples), samples)
            assert len(np.unique(plan.lens_positions, axis=0)) == -(-samples // 3)


def test_a_pinhole_has_no_axial_aberration():
    found = chromatic_snapshot(lateral=0.0)
    pinhole = replace(found, camera=replace(found.camera, lens=None))
    assert plan_frame(pinhole).chromatic is None
    assert plan_frame(found).chromatic is not None


def test_fringe_plans_the_same_frame_without_aberration():
    found = replace(chromatic_snapshot(), passes=("Combined", "Fringe"))
    plan = plan_frame(found)
    assert plan.plain.chromatic is None
    assert plan.plain.samples == plan.samples
    assert plan_frame(chromatic_snapshot()).plain is None
