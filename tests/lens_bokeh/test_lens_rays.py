"""Lens samples of a real lens against traced rays: where points land, and with how much light."""

import numpy as np
import pytest

from addon.errors import FocusError, PrescriptionError
from addon.lens_bokeh.samples.field_grid import field_grid
from addon.lens_bokeh.samples.landing import spread_places
from addon.lens_bokeh.samples.lens_rays import lens_rays
from addon.lens_bokeh.samples.sample_tables import sample_tables
from addon.lens_bokeh.samples.stop_rays import StopAim
from addon.lens_bokeh.samples.stop_shapes import paraxial_pupil, stop_shapes
from addon.lens_bokeh.tables.undistorted import undistorted
from addon.lens_io.lens_shelf import LensShelf
from addon.optics.lens_facts import squeeze
from addon.optics.rays.aiming import aim
from addon.optics.rays.beam import Beam
from addon.optics.rays.trace import Rays, trace
from benchmarks.referees.osl_lens import osl_lens, rays_from_sensor

LINE = 587.5618
FOCUS = 2.0
# Of the picture, px, and its corner, mm from the axis.
WIDTH, CORNER = 1920, 21.6


def _prescription(name):
    return LensShelf([]).find(name).lens.prescription


def _tables(name, f_number, flat=True, focus=FOCUS):
    prescription = _prescription(name)
    lens = osl_lens(prescription, None, focus, f_number)
    # Lenses of a smaller picture have their own corner.
    covered = np.tan(np.radians(lens.configuration.half_field_deg))
    tangent = min(CORNER / abs(lens.scale), covered)
    half = tangent * np.array([3.0, 2.0]) / np.sqrt(13.0)
    rays = lens_rays(prescription, None, focus, f_number, 1.2 * tangent, flat)
    wide = lens.configuration.f_number
    radius = lens.pupil_radius * min(1.0, wide / f_number) / 1000.0
    tables = sample_tables(rays, field_grid(-half, half), field_grid(-half, half, 0.1), radius)
    return lens, rays, tables, half


@pytest.mark.parametrize(
    ("name", "f_number", "flat"),
    [
        ("double-gauss-50mm-f2", 2.0, True),
        ("petzval-51mm-f1.4", 1.4, False),
        ("retrofocus-35mm-f2.5", 4.0, True),
    ],
)
def test_points_land_where_traced_rays_do(name, f_number, flat):
    lens, rays, tables, half = _tables(name, f_number, flat)
    rng = np.random.default_rng(1)
    configuration = lens.configuration
    stop = configuration.stop - 1
    radius = configuration.surfaces[stop].semi_diameter
    compared = 0
    for _ in range(16):
        seen = rng.uniform(-1.0, 1.0, 2) * half
        vergence = rng.uniform(0.02, rays.largest_vergence)
        q = rng.uniform(-0.7, 0.7, 2)
        point = np.array([*(seen / vergence), -1.0 / vergence])
        beam = Beam.from_point((*point[:2] * 1000.0, lens.pupil + point[2] * 1000.0))
        aimed = aim(configuration, beam, q[None] * radius, LINE)
        if not aimed.found[0]:
            continue
        traced = trace(configuration, beam.rays(aimed.coordinates), LINE)
        if not traced.passed[0]:
            continue
        place = traced.at_plane(configuration.sensor)[0] / lens.scale
        if flat:
            away = np.hypot(*place)
            place *= undistorted(rays.distorted, np.array([away]))[0] / away
        position = q * tables.aperture_radius
        moved = tables.displaced(point[None], tables.moves(position[None])[0], position)[0]
        error = np.linalg.norm(moved[:2] * vergence - place) * WIDTH / (2.0 * half[0])
        assert error < 0.1, (seen, vergence, q)
        compared += 1
    assert compared > 6


@pytest.mark.parametrize(("f_number", "near"), [(1.5, 1.0), (2.4, 0.2)])
def test_a_stop_that_turns_rays_back_has_its_places_on_a_face_as_hollow(f_number, near):
    lens, rays, tables, half = _tables("sonnar-50mm-f1.5", f_number)
    plain, pupil, focus = lens.configuration, lens.pupil, 1e-3 / FOCUS
    _, radius = paraxial_pupil(plain, pupil, focus, LINE)
    (_, flat), (hollow, _), *_ = stop_shapes(plain, pupil, radius, focus, LINE)
    assert flat == 1.0
    face = hollow.surfaces[hollow.stop - 1]
    rng = np.random.default_rng(2)
    errors = []
    for _ in range(60):
        seen = rng.uniform(-1.0, 1.0, 2) * half
        vergence = rng.uniform(0.02, rays.largest_vergence)
        point = np.array([*(seen / vergence), -1.0 / vergence])
        within = rng.uniform(-0.75, 0.75, 2) * radius
        start = np.array([*within, pupil])
        towards = start - [*point[:2] * 1000.0, pupil + point[2] * 1000.0]
        bundle = Rays(start[None], (towards / np.linalg.norm(towards))[None])
        traced = trace(hollow, bundle, LINE, record=True)
        if not traced.passed[0]:
            continue
        # Lens positions are as the picture has them, the lens' x and y turned round.
        q = traced.hits[hollow.stop - 1, 0, :2] / face.semi_diameter
        place = traced.at_plane(plain.sensor)[0] / lens.scale
        away = np.hypot(*place)
        place *= undistorted(rays.distorted, np.array([away]))[0] / away
        position = q * tables.aperture_radius
        moved = tables.displaced(point[None], tables.moves(position[None])[0], position)[0]
        errors.append(np.linalg.norm(moved[:2] * vergence - place) * WIDTH / (2.0 * half[0]))
    assert len(errors) > 30
    # Wide open its blur is steep where rays are about to be reflected totally.
    assert np.median(errors) < near and max(errors) < 10.0 * near


def test_straight_lines_in_focus_stay_straight_without_distortion():
    _, rays, tables, half = _tables("petzval-100mm-f2.2", 22.0)
    points = np.linspace(-1.0, 1.0, 9)[:, None] * [half[0], 0.0] + [0.0, 0.9 * half[1]]
    eye = np.column_stack([points * FOCUS, np.full(9, -FOCUS)])
    centre = np.zeros(2)
    moved = tables.displaced(eye, tables.moves(centre[None])[0], centre)
    assert np.abs(moved - eye).max() / FOCUS * WIDTH / (2.0 * half[0]) < 0.02


@pytest.mark.parametrize(
    ("name", "f_number"),
    [
        ("double-gauss-50mm-f2", 2.0),
        ("petzval-100mm-f2.2", 2.2),
        ("retrofocus-35mm-f2.5", 2.5),
        ("sonnar-50mm-f1.5", 1.5),
    ],
)
def test_an_even_world_is_as_bright_as_traced_from_the_sensor(name, f_number):
    lens, rays, tables, half = _tables(name, f_number)
    count = 1000
    turn = 2.399963 * np.arange(count)
    places = np.sqrt((np.arange(count) + 0.5) / count)[:, None] * np.stack(
        [np.cos(turn), np.sin(turn)], axis=-1
    )
    positions, spacing = places * tables.aperture_radius, np.sqrt(np.pi / count)
    light = tables.light(positions, spacing).mean(axis=0).ravel()
    assert tables.axial_light(positions, spacing).mean() == pytest.approx(light.max(), rel=0.01)
    shares = np.array([0.0, 0.3, 0.6, 0.9])
    seen = shares[:, None] * half
    index, weights = tables.light_grid.taps(seen)
    ours = (light[index] * weights).sum(axis=1)
    # What falls on the sensor: cos^4 over the places of the last surface that light comes through.
    axis = (np.arange(160) + 0.5) / 80.0 - 1.0
    aimed = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2) * lens.aim_radius
    theirs = []
    fields, landing = rays.distorted.T
    for place in seen:
        away = np.hypot(*place)
        sensor = place * (np.interp(away, fields, landing) / max(away, 1e-9)) * lens.scale
        start = np.broadcast_to(sensor, aimed.shape)
        bundle = rays_from_sensor(start, aimed, lens.configuration.sensor, lens.aim)
        passed = trace(lens.configuration, bundle, LINE, backwards=True).passed
        theirs.append((bundle.directions[:, 2] ** 4)[passed].sum())
    # The outermost rays of the Sonnar are about to be reflected totally, and land far away.
    near = 0.02 if "sonnar" in name else 0.006
    assert ours / ours[0] == pytest.approx(np.array(theirs) / theirs[0], abs=near)


@pytest.mark.parametrize("name", ["petzval-51mm-f1.4", "petzval-100mm-f2.2"])
def test_a_wall_in_focus_is_blurred_over_the_field_as_by_traced_rays(name):
    f_number = _prescription(name).f_number
    lens, rays, tables, half = _tables(name, f_number)
    positions = spread_places(1000) * tables.aperture_radius
    moves = tables.moves(positions)
    light = tables.light(positions, np.sqrt(np.pi / 1000)).reshape(1000, -1)
    axis = (np.arange(60) + 0.5) / 30.0 - 1.0
    places = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2) * 1.3 * lens.pupil_radius
    start = np.column_stack([places, np.full(len(places), lens.pupil)])
    radii = []
    for share in (0.0, 0.3, 0.6, 0.9):
        eye = np.array([[*(share * half * FOCUS), -FOCUS]])
        seen = np.array(
            [
                tables.displaced(eye, table, position)[0, :2] / FOCUS
                for table, position in zip(moves, positions, strict=True)
            ]
        )
        index, weights = tables.light_grid.taps(seen)
        weight = (np.take_along_axis(light, index, axis=1) * weights).sum(axis=1)
        towards = start - [*(eye[0, :2] * 1000.0), lens.pupil - FOCUS * 1000.0]
        bundle = Rays(start, towards / np.linalg.norm(towards, axis=1)[:, None])
        traced = trace(lens.configuration, bundle, LINE)
        landing = traced.at_plane(lens.configuration.sensor)[traced.passed] / lens.scale
        away = np.hypot(*landing.T)
        landing *= (undistorted(rays.distorted, away) / np.maximum(away, 1e-12))[:, None]
        flux = bundle.directions[traced.passed, 2] ** 3
        radii.append([_spread(seen, weight), _spread(landing, flux)])
    ours, theirs = np.array(radii).T * 480 / (2.0 * half[0])
    assert np.all(np.abs(ours - theirs) < np.maximum(0.25, 0.05 * theirs)), (ours, theirs)
    # There is a blur to be compared.
    assert theirs.max() > 1.0


def _spread(places, weights):
    """Root mean square distance from the mean."""
    weights = weights / weights.sum()
    mean = weights @ places
    return np.sqrt(weights @ np.sum((places - mean) ** 2, axis=1))


def test_points_land_where_rays_traced_through_cylinders_do():
    prescription = _prescription("anamorphic-60mm-f2")
    lens = osl_lens(prescription, None, FOCUS, 2.0)
    half = np.array([0.24, 0.13])
    rays = lens_rays(prescription, None, FOCUS, 2.0, 0.3, True, tuple(1.3 * half))
    # Twice as narrow as high, and as much as focal lengths are apart but for the near focus.
    assert squeeze(prescription) == pytest.approx(60.555 / 31.5, rel=0.01)
    assert rays.stretch == pytest.approx(squeeze(prescription), rel=0.05)
    radius = lens.pupil_radius / 1000.0
    grids = field_grid(-half, half), field_grid(-half, half, 0.1)
    tables = sample_tables(rays, *grids, radius, rays.stretch)
    aimed = StopAim(lens.configuration, lens.pupil, lens.pupil_radius, LINE)
    rng = np.random.default_rng(1)
    compared = 0
    for _ in range(40):
        seen = rng.uniform(-1.0, 1.0, 2) * half
        vergence = rng.uniform(0.02, rays.largest_vergence)
        q = rng.uniform(-0.7, 0.7, 2)
        start = q * [lens.pupil_radius / rays.stretch, lens.pupil_radius]
        traced = aimed.rays(seen, np.array([vergence / 1000.0]), q[None], start[None])
        if not traced.found[0] or traced.rims[:, 0].min() < 0.0:
            continue
        place = rays.distortion.undone(traced.landing / rays.scale)[0]
        position = q * tables.aperture_radius / [rays.stretch, 1.0]
        eye = np.array([[*(seen / vergence), -1.0 / vergence]])
        moved = tables.displaced(eye, tables.moves(position[None])[0], position)[0]
        error = np.linalg.norm(moved[:2] * vergence - place) * WIDTH / (2.0 * half[0])
        assert error < 0.1, (seen, vergence, q)
        compared += 1
    assert compared > 25


def test_an_even_world_through_cylinders_is_as_bright_as_traced_from_the_sensor():
    prescription = _prescription("anamorphic-60mm-f2")
    lens = osl_lens(prescription, None, FOCUS, 2.0)
    half = np.array([0.24, 0.13])
    rays = lens_rays(prescription, None, FOCUS, 2.0, 0.3, True, tuple(1.3 * half))
    grids = field_grid(-half, half), field_grid(-half, half, 0.1)
    tables = sample_tables(rays, *grids, 0.01, rays.stretch)
    positions = spread_places(1000) * 0.01 / [rays.stretch, 1.0]
    light = tables.light(positions, np.sqrt(np.pi / 1000)).mean(axis=0).ravel()
    seen = np.array([[0.0, 0.0], [0.5, 0.0], [0.9, 0.0], [0.0, 0.9], [0.7, -0.7]]) * half
    index, weights = tables.light_grid.taps(seen)
    ours = (light[index] * weights).sum(axis=1)
    axis = (np.arange(160) + 0.5) / 80.0 - 1.0
    aimed = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2) * lens.aim_radius
    theirs = []
    for place in seen:
        # The field that is shown there lands, distorted, at:
        sensor = place.copy()
        for _ in range(20):
            sensor += place - rays.distortion.undone(sensor[None])[0]
        start = np.broadcast_to(sensor * rays.scale, aimed.shape)
        bundle = rays_from_sensor(start, aimed, lens.configuration.sensor, lens.aim)
        passed = trace(lens.configuration, bundle, LINE, backwards=True).passed
        theirs.append((bundle.directions[:, 2] ** 4)[passed].sum())
    assert ours / ours[0] == pytest.approx(np.array(theirs) / theirs[0], abs=0.01)


def test_a_focus_inside_the_lens_is_refused():
    with pytest.raises((FocusError, PrescriptionError)):
        lens_rays(_prescription("double-gauss-50mm-f2"), None, 0.01, 2.0, 0.3)


@pytest.mark.parametrize("focus", [300.0, 1e6])
def test_near_points_are_as_a_thin_lens_has_them_however_far_the_focus(focus):
    lens, rays, tables, half = _tables("planar-50mm-f1.4", 1.4, focus=focus)
    configuration = lens.configuration
    radius = configuration.surfaces[configuration.stop - 1].semi_diameter
    for distance, q in ((3.0, (0.5, 0.2)), (12.0, (-0.3, 0.6))):
        point = np.array([0.1 * half[0] * distance, 0.0, -distance])
        beam = Beam.from_point((*point[:2] * 1000.0, lens.pupil + point[2] * 1000.0))
        aimed = aim(configuration, beam, np.array([q]) * radius, LINE)
        traced = trace(configuration, beam.rays(aimed.coordinates), LINE)
        assert traced.passed[0]
        place = traced.at_plane(configuration.sensor)[0] / lens.scale
        position = np.array(q) * tables.aperture_radius
        moved = tables.displaced(point[None], tables.moves(position[None])[0], position)[0]
        error = np.linalg.norm(moved[:2] / distance - place) * WIDTH / (2.0 * half[0])
        assert error < 0.2, (distance, q)


def test_no_light_comes_from_beyond_the_field_of_a_lens():
    prescription = _prescription("telephoto-300mm-f2.9")
    corner = np.tan(np.radians(20.0))
    half = corner * np.array([3.0, 2.0]) / np.sqrt(13.0)
    rays = lens_rays(prescription, None, FOCUS * 5.0, 2.9, 1.2 * corner)
    tables = sample_tables(rays, field_grid(-half, half), field_grid(-half, half, 0.1), 0.05)
    turn = 2.399963 * np.arange(200)
    radius = np.sqrt((np.arange(200) + 0.5) / 200.0)
    places = radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1) * 0.05
    light = tables.light(places).mean(axis=0)
    assert light[0, 0] == 0.0 and light.max() > 0.5
    away = np.hypot(*tables.light_grid.nodes.T).reshape(light.shape)
    assert light[away > np.tan(np.radians(12.0))].max() == 0.0


# Sums of more terms, which the Sonnar's rays take, are steeper at the edge of what is seen.
@pytest.mark.parametrize(
    ("name", "least"), [("sonnar-50mm-f1.5", 0.98), ("petzval-51mm-f1.4", 0.985)]
)
def test_what_the_rims_stop_is_no_ghost_in_the_picture(name, least):
    _, rays, tables, half = _tables(name, 1.5)
    size = np.array([161, 109])
    step = 4.0 * half / (size - 1)
    x, y = (np.linspace(-2.0, 2.0, n) for n in size)
    seen = np.stack(np.meshgrid(x, y), axis=-1) * half
    places = np.array([(0.5, 0.0), (0.9, 0.0), (0.0, -0.9), (0.6, 0.6)]) * tables.aperture_radius
    every = tables.moves(places), tables.light(places, 0.1)
    for position, moves, light in zip(places, *every, strict=True):
        for vergence in (0.01, 0.5, rays.largest_vergence):
            points = np.insert(seen / vergence, 2, -1.0 / vergence, axis=-1)
            moved = tables.displaced(points.reshape(-1, 3), moves, position).reshape(points.shape)
            landing = moved[..., :2] * vergence
            blur = np.abs(position * (tables.focus_vergence - vergence)).max()
            inside = (np.abs(landing) < half).all(axis=-1)
            outside = (np.abs(seen) > 1.4 * half + blur).any(axis=-1)
            assert not (inside & outside).any()
            # One point for each place: the map of the field to the picture never turns over.
            across, up = (
                np.gradient(landing, axis=1) / step[0],
                np.gradient(landing, axis=0) / step[1],
            )
            turns = across[..., 0] * up[..., 1] - across[..., 1] * up[..., 0]
            index, weights = tables.light_grid.taps(landing.reshape(-1, 2))
            bright = (light.ravel()[index] * weights).sum(axis=-1).reshape(turns.shape) > 0.5
            # But for a strip of some nodes at the edge of what is seen.
            assert (turns[inside & bright] > 0.0).mean() > least
