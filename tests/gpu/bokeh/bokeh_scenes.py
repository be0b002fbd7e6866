"""Lamps and how they are drawn with bokeh: shared by the tests of the frame."""

from dataclasses import replace

import numpy as np

from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings

from ..conftest import triangles_snapshot

PASSES = ("Combined", "Defocus", "Bokeh")
LENS = ThinLens(0.25, 3.0, Iris())
WIDTH, HEIGHT = 96, 64


def lamp(x, y, depth, size):
    """Return a triangle that faces the camera, with its centre of gravity in the middle.

    None of its sides lies along the rows of the raster, where a row more or less is much of it.
    """
    angles = 0.4 + np.arange(3) * 2 * np.pi / 3
    return np.stack([x + size * np.cos(angles), y + size * np.sin(angles), 0 * angles - depth], 1)


def with_bokeh(snapshot, passes=PASSES, **settings):
    """Splat the highlights of a snapshot of the reference method."""
    return replace(
        snapshot,
        camera=replace(snapshot.camera, bokeh=BokehSettings(**settings)),
        sampling=replace(snapshot.sampling, reference_bokeh=True),
        passes=passes,
    )


def energy(picture):
    return picture[..., :3].astype(np.float64).sum(axis=(0, 1))


LAMPS = [lamp(-0.8, 0.3, 8.0, 0.25), lamp(1.2, -0.6, 8.0, 0.3), lamp(-0.15, -0.2, 1.5, 0.05)]
LIGHTS = [(20.0, 10.0, 5.0), (30.0, 30.0, 10.0), (4.0, 16.0, 4.0)]


def lamps(lens=LENS, samples=16, **options):
    return triangles_snapshot(LAMPS, LIGHTS, WIDTH, HEIGHT, lens, samples, **options)
