"""Bokeh of points off the axis by tracing every ray: the oracle of the pupil tables.

Nothing is tabulated or interpolated: the rays of the very point are sent in an even lattice over
the pupil of the very opening, and those that get through are counted where they meet the sensor.
"""

from dataclasses import dataclass

import numpy as np

from addon.optics.glass import REFERENCE_WAVELENGTH_NM
from addon.optics.rays.pupil import as_beam, pupil_box
from addon.optics.rays.trace import trace

RAYS = 1 << 20
# Steps of the additive recurrence that fills a square most evenly: powers of the root of
# g^3 = g + 1 (M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018).
_PLASTIC = 1.32471795724474602596


@dataclass(frozen=True)
class TracedBeam:
    """Rays of one point that got through.

    Parameters
    ----------
    landing : ndarray of shape (N, 2)
        On the sensor, mm.
    slopes : ndarray of shape (N, 2)
        dx/dz and dy/dz behind the lens.
    energy : ndarray of shape (N,)
        Area of the beam in mm^2; for a near point, solid angle times the squared distance of the
        point to surface 1.
    """

    landing: np.ndarray
    slopes: np.ndarray
    energy: np.ndarray


def traced_beam(configuration, source, f_number=None, rays=RAYS, transmission=False):
    """Trace the beam of a point.

    Parameters
    ----------
    configuration : Configuration
        Wide open.
    source : float or sequence of 3 float
        Field angle in degrees of a point at infinity, or a point in mm.
    f_number : float or None
    rays : int
        Over the box of the pupil.
    transmission : bool
        Whether rays lose what bare surfaces reflect.

    Returns
    -------
    TracedBeam
    """
    closed = configuration if f_number is None else configuration.stopped_down(f_number)
    beam = as_beam(source)
    u0, u1, v0, v1 = pupil_box(closed, beam)
    count = np.arange(1, rays + 1)
    u = np.modf(count / _PLASTIC)[0] * (u1 - u0) + u0
    v = np.modf(count / _PLASTIC**2)[0] * (v1 - v0) + v0
    places = np.stack([u, v], axis=-1)
    traced = trace(closed, beam.rays(places), REFERENCE_WAVELENGTH_NM, transmission=transmission)
    passed = traced.passed
    energy = beam.density(places)[passed] * ((u1 - u0) * (v1 - v0) / rays)
    if not beam.is_parallel:
        energy *= beam.distance**2
    if transmission:
        energy *= traced.transmission[passed]
    directions = traced.directions[passed]
    return TracedBeam(
        traced.at_plane(configuration.sensor)[passed],
        directions[:, :2] / directions[:, 2:],
        energy,
    )


def counted_picture(beam, shift, size, extent, centre):
    """Count the energy of rays in texels.

    Parameters
    ----------
    beam : TracedBeam
    shift : float
        Sensor's distance behind that of the configuration, mm.
    size : int
    extent : float
        Half the width of the picture, mm.
    centre : sequence of 2 float
        Middle of the picture, mm.

    Returns
    -------
    ndarray of shape (size, size)
        Rows along y, rising.
    """
    places = (beam.landing + beam.slopes * shift - np.asarray(centre) + extent) * (
        size / (2.0 * extent)
    )
    texels = np.floor(places).astype(int)
    inside = ((texels >= 0) & (texels < size)).all(axis=1)
    texels = texels[inside]
    flat = np.bincount(texels[:, 1] * size + texels[:, 0], beam.energy[inside], size * size)
    return flat.reshape(size, size)
