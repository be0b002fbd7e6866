"""Chromatic aberration of a frame's discs: bands of wavelengths, their shifts and radii.

The disc of a band lies where the lens samples of its wavelengths see the highlight: with the focus
and the lateral scale that they have at the highlight's place in the field. The visibility mask over
the lens is the same for all bands: whether an occluder lies on the line from the highlight to a
place on the lens does not depend on the focus.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...sampling.chromatic import LEAST_SCALE
from ...sampling.spectral_bands import BandLevel, band_levels, spectral_length
from .chromatic import ChromaticPlan

_MOST_BANDS = 16
_DRAFT_BANDS = 4


@dataclass(frozen=True, eq=False)
class BokehColors:
    """Chromatic aberration of the discs of a frame.

    Parameters
    ----------
    levels : tuple of BandLevel
        Bands in which a highlight is drawn, by its `spectral_length`.
    spreads : tuple of 2 float
        Spread of the colours, px: axial, times one minus the axial map, and lateral, times the
        lateral map and the distance from the axis in the field.
    focus_changes : tuple of 3 float
        Differences of the inverse focus distance from the reference wavelength's, 1/m: the least
        and the largest of any band anywhere in the picture, and one that represents all.
    focus_distance : float
        Focus distance that represents all wavelengths, m.
    growth : float
        Largest lateral shift of a disc, as a share of its distance from the axis.
    """

    levels: tuple[BandLevel, ...]
    spreads: tuple[float, float]
    focus_changes: tuple[float, float, float]
    focus_distance: float
    growth: float

    @property
    def bands(self):
        """The bands of the finest level."""
        return self.levels[-1].bands

    def draft(self):
        """Return the same with few bands, for a draft."""
        levels = [level for level in self.levels if len(level.bands) <= _DRAFT_BANDS]
        return replace(self, levels=(*levels[:-1], replace(levels[-1], most=np.inf)))


def plan_colors(aberration, chromatic: ChromaticPlan, coc_scale, farthest):
    """Plan the bands of wavelengths of a frame's discs.

    Parameters
    ----------
    aberration : ChromaticAberration
    chromatic : ChromaticPlan
    coc_scale : float
        See `FramePlan`.
    farthest : float
        Depth of the farthest highlight, m; used for a parallel projection.

    Returns
    -------
    BokehColors
    """
    axial, lateral = np.moveaxis(chromatic.table.astype(np.float64), -1, 0)
    axial_px = coc_scale / chromatic.focal_length * (farthest if chromatic.parallel else 1.0)
    field_px = 1.0 / float(np.abs(chromatic.raster[:2]).min())
    spreads = (
        spectral_length(aberration, axial_px, 0.0),
        spectral_length(aberration, 0.0, field_px),
    )
    kept = float(np.abs(1.0 - axial).max())
    away = np.linspace(0.0, 1.0, lateral.shape[1]) * chromatic.radius
    moved = float(np.abs(lateral * away).max())
    levels = band_levels(aberration, axial_px * kept, field_px * moved, _MOST_BANDS)
    bands = levels[-1].bands
    errors = np.array([band.focal_error for band in bands])
    ends = np.array([errors.min(), errors.max()])[:, None]
    focus = chromatic.inverse_focus_at(ends, np.array([axial.min(), axial.max()]))
    middle = chromatic.inverse_focus_at(np.mean(chromatic.typical_errors), np.median(axial))
    changes = np.array([focus.min(), focus.max(), middle]) - chromatic.inverse_focus
    strengths = np.array([band.lateral_strength for band in bands])[:, None]
    scale = np.maximum(1.0 + strengths * (lateral.min(), lateral.max()), LEAST_SCALE)
    growth = float(np.abs(scale - 1.0).max())
    return BokehColors(levels, spreads, tuple(changes.tolist()), float(1.0 / middle), growth)
