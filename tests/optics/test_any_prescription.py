"""No prescription makes the optics warn, hang, or give numbers that are not finite."""

import dataclasses
import math
import time

import numpy as np
import pytest

from addon.errors import AplanatError
from addon.optics.focus import focused
from addon.optics.fresnel import Coating
from addon.optics.glass import ConstantGlass
from addon.optics.paraxial import first_order, image_distance
from addon.optics.prescription import FocusGroup
from addon.optics.rays.pupil import pupil_outline, pupil_rays
from addon.optics.rays.trace import Rays, trace
from addon.optics.rays.vignetting import vignetting
from tests.optics.lenses import biconvex, symmetric, triplet

MAGNITUDES = (1e-300, 1e-30, 1e-8, 1e-3, 1.0, 1e3, 1e8, 1e30, 1e160, 1e300, 1.7e308)
# The lens files' own bar for a mutated file is 2 s; one answer takes a fraction of that.
SECONDS = 2.0


def number(random, positive=False):
    value = float(random.choice(MAGNITUDES)) * float(random.uniform(0.1, 1.0))
    return value if positive or random.random() < 0.5 else -value


def mutated(configuration, random):
    surfaces = list(configuration.surfaces)
    for _ in range(random.integers(1, 5)):
        place = int(random.integers(len(surfaces)))
        orders = sorted(random.choice(range(2, 22, 2), random.integers(1, 10), replace=False))
        change = random.choice(
            [
                {"radius": number(random)},
                {"thickness": number(random, positive=True)},
                {"semi_diameter": number(random, positive=True)},
                {"glass": ConstantGlass(float(random.choice([1.0000001, 1.5, 4.0])))},
                {"conic": float(random.choice([-1.0, -2.0, 0.5, number(random)]))},
                {"asphere": tuple((int(order), number(random)) for order in orders)},
                {"curved_along": str(random.choice(["x", "y"]))},
            ]
        )
        surfaces[place] = dataclasses.replace(surfaces[place], **change)
    return dataclasses.replace(configuration, surfaces=tuple(surfaces))


def all_sorts_of_rays(random):
    origins = random.normal(size=(300, 3)) * random.choice([1.0, 30.0, 1e6], (300, 1))
    directions = random.normal(size=(300, 3))
    directions[:150, :2] *= 0.1
    directions[150:160] = (1.0, 0.0, 0.0)
    directions[160:170] = (0.0, 0.0, 1.0)
    directions[170:180] = (0.0, 0.0, -1.0)
    origins[165:175] = 0.0
    return Rays(origins, directions / np.linalg.norm(directions, axis=1)[:, None])


def assert_finite(answer):
    if isinstance(answer, float):
        assert math.isfinite(answer)
    elif isinstance(answer, np.ndarray):
        assert np.isfinite(answer).all()
    elif dataclasses.is_dataclass(answer):
        for field in dataclasses.fields(answer):
            value = getattr(answer, field.name)
            # A plane's radius is inf by its definition.
            if not (field.name == "radius" and value == math.inf):
                assert_finite(value)
    elif isinstance(answer, list | tuple):
        for one in answer:
            assert_finite(one)


@pytest.mark.parametrize("seed", range(120))
def test_answers_are_finite_or_refused(seed):
    random = np.random.default_rng(seed)
    configuration = mutated((biconvex, symmetric, triplet)[seed % 3](), random)
    fan = all_sorts_of_rays(random)
    questions = [
        lambda: trace(configuration, fan, 550.0),
        lambda: trace(configuration, fan, 550.0, clip=False, record=True).hits,
        lambda: trace(
            configuration, fan, 550.0, backwards=True, transmission=True, coating=Coating()
        ),
        lambda: trace(configuration, fan, 550.0, clip=False).at_plane(1e300),
        lambda: first_order(configuration),
        lambda: image_distance(configuration, 100.0),
        lambda: focused(configuration, 1000.0),
        lambda: focused(configuration, 1000.0, FocusGroup(2, 2)),
        lambda: vignetting(configuration, 10.0, grid=41),
        lambda: pupil_outline(configuration, (0.0, 10.0, -500.0), 32),
        lambda: pupil_rays(configuration, 85.0, 41),
    ]
    for question in questions:
        start = time.perf_counter()
        try:
            answer = question()
        except AplanatError:
            answer = None
        assert time.perf_counter() - start < SECONDS
        assert_finite(answer)


@pytest.mark.parametrize("seed", range(40))
def test_directions_are_unit_vectors_whatever_the_lens(seed):
    random = np.random.default_rng(1000 + seed)
    configuration = mutated(triplet(), random)
    traced = trace(configuration, all_sorts_of_rays(random), 550.0, clip=False)
    # Each surface rounds; a ray that grazes a steep asphere loses a few more digits.
    np.testing.assert_allclose(np.linalg.norm(traced.directions, axis=1), 1.0, atol=1e-9)
