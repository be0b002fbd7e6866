"""First-order values, axial fans and vignetting against two independent lens design programs."""

import json

import numpy as np
import pytest

from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.media import indices
from addon.optics.paraxial import first_order, image_distance, magnification
from addon.optics.rays.trace import Rays, RayStatus, trace
from addon.optics.rays.vignetting import vignetting

LENSES = (
    "aspheric-30mm-f2",
    "cooke-triplet-50mm",
    "double-gauss-50mm-f2",
    "fisheye-16mm-f2.8",
    "petzval-51mm-f1.4",
    "planar-50mm-f1.4",
    "retrofocus-35mm-f2.5",
    "singlet-planoconvex-100mm",
    "sonnar-50mm-f1.5",
    "telephoto-180mm-f2.8",
    "tessar-50mm-f2.8",
    "zoom-36-69mm-f3.5",
)
# The reference has 7 digits behind the point for lengths and 8 for indices and heights.
FIRST_ORDER_MM = 1.0e-7
INDEX = 1.0e-8
# Two programs agree to 3e-12 mm on spheres; the reference has 7 digits. Newton's method of one of
# them stops at 8e-7 mm on aspheres.
SPHERICAL_MM, ASPHERIC_MM = 1.0e-6, 1.0e-5
# The reference counted 401 x 401 samples, good to about 0.3 %.
AREA = 0.005


@pytest.fixture(scope="module")
def referee(shared):
    return json.loads((shared / "lenses" / "referee.json").read_text(encoding="utf-8"))


@pytest.fixture(params=LENSES)
def cases(request, shared, referee):
    """Configurations of one lens with what the referee says of each."""
    prescription = read_lens(shared / "lenses" / f"{request.param}.toml").prescription
    return [
        (prescription.configuration(case["label"]), case)
        for case in referee["lenses"][request.param]["configs"]
    ]


def wavelengths(case, referee):
    asked = referee["conventions"]["wavelengths_nm"]
    return [(nm, case["wavelengths"][f"{nm:.6g}"]) for nm in asked]


def test_every_lens_of_the_referee_is_asked(referee):
    assert set(referee["lenses"]) == set(LENSES)


def test_indices_are_those_of_the_referee(cases, referee):
    for configuration, case in cases:
        for nm, wanted in wavelengths(case, referee):
            found = indices(configuration, nm)[1:]
            np.testing.assert_allclose(found, wanted["index"], rtol=0.0, atol=INDEX)


def test_first_order_values_are_those_of_the_referee(cases, referee):
    for configuration, case in cases:
        distance = case["object_to_first_vertex_mm"]
        for nm, wanted in wavelengths(case, referee):
            values = first_order(configuration, nm)
            found = {
                "image_distance_1000_mm": image_distance(configuration, distance, nm),
                "magnification_1000": magnification(configuration, distance, nm),
            }
            for name in wanted["first_order"].keys() - found.keys():
                found[name] = getattr(values, name.removesuffix("_mm"))
            for name, value in wanted["first_order"].items():
                assert abs(found[name] - value) <= FIRST_ORDER_MM, (case["label"], nm, name)


def test_rays_of_an_axial_fan_are_those_of_the_referee(cases, referee):
    for configuration, case in cases:
        aspheric = any(s.asphere or s.conic for s in configuration.surfaces)
        tolerance = ASPHERIC_MM if aspheric else SPHERICAL_MM
        fan = fan_of(configuration, case["object_to_first_vertex_mm"])
        last = configuration.vertices[-1]
        for nm, wanted in wavelengths(case, referee):
            wanted = wanted["axis_fan"]
            traced = trace(configuration, fan, nm, clip=False)
            blocked = [
                int(surface) if reached else None
                for surface, reached in zip(traced.surface, traced.reached, strict=True)
            ]
            assert blocked == wanted["blocked_at_surface"]
            good = traced.reached
            planes = [last, *(last + plane for plane in case["plane_distance_mm"])]
            heights = [wanted["height_at_last_vertex_plane_mm"], *wanted["heights_mm"]]
            for plane, wanted_heights in zip(planes, heights, strict=True):
                wanted_heights = np.array(wanted_heights, dtype=float)
                found = traced.at_plane(plane)[:, 1]
                np.testing.assert_allclose(found[good], wanted_heights[good], 0.0, tolerance)
            slopes = traced.directions[:, 1] / traced.directions[:, 2]
            wanted_slopes = np.array(wanted["tan_slope"], dtype=float)
            np.testing.assert_allclose(slopes[good], wanted_slopes[good], 0.0, tolerance)
            assert set(traced.status[~good]) <= {RayStatus.MISSED, RayStatus.TOTAL_REFLECTION}


def fan_of(configuration, distance):
    pupil = first_order(configuration)
    rho = np.arange(21) / 20.0
    way = np.zeros((21, 3))
    way[:, 1] = 0.5 * pupil.enp_diameter * rho
    way[:, 2] = pupil.enp_z + distance
    way /= np.linalg.norm(way, axis=1)[:, None]
    return Rays(np.tile([0.0, 0.0, -distance], (21, 1)), way)


def test_vignetting_is_that_of_the_referee(cases):
    for configuration, case in cases:
        for place in ("axis", "field_0.7", "field_1"):
            wanted = case["vignetting"][place]
            found = vignetting(configuration, wanted.get("field_deg", 0.0))
            assert found.area_passing == pytest.approx(wanted["area_passing_mm2"], rel=AREA)
            assert found.fraction_of_paraxial_pupil == pytest.approx(
                wanted["fraction_of_paraxial_pupil"], abs=AREA
            )
            # The reference also counts rays far outside the rims that find a second way.
            assert found.area_stop_only <= wanted["area_stop_only_mm2"] * (1.0 + AREA)
            assert found.area_stop_only >= found.area_passing * (1.0 - AREA)
