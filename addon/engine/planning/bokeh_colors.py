"""Chromatic aberration of a frame's discs: bands of wavelengths, their shifts and radii.

The disc of a band lies where the lens samples of its wavelengths see the highlight: with the focus
and the lateral scale that they have at the highlight's place in the field. The visibility mask over
the lens is the same for all bands: whether an occluder lies on the line from the highlight to a
place on the lens does not depend on the focus.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...sampling.chromatic import LEAST_SCALE
from ...sampling.spectral_bands import (
    BandLevel,
    band_levels,
    bands_needed,
    light_lines,
    spectral_length,
)
from .chromatic import ChromaticPlan

_MOST_BANDS = 16
_DRAFT_BANDS = 4
# Of the focus that represents all wavelengths, over the reference's: its vergence at least.
_LEAST_FOCUS = 1e-6


@dataclass(frozen=True, eq=False)
class TracedBand:
    """A part of the light of a highlight, seen through a real lens at its wavelengths.

    Parameters
    ----------
    weights : tuple of 3 float
        Its share of red, green and blue.
    focus_change : float
        Mean difference of the inverse focus distance from the reference wavelength's, 1/m.
    width_px : float
        Side of the box with the variance that the radius of its discs has within the band, px.
    shares : ndarray of shape (2, K)
        As of `RealLensPlan.color_shares`.
    """

    weights: tuple[float, float, float]
    focus_change: float
    width_px: float
    shares: np.ndarray


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
    traced : tuple of TracedBand
        Instead of levels, where the colours are those of a real lens.
    few : tuple of TracedBand
        Those of a draft.
    """

    levels: tuple[BandLevel, ...]
    spreads: tuple[float, float]
    focus_changes: tuple[float, float, float]
    focus_distance: float
    growth: float
    traced: tuple[TracedBand, ...] = ()
    few: tuple[TracedBand, ...] = ()

    @property
    def bands(self):
        """The bands of the finest level."""
        return self.traced or self.levels[-1].bands

    def draft(self):
        """Return the same with few bands, for a draft."""
        if self.traced:
            return replace(self, traced=self.few)
        levels = [level for level in self.levels if len(level.bands) <= _DRAFT_BANDS]
        return replace(self, levels=(*levels[:-1], replace(levels[-1], most=np.inf)))


def colors_of_frame(aberration, plan, farthest):
    """Plan the bands of wavelengths of a frame's discs.

    Parameters
    ----------
    aberration : ChromaticAberration or None
        Of the camera.
    plan : FramePlan
    farthest : float
        Depth of the farthest highlight, m.

    Returns
    -------
    BokehColors or None
        None: one disc for all wavelengths.
    """
    if plan.chromatic is None:
        return None
    if plan.chromatic.traced:
        return plan_traced_colors(aberration, plan)
    return plan_colors(aberration, plan.chromatic, plan.coc_scale, farthest)


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
    # In front of the camera, however strong the colours.
    middle = max(float(middle), chromatic.inverse_focus * _LEAST_FOCUS)
    changes = np.array([focus.min(), focus.max(), middle]) - chromatic.inverse_focus
    strengths = np.array([band.lateral_strength for band in bands])[:, None]
    scale = np.maximum(1.0 + strengths * (lateral.min(), lateral.max()), LEAST_SCALE)
    growth = float(np.abs(scale - 1.0).max())
    return BokehColors(levels, spreads, tuple(changes.tolist()), float(1.0 / middle), growth)


def plan_traced_colors(aberration, plan):
    """Plan the bands of wavelengths of a frame's discs, with the colours of its real lens.

    Parameters
    ----------
    aberration : ChromaticAberration
    plan : FramePlan
        With a `real_lens`.

    Returns
    -------
    BokehColors or None
        None: the lens parts no colours.
    """
    lens = plan.real_lens
    if lens.colors is None:
        return None
    wavelengths, light = light_lines(aberration)
    shares = lens.color_shares(wavelengths)
    # At the corner, of points between near and far.
    farthest = lens.colors.chief[:, -1].mean(axis=-1)
    places = np.stack([shares[:, 0] @ lens.colors.focus, shares[:, 1] @ farthest], axis=1)
    field_px = float(plan.projection[1, 1]) * plan.height / 2.0
    scales = plan.coc_scale, field_px
    bands, few = (
        _traced_bands(light, places, shares, bands_needed(light, places, *scales, most), scales[0])
        for most in (_MOST_BANDS, _DRAFT_BANDS)
    )
    changes = np.array([band.focus_change for band in bands])
    middle = float(light.mean(axis=1) @ places[:, 0])
    corner = plan.real_lens.corner
    inverse = max(1.0 / plan.focus_distance + middle, _LEAST_FOCUS / plan.focus_distance)
    return BokehColors(
        levels=(),
        spreads=(0.0, 0.0),
        focus_changes=(float(changes.min()), float(changes.max()), middle),
        focus_distance=1.0 / inverse,
        growth=float(np.abs(places[:, 1]).max() / corner),
        traced=bands,
        few=few,
    )


def _traced_bands(light, places, shares, numbers, coc_scale):
    """Join spectral lines into bands; `numbers` has the band of each line, without gaps."""
    # The channels alike, so that a band is as good for one as for another.
    weight = light.mean(axis=1)
    bands = []
    for number in range(numbers.max() + 1):
        own = numbers == number
        part = weight[own] / weight[own].sum()
        change = float(part @ places[own, 0])
        variance = float(part @ (places[own, 0] - change) ** 2)
        bands.append(
            TracedBand(
                tuple(light[own].sum(axis=0).tolist()),
                change,
                coc_scale * float(np.sqrt(12.0 * variance)),
                np.tensordot(part, shares[own], 1),
            )
        )
    return tuple(bands)
