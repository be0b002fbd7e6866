"""One number for quality: what it chooses, and which blur it looks at."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.engine.planning.quality import largest_coc
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.content import InstanceGroup, InstanceTable, MeshSnapshot, next_uid
from addon.snapshot.film import Sampling

from .test_plan import snapshot

FOCUS = 4.0


def box_frame(center, half, lens, error=0.01):
    corners = np.array(np.meshgrid((-1, 1), (-1, 1), (-1, 1))).reshape(3, 8).T
    positions = (np.array(center) + np.array(half) * corners).astype(np.float32)
    triangles = np.array([[0, 1, 2], [5, 6, 7], [3, 4, 0]], np.int32)
    mesh = MeshSnapshot(next_uid(), "box", positions, triangles, ((0, 0, 3),))
    frame = snapshot(lens)
    content = replace(
        frame.content,
        meshes={mesh.uid: mesh},
        instances=InstanceTable(np.eye(4, dtype=np.float32)[None], np.zeros(1, np.float32)),
        groups=(InstanceGroup(mesh.uid, (), 0, 1),),
    )
    sampling = Sampling("ADAPTIVE", 1, target_error=error, subsamples=9)
    return replace(frame, content=content, sampling=sampling)


def parallel(near, far):
    projection = np.diag([1.0, 1.0, -2.0 / (far - near), 1.0])
    projection[2, 3] = -(far + near) / (far - near)
    return projection


def coc(depth, plan):
    return abs(plan.coc_scale * (depth - FOCUS) / (depth * FOCUS))


def test_the_largest_blur_is_that_of_the_nearest_visible_part():
    frame = box_frame((0, 0, -1.5), (0.1, 0.1, 0.5), ThinLens(0.1, FOCUS))
    plan = plan_frame(frame)
    assert largest_coc(frame.content, plan) == pytest.approx(coc(1.0, plan), rel=1e-6)


def test_what_is_outside_the_frame_does_not_count():
    # A floor that runs below the camera: its nearest visible part is where the frame ends.
    frame = box_frame((0, -1.0, -0.2), (20.0, 0.001, 4.0), ThinLens(0.1, FOCUS))
    plan = plan_frame(frame)
    edge = plan.projection[1, 1] * 0.999
    assert largest_coc(frame.content, plan) == pytest.approx(coc(edge, plan), rel=0.02)


def test_a_box_behind_the_camera_has_no_blur():
    frame = box_frame((0, 0, 5.0), (0.1, 0.1, 0.5), ThinLens(0.1, FOCUS))
    assert largest_coc(frame.content, plan_frame(frame)) == 0.0


def test_the_plan_begins_with_the_samples_of_the_first_look():
    plans = [
        plan_frame(box_frame((0, 0, -1.5), (0.1, 0.1, 0.5), ThinLens(radius, FOCUS), error))
        for radius, error in ((0.6, 0.01), (0.3, 0.001), (0.3, 0.05))
    ]
    assert [plan.samples for plan in plans] == [16, 16, 16]
    assert [plan.automatic.error for plan in plans] == [0.01, 0.001, 0.05]


def test_less_error_takes_finer_levels():
    biases = [
        plan_frame(box_frame((0, 0, -1.5), (0.1, 0.1, 0.5), ThinLens(0.3, FOCUS), error)).level_bias
        for error in (0.02, 0.01, 0.005)
    ]
    assert biases == pytest.approx([0.0, 1.0, 2.0])


def test_a_pinhole_has_no_subsamples():
    plan = plan_frame(box_frame((0, 0, -1.5), (0.1, 0.1, 0.5), None))
    assert not plan.blurs


def test_what_hardly_blurs_has_no_subsamples():
    # A circle of confusion of half a pixel: within a texel, wherever a sample looks from.
    frame = box_frame((0, 0, -FOCUS), (0.1, 0.1, 0.02), ThinLens(0.1, FOCUS))
    plan = plan_frame(frame)
    assert largest_coc(frame.content, plan) < 1.0
    assert not plan.blurs


def test_the_samples_of_a_plan_are_the_first_of_the_extended_one():
    plan = plan_frame(box_frame((0, 0, -1.5), (0.1, 0.1, 0.5), ThinLens(0.3, FOCUS)))
    assert plan.blurs
    longer = plan.extended()
    assert (longer.first, longer.samples) == (16, 32)
    for name in ("lens_positions", "jitter", "subpixel_weights", "subsample_counts"):
        assert np.array_equal(getattr(longer, name)[:16], getattr(plan, name))
    places = plan.subsample_offsets.shape[1]
    assert np.array_equal(longer.subsample_offsets[:16, :places], plan.subsample_offsets)
    assert not longer.subsample_offsets[:16, places:].any()
    assert np.array_equal(longer.sample_weights(0, 16), plan.sample_weights(0, 16))


def test_a_parallel_camera_sees_no_blur_of_the_world():
    # The world's image shows one point in every pixel, however far the far plane is.
    frame = box_frame((0, 0, -FOCUS), (0.1, 0.1, 0.02), ThinLens(0.1, FOCUS))
    world = replace(frame.content.world, image=1)
    camera = replace(frame.camera, orthographic=True, projection=parallel(0.1, 1000.0))
    frame = replace(frame, camera=camera, content=replace(frame.content, world=world))
    plan = replace(plan_frame(frame), empty_coc=1000.0)
    assert largest_coc(frame.content, plan) < 1.0


def test_the_amount_of_blur_does_not_depend_on_the_error():
    frames = [
        box_frame((0, 0, -1.5), (0.1, 0.1, 0.5), ThinLens(0.1, FOCUS), error)
        for error in (0.05, 0.001)
    ]
    plans = [plan_frame(frame) for frame in frames]
    assert plans[0].coc_scale == plans[1].coc_scale
    assert np.array_equal(plans[0].lens_extent, plans[1].lens_extent)
