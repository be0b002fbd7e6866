"""Subsample blur in the frame: each lens sample blurred over the part of the lens it stands for.

References
----------
Jeong, Kim and Lee, CGF 2013, section 6.
"""

from contextlib import nullcontext

import numpy as np

from ...device.targets import TargetSpec
from ...device.textures import texture_2d
from ...passes import joined_sets, pyramid, subsample
from ...sampling.sequence import SETS
from ...sampling.spectral_samples import GROUP

# Most levels of the pyramid's means: footprints wider than 64 texels are sampled too coarsely for
# means to help.
_MOST_LEVELS = 6
# Most that the sample's place in a pixel is off whole texels, in texels: below half of one, so that
# a surface in focus is not moved.
_MOST_JITTER = 0.499
# Lens samples whose movements through a real lens bound those of all, and what is added to be sure.
_TYPICAL, _SURE = 64, 1.25


class SubsampleBlur:
    """Blurs the lens samples of a frame.

    Parameters
    ----------
    plan : FramePlan
    nearest : float
        Least depth of any visible surface, m; inf where there is none.
    wavelengths : callable, optional
        From a sample to its `passes.surface.chromatic.ChromaticSample`, with chromatic aberration.
    lens : LensTables, optional
        With a real lens.
    """

    def __init__(self, plan, nearest, wavelengths=None, lens=None):
        self._plan = plan
        self._wavelengths = wavelengths
        self._lens = lens
        self._turns = np.zeros((1, 2, 2, 2))
        if lens:
            part = slice(None, None, -(-plan.samples // _TYPICAL))
            turns = plan.turns(plan.lens_positions[part], plan.lens_colors(part))
            self._turns = _SURE * turns.reshape(-1, 2, 2, 2)
        self._sweep, self._gain = plan.sweep, None
        if wavelengths:
            self._sweep, self._gain = plan.sweep_parts
        self._nearest = float(self._window_depth(max(nearest, 0.0)))
        own = self._own_places()
        # With subsamples a pixel has one texel.
        shifts = plan.subsample_places - own[:, None]
        self._offsets = texture_2d(np.concatenate([plan.subsample_offsets, shifts], axis=-1))
        taken = np.arange(shifts.shape[1]) < plan.subsample_counts[:, None]
        self._apart = np.max(np.abs(shifts), axis=1, where=taken[..., None], initial=0.0)
        if plan.subsample_sets:
            self._apart = self._apart.max(axis=0, keepdims=True)
        # Whole texels of its place make a sample another picture of the same kind.
        self._jitter = np.clip(np.rint(own) - own, -_MOST_JITTER, _MOST_JITTER)
        self._spread = np.abs(plan.subsample_offsets[plan.first :]).max(axis=(0, 1))
        blur = max(abs(self._coc(self._nearest)), abs(self._coc(1.0)))
        places = plan.samples + int(plan.subsample_counts.sum())
        if wavelengths:
            # Samples that share their place on the lens count once.
            places /= GROUP
        if plan.subsample_sets:
            # Between a pixel's own places, as if it were not joined with others, and those of all
            # sets (`SETS` squared), as if it always were.
            places *= SETS
        lens = plan.source and plan.source.lens
        area = lens.iris.shared_area if lens else np.pi
        self._cell = float(np.sqrt(area * plan.lens_extent.prod() / places))
        # Levels of means for the widest footprint of a cell of the lens.
        widest = self._cell / plan.lens_extent.max() * blur
        self._top = min(max(0, int(np.ceil(np.log2(max(widest, 1.0))))), _MOST_LEVELS)
        self._levels = max(self._top, self._levels_in_reach())
        self._block = None

    def _window_depth(self, depth):
        if np.isinf(depth):
            # No surface is visible: only the depth of the background occurs.
            return 1.0
        plan = self._plan
        clip = plan.projection @ np.array([0.0, 0.0, -depth, 1.0])
        return np.clip(clip[2] / max(clip[3], 1e-9) * 0.5 + 0.5, 0.0, 1.0)

    def _coc(self, window_depth, opening=None):
        """Return the largest movement along an axis of a depth across an opening, in texels."""
        opening = self._plan.lens_extent if opening is None else opening
        sweeps = [self._sweep]
        if self._wavelengths:
            sweeps = [
                self._sweep + self._gain * focus
                for focus in self._plan.chromatic.overall().inverse_focus
            ]
        largest = max(
            np.abs(opening * (sweep[:2] + sweep[2:] * window_depth)).max() for sweep in sweeps
        )
        turns = self._turns[:, 0] + self._turns[:, 1] * window_depth
        return largest + float((np.abs(turns) @ opening).max())

    @property
    def reach(self):
        """Largest distance from a pixel at which the sample's colours are read, in texels."""
        # Plus a texel on either side, and the texels of a mean of the top level.
        return int(np.ceil(self._farthest())) + 2 + (2 << self._top)

    def _farthest(self):
        """Return how far from a pixel its rays may begin or end at most, in texels."""
        moved = max(self._coc(depth, self._spread) for depth in (self._nearest, 1.0))
        return moved + float(self._apart.max(initial=_MOST_JITTER))

    def _levels_in_reach(self):
        """Return how many levels of depth ranges cover all texels that a pixel's ray may meet."""
        plan = self._plan
        side = min(2.0 * (self._farthest() + 1.0), max(plan.width, plan.height) * plan.subpixels)
        return int(np.ceil(np.log2(side)))

    def _own_places(self):
        """Return the places in the pixel that the samples see, from its centre, in texels."""
        plan = self._plan
        texels = np.array([plan.width, plan.height])
        # The jitter moves the picture, in clip units: the place in the pixel is opposite to it.
        return -0.5 * plan.jitter * texels

    def limit(self, earlier):
        """Use no more levels than an earlier round, whose render targets are used.

        Parameters
        ----------
        earlier : SubsampleBlur
        """
        self._top = min(self._top, earlier._top)
        self._levels = min(self._levels, earlier._levels)
        self._block = None

    def specs(self):
        """Return the render targets that it needs besides the sample's."""
        return (
            # At least one level: the shader's textures must be bound.
            TargetSpec("sample_means", "RGBA32F", max(self._top, 1), 0.5),
            TargetSpec("sample_ranges", "RG32F", max(self._levels, 1), 0.5),
            *(subsample.sorted_specs() if self._plan.subsample_sets else ()),
        )

    def add(self, fullscreen, targets, index):
        """Blur a lens sample and add it to the bound frame buffer.

        Parameters
        ----------
        fullscreen : GPUBatch
        targets : Targets
        index : int
        """
        plan = self._plan
        sample = (targets["sample"], targets["sample_depth"])
        levels = (targets["sample_means"], targets["sample_ranges"])
        pyramid.build(*sample, *levels, self._top, self._levels)
        sets = self._plan.subsample_sets
        sums = targets.framebuffer(*subsample.SORTED).bind() if sets else nullcontext()
        with sums:
            subsample.blur(
                fullscreen,
                (*sample, self._offsets, *levels),
                self._params(),
                jitter=self._jitter[index],
                apart=self._apart[index],
                weight=float(plan.subpixel_weights[index].prod()),
                index=index,
                count=int(plan.subsample_counts[index]),
                wavelength=self._wavelengths and self._wavelengths(index),
                lens=self._lens and self._lens.sample(index),
                sets=sets,
            )
        if sets:
            joined_sets.join(fullscreen, targets)

    def _params(self):
        if self._block is None:
            self._block = subsample.params(
                sweep=self._sweep,
                spread=self._spread,
                depths=(self._nearest, 1.0),
                cell=self._cell,
                top=self._top,
                levels=self._levels,
                gain=self._gain,
            )
        return self._block
