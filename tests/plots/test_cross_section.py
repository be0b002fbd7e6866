"""The drawn section is the lens: outlines on its surfaces, rays that really get through."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.glass import AIR, ConstantGlass
from addon.optics.paraxial import first_order
from addon.optics.prescription import Configuration, Surface
from addon.plots.cross_section import draw_cross_section, element_outlines, ray_paths, sensor_plane


def singlet(**changes):
    values = {"radius": 51.68, "thickness": 4.0, "semi_diameter": 10.0, "is_stop": True}
    front = Surface(**(values | changes), glass=ConstantGlass(1.5168))
    back = Surface(radius=float("inf"), thickness=97.4, semi_diameter=8.0, glass=AIR)
    return Configuration((front, back), 100.0, 5.0, 5.0)


@pytest.fixture
def lens(shared):
    def read(name):
        return read_lens(shared / "lenses" / f"{name}.toml").prescription.configuration()

    return read


def picture(configuration, **options):
    figure = Figure(figsize=(2, 2), dpi=64)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.axis("off")
    draw_cross_section(axes, configuration, **options)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba()), axes


def test_an_element_reaches_from_surface_to_surface_and_to_the_larger_rim():
    (outline,) = element_outlines(singlet())
    z, height = outline.T
    assert height.max() == 10.0 and height.min() == -10.0
    assert z.min() == 0.0
    # The plane back ends at 8 mm; from there the rim is flat.
    assert z.max() == 4.0
    assert sorted({round(h, 9) for h in height[z == 4.0] if h >= 8.0}) == [8.0, 10.0]


def test_every_glass_of_a_lens_is_one_outline(lens):
    assert len(element_outlines(lens("double-gauss-50mm-f2"))) == 6
    assert len(element_outlines(lens("sonnar-50mm-f1.5"))) == 7


def test_rays_of_the_axis_fill_the_opening_and_meet_in_the_focus(lens):
    configuration = lens("tessar-50mm-f2.8")
    paths = ray_paths(configuration, 0.0, 7)
    assert len(paths) == 7
    entering = [path[1, 1] for path in paths]
    diameter = first_order(configuration).enp_diameter
    # A few of a hundred: places are searched on a grid of 801 over three times the radius.
    assert np.ptp(entering) == pytest.approx(diameter, rel=0.03)
    assert entering == pytest.approx([-height for height in entering[::-1]], abs=1e-9)
    # Spherical aberration of a corrected lens is far below what a drawing shows.
    assert max(abs(path[-1, 1]) for path in paths) < 0.3


@pytest.mark.parametrize(
    ("name", "share"), [("double-gauss-50mm-f2", 0.7), ("fisheye-16mm-f2.8", 0.9)]
)
def test_rays_of_a_field_reach_the_sensor_off_the_axis(lens, name, share):
    configuration = lens(name)
    paths = ray_paths(configuration, share * configuration.half_field_deg, 5)
    assert len(paths) >= 3
    heights = [path[-1, 1] for path in paths]
    assert min(heights) > 5.0
    assert np.ptp(heights) < 1.0


def test_rays_that_nothing_lets_through_are_not_drawn(lens):
    assert ray_paths(lens("telephoto-180mm-f2.8"), 60.0, 5) == []


def test_a_sensor_that_the_file_does_not_tell_is_in_the_focus():
    told = singlet()
    untold = told.with_thickness(2, 0.0)
    assert sensor_plane(told) == pytest.approx(101.4)
    assert sensor_plane(untold) == pytest.approx(4.0 + first_order(untold).bfl)


def test_a_cylinder_is_curved_in_its_own_meridian_only():
    cylinder = singlet(curved_along="x")
    (flat,), (curved,) = element_outlines(cylinder, "y"), element_outlines(cylinder, "x")
    assert set(np.round(flat[:, 0], 9)) == {0.0, 4.0}
    assert len(set(np.round(curved[:, 0], 9))) > 10
    assert all(abs(path[-1, 1]) > 1.0 for path in ray_paths(cylinder, 0.0, 4, "y"))
    assert all(abs(path[-1, 1]) < 0.2 for path in ray_paths(cylinder, 0.0, 4, "x"))


def test_the_drawing_holds_the_whole_lens(lens):
    configuration = lens("retrofocus-35mm-f2.5")
    pixels, axes = picture(configuration, fields_deg=(0.0, 20.0))
    assert pixels[..., :3].std() > 10
    low, high = axes.get_ylim()
    assert high == -low >= max(surface.semi_diameter for surface in configuration.surfaces)
    left, right = axes.get_xlim()
    assert left < 0.0 and right > sensor_plane(configuration)
