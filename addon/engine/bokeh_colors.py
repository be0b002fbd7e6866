"""Chromatic aberration of a frame's discs: bands of light, and how far they move and grow.

A disc of a band is where the lens samples of its wavelengths see the highlight: with the focus and
the scale that they have at the highlight's own place in the field. The mask over the lens is the
same for all: two points on a line to a place on the lens stay on it, whatever the focus.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..sampling.chromatic import LEAST_SCALE
from ..sampling.spectral_bands import SpectralBand, merged_bands, spectral_bands
from .chromatic import ChromaticPlan

# Rims of discs are then within one per cent of where all wavelengths put them.
_MOST_BANDS = 24
_DRAFT_BANDS = 4


@dataclass(frozen=True, eq=False)
class BokehColors:
    """What chromatic aberration does to the discs of a frame.

    Parameters
    ----------
    bands : tuple of SpectralBand
        A disc each.
    focus_changes : tuple of 3 float
        Of the inverse focus distance from the reference wavelength's, 1/m: the least and the
        largest of any band anywhere in the picture, and what stands for all.
    focus_distance : float
        That stands for all, m.
    growth : float
        By which share of their distance from the axis discs move, at the most.
    """

    bands: tuple[SpectralBand, ...]
    focus_changes: tuple[float, float, float]
    focus_distance: float
    growth: float

    def draft(self):
        """Return the same in a few bands."""
        return replace(self, bands=merged_bands(self.bands, _DRAFT_BANDS))


def plan_colors(aberration, chromatic: ChromaticPlan, coc_scale, farthest):
    """Plan in which bands a frame's discs are drawn.

    Parameters
    ----------
    aberration : ChromaticAberration
    chromatic : ChromaticPlan
    coc_scale : float
        See `FramePlan`.
    farthest : float
        Depth of the farthest highlight, m; counts for a parallel projection.

    Returns
    -------
    BokehColors
    """
    axial, lateral = np.moveaxis(chromatic.table.astype(np.float64), -1, 0)
    kept = float(np.abs(1.0 - axial).max())
    axial_px = coc_scale / chromatic.focal_length * kept * (farthest if chromatic.parallel else 1.0)
    away = np.linspace(0.0, 1.0, lateral.shape[1]) * chromatic.radius
    lateral_px = float(np.abs(lateral * away).max() / np.abs(chromatic.raster[:2]).min())
    bands = spectral_bands(aberration, axial_px, lateral_px, _MOST_BANDS)
    errors = np.array([band.focal_error for band in bands])
    ends = np.array([errors.min(), errors.max()])[:, None]
    focus = chromatic.inverse_focus_at(ends, np.array([axial.min(), axial.max()]))
    middle = chromatic.inverse_focus_at(np.mean(chromatic.typical_errors), np.median(axial))
    changes = np.array([focus.min(), focus.max(), middle]) - chromatic.inverse_focus
    strengths = np.array([band.lateral_strength for band in bands])[:, None]
    scale = np.maximum(1.0 + strengths * (lateral.min(), lateral.max()), LEAST_SCALE)
    growth = float(np.abs(scale - 1.0).max())
    return BokehColors(bands, tuple(changes.tolist()), float(1.0 / middle), growth)
