"""Chromatic aberration on the device, against the numpy model and against drawing everything."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.sampling.chromatic import ChromaticAberration, Dispersion
from addon.sampling.equalizer import band
from addon.sampling.field_maps import FIELD_PRESETS, FieldMap, field_corner
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.content import ImageSnapshot, World, next_uid
from addon.snapshot.film import Sampling
from benchmarks.reference.chromatic import displaced

from .conftest import LENS, make_renderer, render_snapshot, some_triangles, triangles_snapshot
from .test_reuse import FOCUS, picture, rounded, sheets_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 128, 96
# Stronger than any glass: over 400 nm the focal length changes by 5 %.
STRONG = Dispersion((380.0, 780.0), (0.95, 1.0))
LEVEL = FieldMap("CURVE", curve_f=(0.0, 0.0))


def aberration(mode="SPECTRAL", axial=1.0, lateral=0.2, **others):
    return ChromaticAberration(mode, axial, lateral, STRONG, 0.05, **others)


def with_chromatic(snapshot, chromatic, **others):
    return replace(snapshot, camera=replace(snapshot.camera, chromatic=chromatic), **others)


def black(snapshot):
    return replace(snapshot, content=replace(snapshot.content, world=World()))


def shifted(snapshot, x, y, parallel):
    """Return a snapshot whose optical axis is not in the picture's middle."""
    projection = snapshot.camera.projection.copy()
    projection[:2, 3 if parallel else 2] += (x, y)
    return replace(snapshot, camera=replace(snapshot.camera, projection=projection))


def dot(place, size):
    """Return a triangle round a place, facing the camera."""
    angles = np.pi / 2 + np.arange(3) * 2.0 * np.pi / 3.0
    around = np.stack([np.cos(angles), np.sin(angles), np.zeros(3)], axis=1)
    return np.asarray(place) + size * around


def expected_centroids(snapshot, plan, place):
    """Return where the model puts a point in each channel, in pixels."""
    camera, film = snapshot.camera, snapshot.film
    corner = field_corner(camera.projection, camera.orthographic)
    colors = plan.chromatic
    moved = displaced(
        np.array(place)[None],
        plan.lens_positions,
        colors.wavelengths_nm,
        camera.chromatic,
        plan.focus_distance,
        corner,
        camera.orthographic,
    )
    clip = np.column_stack([moved, np.ones(len(moved))]) @ camera.projection.T
    ndc = clip[:, :2] / clip[:, 3:] + plan.jitter
    pixels = (ndc + 1.0) / 2.0 * (film.width, film.height)
    weights = colors.weights[:, :3]
    return weights.T @ pixels / weights.sum(axis=0)[:, None]


def measured_centroids(picture):
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]] + 0.5
    light = picture[..., :3].reshape(-1, 3)
    places = np.stack([x.ravel(), y.ravel()])
    return (places @ light / light.sum(axis=0)).T


# x and y at a distance of 1 m, where the picture's half width is 0.5.
PLACES = [(0.25, 0.2), (-0.28, 0.1), (0.02, -0.24), (-0.2, -0.2)]


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("shift", [(0.0, 0.0), (-0.15, 0.1)])
@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
@pytest.mark.parametrize(
    "lateral_map",
    [FieldMap(), FieldMap("ONE_MINUS", "RECIPROCAL"), FieldMap("COS_THETA"), FieldMap("T3", "EXP")],
    ids=lambda m: m.text,
)
def test_points_lie_where_the_lateral_model_puts_them(parallel, shift, mode, lateral_map):
    for place in PLACES:
        distance = 3.0
        scale = 4.0 if parallel else distance
        point = np.array([place[0] * scale, place[1] * scale, -distance])
        snapshot = triangles_snapshot(
            [dot(point, 0.03 * scale)], [(1.0, 1.0, 1.0)], WIDTH, HEIGHT, None, 120,
            parallel=parallel,
        )  # fmt: skip
        chromatic = aberration(mode, lateral=0.12, lateral_map=lateral_map)
        snapshot = with_chromatic(shifted(black(snapshot), *shift, parallel), chromatic)
        plan = plan_frame(snapshot)
        found = measured_centroids(render_snapshot(snapshot, plan)["Combined"])
        wanted = expected_centroids(snapshot, plan, point)
        # The displacement itself is several pixels between red and blue.
        assert np.abs(found - wanted).max() <= 0.1


@pytest.mark.parametrize("preset", list(FIELD_PRESETS))
@pytest.mark.parametrize("parallel", [False, True])
def test_each_sample_draws_points_where_the_numpy_model_does(preset, parallel):
    """Axial and lateral together, sample by sample: every wavelength and place on the lens."""
    _, axial_map, lateral_map = FIELD_PRESETS[preset]
    chromatic = aberration(axial=0.5, lateral=0.05, axial_map=axial_map, lateral_map=lateral_map)
    scale = 4.0 if parallel else 2.2
    point = np.array([0.25 * scale, -0.16 * scale, -2.2])
    lens = ThinLens(0.05, 3.0, Iris(5, 0.3, 1.2))
    snapshot = triangles_snapshot(
        [dot(point, 0.04 * scale)], [(1.0, 1.0, 1.0)], WIDTH, HEIGHT, lens, 9, parallel=parallel
    )
    snapshot = with_chromatic(black(snapshot), chromatic)
    plan = plan_frame(snapshot)
    for index in range(plan.samples):
        alone = np.array([index])
        weights = np.ones((1, 4))
        single = replace(
            plan,
            lens_positions=plan.lens_positions[alone],
            jitter=plan.jitter[alone],
            subpixel_weights=plan.subpixel_weights[alone],
            subsample_offsets=plan.subsample_offsets[alone],
            subsample_counts=plan.subsample_counts[alone],
            subsample_places=plan.subsample_places[alone],
            chromatic=replace(
                plan.chromatic,
                wavelengths_nm=plan.chromatic.wavelengths_nm[alone],
                weights=weights,
                focal_errors=plan.chromatic.focal_errors[alone],
                lateral_strengths=plan.chromatic.lateral_strengths[alone],
            ),
        )
        found = measured_centroids(render_snapshot(snapshot, single)["Combined"])
        wanted = expected_centroids(snapshot, single, point)
        # One sample of a dot of 8 pixels, whose edge falls on whole pixels; the samples lie up to
        # 20 pixels apart.
        assert np.abs(found - wanted).max() < 0.5


WALL = [
    [(-40.0, -40.0, -5.0), (40.0, -40.0, -5.0), (-40.0, 40.0, -5.0)],
    [(40.0, -40.0, -5.0), (40.0, 40.0, -5.0), (-40.0, 40.0, -5.0)],
]


@pytest.mark.parametrize("count", [16, 17, 32, 100])
@pytest.mark.parametrize("method, subsamples", [("REFERENCE", 0), ("ADAPTIVE", 0), ("ADAPTIVE", 4)])
@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL", "BAND"])
def test_a_white_wall_stays_white(count, method, subsamples, mode):
    equalizer = {"equalizer": band(600.0, 40.0)} if mode == "BAND" else {}
    chromatic = aberration("RGB" if mode == "RGB" else "SPECTRAL", **equalizer)
    chromatic = replace(
        chromatic,
        axial_map=FieldMap("ONE_MINUS", "RECIPROCAL"),
        lateral_map=FieldMap("ONE_MINUS", "RECIPROCAL"),
    )
    wall = triangles_snapshot(WALL, [(0.8, 0.8, 0.8)] * 2, 64, 48, LENS, count)
    sampling = Sampling(method, count, subsamples=subsamples)
    snapshot = replace(with_chromatic(wall, chromatic), sampling=sampling)
    renderer = make_renderer(snapshot)
    # Also on the way, as a viewport shows it.
    for done in sorted({16, count}):
        renderer.advance(done - renderer.samples_done)
        found = renderer.read_image()
        means = found[..., :3].mean(axis=(0, 1))
        assert np.abs(means / 0.8 - 1.0).max() < 1e-3
        blocks = found[..., :3].reshape(6, 8, 8, 8, 3).mean(axis=(1, 3))
        chroma = np.ptp(blocks, axis=-1) / blocks.mean(axis=-1)
        assert chroma.max() < 5e-3
        # float32 sums of weights that are no powers of two
        assert np.abs(found[..., 3] - 1.0).max() < 1e-5
    renderer.release()


@pytest.mark.parametrize("method", ["REFERENCE", "ADAPTIVE"])
def test_without_strength_it_is_off_to_the_last_bit(method):
    corners, colors = some_triangles()
    passes = ("Combined", "Focus Matte", "CryptoObject00", "Fringe")
    snapshot = triangles_snapshot(corners, colors, lens=LENS, samples=24, passes=passes)
    snapshot = replace(snapshot, sampling=Sampling(method, 24, subsamples=3))
    off = render_snapshot(snapshot)
    weak = render_snapshot(with_chromatic(snapshot, aberration(axial=0.0, lateral=0.0)))
    for name in passes:
        assert off[name].tobytes() == weak[name].tobytes()
    assert not off["Fringe"].any()


def test_off_takes_the_shaders_that_know_no_wavelength(monkeypatch):
    from addon.device import shaders

    corners, colors = some_triangles()
    snapshot = triangles_snapshot(corners, colors, lens=LENS, samples=8)
    snapshot = replace(snapshot, sampling=Sampling("ADAPTIVE", 8, subsamples=3))
    used = []
    compiled = shaders._cache

    class Watched(dict):
        def get(self, info, default=None):
            used.append(info)
            return compiled.get(info, default)

        def __setitem__(self, info, shader):
            compiled[info] = shader

    monkeypatch.setattr(shaders, "_cache", Watched())
    render_snapshot(snapshot)
    assert used
    for info in used:
        assert "CHROMATIC" not in dict(info.defines)
        names = [name for name, *_ in (*info.uniforms, *info.samplers, *info.push_constants)]
        assert "ChromaticParams" not in names and "dispersion" not in names


@pytest.mark.parametrize("passes", [("Combined",), ("Combined", "Focus Matte", "CryptoObject00")])
@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
def test_shared_drawings_are_the_bits_of_samples_at_their_rounded_places(passes, mode):
    snapshot = sheets_snapshot([FOCUS + 0.1], 96, size=0.3, passes=passes)
    chromatic = aberration(mode, axial=0.2, lateral=0.01)
    snapshot = with_chromatic(snapshot, chromatic)
    plan = plan_frame(snapshot)
    shared, counts, found = picture(snapshot, plan)
    assert counts.sprites_drawn < 0.7 * counts.sprites_copied
    assert len({s.parent for each in found.values() for s in each.values()}) > 3
    # Each sample at the place, and with the wavelength, of the drawing that it shares.
    parents = np.arange(plan.samples)
    for sample, sprites in found.items():
        (sprite,) = sprites.values()
        parents[sample] = sprite.parent
    colors = plan.chromatic
    at_parents = replace(
        colors,
        focal_errors=colors.focal_errors[parents],
        lateral_strengths=colors.lateral_strengths[parents],
    )
    drawn, alone, _ = picture(snapshot, replace(rounded(plan, found), chromatic=at_parents))
    assert alone.sprites_drawn == 0
    for name in passes:
        assert shared[name].tobytes() == drawn[name].tobytes(), name


def test_samples_share_drawings_only_where_all_corners_agree():
    snapshot = sheets_snapshot([FOCUS], 96, size=1.2)
    far = with_chromatic(snapshot, aberration(axial=0.0, lateral=0.3))
    _, counts, found = picture(far, plan_frame(far))
    near = with_chromatic(snapshot, aberration(axial=0.0, lateral=1e-4))
    _, counts_near, _ = picture(near, plan_frame(near))
    assert counts.sprites_copied < 0.5 * counts_near.sprites_copied
    # What is shared hardly moves: half a cell of half a pixel, in each corner.
    alone, _, _ = picture(far, replace(plan_frame(far), reuse_grid=0))
    shared, _, _ = picture(far, plan_frame(far))
    difference = np.abs(shared["Combined"] - alone["Combined"])
    assert difference.mean() < 0.01


def errors_of_blur(snapshot, samples, truth_samples):
    """Return the error of the adaptive picture without and with subsamples."""
    truth = render_snapshot(replace(snapshot, sampling=Sampling("REFERENCE", truth_samples)))
    errors = []
    for subsamples in (0, 6):
        sampling = Sampling("ADAPTIVE", samples, subsamples=subsamples)
        found = render_snapshot(replace(snapshot, sampling=sampling))
        difference = found["Combined"] - truth["Combined"]
        errors.append(float(np.sqrt(np.square(difference[..., :3]).mean())))
    return errors


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize(
    "axial, lateral, axial_map", [(0.4, 0.0, LEVEL), (0.2, 0.0, FieldMap()), (0.0, 0.05, LEVEL)]
)
def test_subsample_blur_works_as_well_as_without_aberration(parallel, axial, lateral, axial_map):
    corners, colors = some_triangles(5, 9)
    base = triangles_snapshot(corners, colors, 96, 64, LENS, 24, parallel=parallel)
    chromatic = aberration(axial=axial, lateral=lateral, axial_map=axial_map)
    errors = errors_of_blur(with_chromatic(base, chromatic), 24, 1536)
    # As many places on the lens: groups of three samples share one.
    alone = errors_of_blur(base, 8, 512)
    # What a sample does not see behind an edge is guessed; wavelengths that are far out of focus
    # need more of that: measured 1.41 where they are farthest, 1.0 to 1.21 elsewhere.
    assert errors[1] / errors[0] < 1.45 * alone[1] / alone[0]
    # Measured 0.69 to 0.89.
    assert errors[1] < 0.93 * errors[0]
    assert alone[1] < 0.85 * alone[0]


def test_wavelengths_that_hardly_differ_make_the_picture_of_a_third_of_the_samples():
    corners, colors = some_triangles(5, 9)
    base = triangles_snapshot(corners, colors, 96, 64, LENS, 24)
    base = replace(base, sampling=Sampling("ADAPTIVE", 24, subsamples=6))
    weak = render_snapshot(with_chromatic(base, aberration("RGB", axial=1e-9, lateral=1e-9)))
    off = render_snapshot(replace(base, sampling=replace(base.sampling, lens_samples=8)))
    difference = np.abs(weak["Combined"] - off["Combined"])
    # A decision of the blur that hangs on rounding may turn out otherwise here and there.
    assert (difference > 1e-4).mean() < 1e-3


def test_fringe_is_the_difference_to_the_picture_without_it():
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(
        corners, colors, lens=LENS, samples=30, passes=("Combined", "Fringe")
    )
    snapshot = with_chromatic(snapshot, aberration())
    found = render_snapshot(snapshot)
    plain = render_snapshot(with_chromatic(snapshot, None, passes=("Combined",)))["Combined"]
    wanted = found["Combined"][..., :3] - plain[..., :3]
    assert np.array_equal(found["Fringe"], wanted)
    assert np.abs(wanted).max() > 0.05


def test_the_world_behind_is_seen_as_a_point_at_infinity_is():
    """A bright spot of the world's image lies where the model puts a far point."""
    size = (512, 1024)
    pixels = np.zeros((*size, 4), np.float32)
    direction = np.array([0.28, 0.18, -1.0])
    direction /= np.linalg.norm(direction)
    y, x = np.mgrid[: size[0], : size[1]] + 0.5
    longitude = (x / size[1] - 0.5) * -2.0 * np.pi
    latitude = (y / size[0] - 0.5) * np.pi
    flat = np.cos(latitude)
    rays = [flat * np.cos(longitude), flat * np.sin(longitude), np.sin(latitude)]
    rays = np.stack(rays, axis=-1)
    pixels[rays @ direction > np.cos(0.02), :3] = 1.0
    pixels[..., 3] = 1.0
    image = ImageSnapshot(next_uid(), "world", pixels)
    snapshot = triangles_snapshot(
        [dot((0.0, 0.0, 50.0), 0.1)], [(0.0, 0.0, 0.0)], WIDTH, HEIGHT, ThinLens(0.01, 3.0), 90
    )
    world = World((1.0, 1.0, 1.0), image.uid)
    content = replace(snapshot.content, images={image.uid: image}, world=world)
    snapshot = replace(snapshot, content=content)
    for mode in ("RGB", "SPECTRAL"):
        here = with_chromatic(snapshot, aberration(mode, axial=0.3, lateral=0.1))
        plan = plan_frame(here)
        found = measured_centroids(render_snapshot(here, plan)["Combined"])
        wanted = expected_centroids(here, plan, direction * 1e5)
        # Between channels; the spot's own place depends on how the image is sampled.
        assert np.abs((found - found[0]) - (wanted - wanted[0])).max() < 0.1
        assert np.abs(found - wanted).max() < 0.6


def test_mattes_cover_the_same_with_and_without():
    # In front of a lens that only parts colours slightly, coverage hardly changes.
    corners, colors = some_triangles()
    passes = ("Combined", "Focus Matte", "CryptoObject00")
    snapshot = triangles_snapshot(corners, colors, lens=LENS, samples=60, passes=passes)
    off = render_snapshot(snapshot)
    on = render_snapshot(with_chromatic(snapshot, aberration(axial=0.02, lateral=0.001)))
    assert np.abs(on["Focus Matte"] - off["Focus Matte"]).mean() < 0.02
    whole = [p["CryptoObject00"][..., 1::2].sum() for p in (on, off)]
    assert whole[0] == pytest.approx(whole[1], rel=0.02)
    assert on["CryptoObject00"][..., 1::2].sum(axis=-1).max() <= 1.0 + 1e-5
