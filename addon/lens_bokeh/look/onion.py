"""Onion rings: the turning marks of aspheric surfaces, seen in a defocused point.

An asphere that was turned, or moulded from a turned die, carries a ripple ``A cos(2 pi r / p)``.
Each groove is a weak lens: it bends the beam by ``(n - 1) A (2 pi / p) sin(2 pi r / p)``, and on a
sensor away from focus light gathers behind the crests and thins out behind the grooves. To first
order the density changes by the factor ``1 + C cos(2 pi r / p)`` with

``C = dn A (2 pi / p)^2 a^2 / (lambda N)``

where a is the beam's radius on the surface, dn the step of the index and N the Fresnel number of
the defocus (a^2 / (lambda N) is the distance over which a parallel beam of that radius would be as
far out of focus). Rings are centred on the axis of the surface, which moves across the pupil with
the field. Lengths in a pattern are in units of the opening's radius.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import InputError


@dataclass(frozen=True)
class OnionRings:
    """Rings in the pattern.

    Parameters
    ----------
    contrast : float
        Largest relative change of the density, 0 to 1: the C of the module.
    pitch : float
        Distance of rings in units of the opening's radius.
    irregularity : float
        0: all rings alike; 1: depth and place of each ring are random, as a tool leaves them.
    shift : float
        Displacement of the centre for a chief ray of tangent 1, in units of the opening's radius.
    seed : int
    """

    contrast: float = 0.08
    pitch: float = 0.045
    irregularity: float = 0.5
    shift: float = 0.0
    seed: int = 0

    def __post_init__(self):
        """Check that all values are in range."""
        for name, low, high in (
            ("contrast", 0.0, 1.0),
            ("pitch", 1e-3, 10.0),
            ("irregularity", 0.0, 1.0),
            ("shift", -1e3, 1e3),
            ("seed", 0, 2**63 - 1),
        ):
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(
                    f"onion rings: {name} is {value:g}; it must be from {low:g} to {high:g}"
                )


def transmission(rings, points, field=(0.0, 0.0), width=0.0):
    """Factor of the light density by the rings at places of the opening.

    Parameters
    ----------
    rings : OnionRings
    points : ndarray of shape (..., 2)
        In units of the opening's radius.
    field : tuple of float
        Tangent of the chief ray's angle in x and y.
    width : float
        Side of a texel: rings finer than two texels fade instead of making moire.

    Returns
    -------
    ndarray of shape (...)
        1 - contrast to 1 + contrast.
    """
    offset = np.asarray(points, dtype=float) - np.asarray(field, dtype=float) * rings.shift
    turns = np.hypot(offset[..., 0], offset[..., 1]) / rings.pitch
    count = int(np.ceil(turns.max(initial=0.0))) + 2
    generator = np.random.default_rng(rings.seed)
    depth = 1.0 - rings.irregularity * generator.random(count)
    # A third of a ring: neighbours keep their order.
    phase = rings.irregularity * (generator.random(count) - 0.5) * 2.0 / 3.0
    ring = np.minimum(turns.astype(int), count - 2)
    along = turns - ring
    ease = along * along * (3.0 - 2.0 * along)
    depth = depth[ring] * (1.0 - ease) + depth[ring + 1] * ease
    phase = phase[ring] * (1.0 - ease) + phase[ring + 1] * ease
    visible = np.clip(2.0 - 2.0 * width / rings.pitch * 2.0, 0.0, 1.0)
    return 1.0 + rings.contrast * visible * depth * np.cos(2.0 * np.pi * (turns + phase))
