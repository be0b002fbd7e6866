"""The lens samples of a frame: places on the lens and in the pixel, wavelengths, subsamples."""

from dataclasses import dataclass

import numpy as np

from ...sampling.chromatic import ChromaticAberration
from ...sampling.halton import halton
from ...sampling.pixel_filter import subpixel_weights
from ...sampling.rounds import FURTHER_PLACES
from ...sampling.sequence import PIXEL_BASES, lens_samples, pixel_offsets, subsample_places
from ...sampling.spectral_samples import SpectralSamples, wavelengths_for
from ...sampling.subsamples import subsample_offsets
from ...sampling.thin_lens import ThinLens


@dataclass(frozen=True, eq=False)
class FrameSamples:
    """N lens samples.

    Parameters
    ----------
    lens_positions : ndarray of shape (N, 2)
        In m.
    pixel_offsets : ndarray of shape (N, 2)
        From the pixel's centre, px.
    subpixel_weights : ndarray of shape (N, 2, subpixels)
        See `sampling.pixel_filter.subpixel_weights`.
    subsample_offsets, subsample_counts : ndarray
        See `sampling.subsamples.subsample_offsets`; in m.
    subsample_places : ndarray of shape (N, K, 2)
        From the pixel's centre to where each subsample looks, px.
    colors : SpectralSamples or None
    """

    lens_positions: np.ndarray
    pixel_offsets: np.ndarray
    subpixel_weights: np.ndarray
    subsample_offsets: np.ndarray
    subsample_counts: np.ndarray
    subsample_places: np.ndarray
    colors: SpectralSamples | None

    def arrays(self, width, height):
        """Return the fields of a `FramePlan` that these samples give, by name.

        Parameters
        ----------
        width, height : int
            Of the rendered region, in pixels.

        Returns
        -------
        dict of str to ndarray
        """
        return {
            "lens_positions": self.lens_positions,
            # A sample at +x in the pixel sees what lies to its right: the picture moves left.
            "jitter": -2.0 * self.pixel_offsets / np.array([width, height]),
            "subpixel_weights": self.subpixel_weights,
            "subsample_offsets": self.subsample_offsets,
            "subsample_counts": self.subsample_counts,
            "subsample_places": self.subsample_places,
        }


@dataclass(frozen=True, eq=False)
class SampleSource:
    """Generator of the lens samples of a frame.

    Parameters
    ----------
    lens : ThinLens or None
        None is a pinhole.
    aberration : ChromaticAberration or None
    subsamples : int
        Mean number of subsamples of each sample.
    filter_kind : str
    filter_size_px : float
    subpixels, seed : int
    progressive : bool
        The picture may be shown before it is done.
    endless : bool
        The number of samples is not known yet: the samples of a smaller number are the first ones
        of a larger, with their subsamples and weights (`sampling.rounds`).
    """

    lens: ThinLens | None
    aberration: ChromaticAberration | None
    subsamples: int
    filter_kind: str
    filter_size_px: float
    subpixels: int
    seed: int
    progressive: bool
    endless: bool

    def _colors(self, count):
        """Return the wavelengths of the samples or None, and which place on the lens each has."""
        if self.aberration is None:
            return None, np.arange(count)
        colors = wavelengths_for(self.aberration, count, self.seed, in_proportion=not self.endless)
        # Samples of several wavelengths may look from the same place.
        return colors, colors.lens_indices

    def lens_sets(self, count, sets):
        """Return several sets of places on the lens that are as even, for neighbouring pixels.

        Parameters
        ----------
        count, sets : int

        Returns
        -------
        ndarray of shape (sets, count, 2)
            In m; the first is that of `draw`.
        """
        _, taken = self._colors(count)
        different = int(taken.max()) + 1
        if self.lens is None:
            return np.zeros((sets, count, 2))
        # Rotations on the torus of one sequence, themselves evenly spread.
        shifts = halton(0, sets, PIXEL_BASES)
        found = [
            lens_samples(0, different, self.lens.iris, self.seed, shift)[taken] for shift in shifts
        ]
        return np.stack(found) * self.lens.aperture_radius

    def draw(self, count):
        """Return the first `count` samples, as `FrameSamples`."""
        colors, taken = self._colors(count)
        different = int(taken.max()) + 1
        positions, offsets, counts = self._places(different)
        pixel = pixel_offsets(
            0, different, self.filter_kind, self.filter_size_px, self.seed, self.subpixels
        )[taken]
        weights = [
            subpixel_weights(axis, self.filter_kind, self.filter_size_px, self.subpixels)
            for axis in pixel.T
        ]
        return FrameSamples(
            lens_positions=positions[taken],
            pixel_offsets=pixel,
            subpixel_weights=np.stack(weights, axis=1),
            subsample_offsets=offsets[taken],
            subsample_counts=counts[taken],
            subsample_places=subsample_places(
                counts, self.filter_kind, self.filter_size_px, self.seed
            )[taken],
            colors=colors,
        )

    def _places(self, count):
        if self.lens is None:
            return np.zeros((count, 2)), np.zeros((count, 0, 2)), np.zeros(count, int)
        further = count * self.subsamples
        first = FURTHER_PLACES if self.endless else count
        positions, others = (
            lens_samples(start, number, self.lens.iris, self.seed) * self.lens.aperture_radius
            for start, number in ((0, count), (first, further))
        )
        return positions, *subsample_offsets(positions, others, self.progressive or self.endless)
