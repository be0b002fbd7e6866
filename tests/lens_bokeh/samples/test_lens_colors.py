"""Colours of a real lens in lens samples, against rays traced at each wavelength."""

import numpy as np
import pytest

from addon.lens_bokeh.samples.field_grid import field_grid
from addon.lens_bokeh.samples.lens_rays import lens_rays
from addon.lens_bokeh.samples.sample_tables import sample_tables
from addon.lens_bokeh.tables.undistorted import undistorted
from addon.lens_io.lens_shelf import LensShelf
from addon.optics.focal_shift import equivalent_focal_lengths
from addon.optics.rays.aiming import aim
from addon.optics.rays.beam import Beam
from addon.optics.rays.trace import trace
from benchmarks.referees.osl_lens import osl_lens

FOCUS = 2.0
# Of the picture, px, and its corner, mm from the axis.
WIDTH, CORNER = 1920, 21.6
LINES = {"C": 656.2725, "d": 587.5618, "F": 486.1327}
# Places of the iris, evenly spread.
PLACES = np.sqrt((np.arange(24) + 0.5) / 24)[:, None] * np.stack(
    [np.cos(2.4 * np.arange(24)), np.sin(2.4 * np.arange(24))], axis=-1
)


class Lens:
    """A lens with its tables and its tracer."""

    def __init__(self, name, f_number):
        prescription = LensShelf([]).find(name).lens.prescription
        self.lens = osl_lens(prescription, None, FOCUS, f_number)
        configuration = self.lens.configuration
        tangent = CORNER / abs(self.lens.scale)
        tangent = min(tangent, np.tan(np.radians(configuration.half_field_deg)))
        self.half = tangent * np.array([3.0, 2.0]) / np.sqrt(13.0)
        self.rays = lens_rays(prescription, None, FOCUS, f_number, 1.2 * tangent, colored=True)
        self.radius = self.lens.pupil_radius / 1000.0
        grids = field_grid(-self.half, self.half), field_grid(-self.half, self.half, 0.1)
        self.tables = sample_tables(self.rays, *grids, self.radius)

    @property
    def pixels(self):
        """Of a tangent of 1."""
        return WIDTH / (2.0 * self.half[0])

    def traced(self, seen, vergence, places, wavelength):
        """Places in the picture without distortion, as tangents, of rays that no rim stops."""
        configuration = self.lens.configuration
        radius = configuration.surfaces[configuration.stop - 1].semi_diameter
        point = np.array([*(seen / vergence), -1.0 / vergence]) * 1000.0
        beam = Beam.from_point((*point[:2], self.lens.pupil + point[2]))
        aimed = aim(configuration, beam, places * radius, wavelength)
        found = trace(configuration, beam.rays(aimed.coordinates), wavelength)
        landing = found.at_plane(configuration.sensor) / self.lens.scale
        landing[~found.passed] = 1.0
        away = np.linalg.norm(landing, axis=1)
        shown = undistorted(self.rays.distorted, away)
        return landing * (shown / away)[:, None], aimed.found & found.passed

    def drawn(self, seen, vergence, places, wavelength):
        """The same, as samples have it."""
        shares = self.rays.colors.shares([wavelength] * len(places))
        positions = places * self.radius
        moves = self.tables.moves(positions, np.stack([shares, shares], axis=1))
        point = np.array([[*(seen / vergence), -1.0 / vergence]])
        pairs = zip(moves, positions, strict=True)
        moved = [self.tables.displaced(point, move, place)[0, :2] for move, place in pairs]
        return np.array(moved) * vergence


@pytest.fixture(
    scope="module", params=[("double-gauss-50mm-f2", 2.0), ("singlet-planoconvex-100mm", 4.0)]
)
def lens(request):
    return Lens(*request.param)


def test_rays_of_each_wavelength_land_where_traced_ones_do(lens):
    rng = np.random.default_rng(1)
    for wavelength in (400.0, *LINES.values(), 700.0):
        for _ in range(3):
            seen = rng.uniform(-1.0, 1.0, 2) * lens.half
            vergence = rng.uniform(0.02, lens.rays.largest_vergence)
            places = 0.7 * PLACES[::4]
            wanted, passed = lens.traced(seen, vergence, places, wavelength)
            found = lens.drawn(seen, vergence, places, wavelength)
            error = np.linalg.norm(found - wanted, axis=1)[passed] * lens.pixels
            assert error.max() < 0.1, (wavelength, seen, vergence)


def test_centroids_of_lateral_color_are_those_of_traced_rays(lens):
    shifts = []
    for share in (0.3, 0.6, 0.95):
        seen = share * lens.half
        vergence = lens.rays.focus_vergence
        centroids = {}
        for line, wavelength in LINES.items():
            wanted, passed = lens.traced(seen, vergence, PLACES, wavelength)
            found = lens.drawn(seen, vergence, PLACES, wavelength)
            centroids[line] = [each[passed].mean(axis=0) * lens.pixels for each in (found, wanted)]
        for line in "CF":
            found, wanted = (a - b for a, b in zip(centroids[line], centroids["d"], strict=True))
            assert np.linalg.norm(found - wanted) < 0.05, (line, share)
            shifts.append(np.linalg.norm(wanted))
    # There is something to be missed.
    assert max(shifts) > 0.2


def test_the_focus_shifts_as_that_of_the_paraxial_lens():
    prescription = LensShelf([]).find("singlet-planoconvex-100mm").lens.prescription
    closed = lens_rays(prescription, None, FOCUS, 22.0, 0.05, colored=True)
    lines = [LINES["F"], LINES["C"], LINES["d"]]
    lengths = equivalent_focal_lengths(prescription.configuration(None), lines)
    wanted = (1.0 / lengths[:2] - 1.0 / lengths[2]) * 1000.0
    found = closed.colors.shares([LINES["F"], LINES["C"]]) @ closed.colors.focus
    np.testing.assert_allclose(found, wanted, rtol=0.05)


def test_a_lens_without_dispersion_has_no_colors():
    prescription = LensShelf([]).find("phone-3.7mm-f2.8").lens.prescription
    assert lens_rays(prescription, None, FOCUS, 2.8, 0.2, colored=True).colors is None
