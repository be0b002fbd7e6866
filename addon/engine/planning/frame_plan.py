"""The plan of a frame: every number that drawing it needs, as a frozen value."""

from dataclasses import dataclass, replace

import numpy as np

from .bokeh_plan import BokehPlan
from .chromatic import ChromaticPlan
from .distortion import DistortionPlan
from .frame_samples import SampleSource
from .layered_plan import LayeredPlan
from .lens_plan import RealLensPlan


@dataclass(frozen=True)
class AutomaticSampling:
    """Noise threshold: the number of samples is found while the frame is drawn.

    Parameters
    ----------
    error : float
        Threshold of the picture's error, 1 - SSIM.
    least, most : int
        Bounds of the number of lens samples.
    unit : int
        Samples that share a place on the lens; see `sampling.rounds`.
    """

    error: float
    least: int
    most: int
    unit: int = 1


@dataclass(frozen=True, eq=False)
class FramePlan:
    """Every number that drawing a frame needs.

    Parameters
    ----------
    width, height : int
        Of the rendered region, in pixels; with distortion those of the raster that is drawn.
    origin : tuple of 2 int
        Lower left pixel of the region in the picture.
    view : ndarray of shape (4, 4)
        World to camera space.
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the region.
    orthographic : bool
    focus_distance : float
        In m.
    lens_positions : ndarray of shape (N, 2)
        Places on the lens, in m.
    jitter : ndarray of shape (N, 2)
        Sub-pixel movement in clip units of the region.
    subpixels : int
        Sub-pixels along each side of a pixel in a lens sample's raster; see `subpixels`.
    subpixel_weights : ndarray of shape (N, 2, subpixels)
        Of the columns and rows of sub-pixels; see `sampling.pixel_filter.subpixel_weights`.
    subsample_offsets : ndarray of shape (N, K, 2)
        Subsamples: places on the lens that a sample stands for besides its own, relative to it,
        in m.
    subsample_counts : ndarray of shape (N,)
        int; number of subsamples of each sample.
    subsample_places : ndarray of shape (N, K, 2)
        From the pixel's centre to where each subsample looks in a sample's raster, px.
    subsample_sets : bool
        Of the one sample, which has no place of its own then: N are sets of places for neighbouring
        pixels, see `sampling.sequence.lattice_sets`, and K is one more than its subsamples.
    level_bias : float or None
        Subtracted from the level of detail; None draws everything at full detail.
    least_triangles : int
        No level of detail has fewer.
    reuse_grid : int
        Cells along a pixel in which samples share a drawing; 0 shares none.
    progressive : bool
        The frame may be shown or given up before all its samples are drawn.
    lens_extent : ndarray of shape (2,)
        Half the width and height of the opening, in m.
    coc_scale : float
        Factor from defocus to the radius of the circle of confusion, in pixels; see
        `engine.planning.plan.coc_scale`.
    sharp_radius : float
        Largest radius of a circle of confusion that counts as sharp, in pixels.
    empty_coc : float
        Radius of the circle of confusion where there is no surface, in pixels.
    passes : tuple of str
    alpha_threshold : float
        Opacity below which a surface is left out of the data passes.
    previous, next : ndarray of shape (4, 4)
        World to clip space of the region in the neighbouring frames.
    bokeh : BokehPlan or None
        None: highlights are sampled like all other light.
    chromatic : ChromaticPlan or None
        None: every sample represents all wavelengths.
    plain : FramePlan or None
        The same frame without chromatic aberration, for Fringe.
    distortion : DistortionPlan or None
        Mapping from the picture to the undistorted raster; None: no distortion.
    source : SampleSource or None
        Source of the lens samples.
    automatic : AutomaticSampling or None
        The plan then has the samples up to the end of a round; see `extended`.
    first : int
        First sample of the round: levels of detail and shared drawings are chosen for the samples
        from here on.
    time_limit : float or None
        Seconds of drawing after which no further samples are drawn.
    layered : LayeredPlan or None
        How samples are rays through depth layers; None: each is a drawing of the scene.
    real_lens : RealLensPlan or None
        The lens that the samples see through; None: the thin lens.
    shadows : bool
        Objects shadow one another from the lights.
    report : tuple of str
        Warnings about settings of the camera that cannot be met, one sentence each.
    """

    width: int
    height: int
    origin: tuple[int, int]
    view: np.ndarray
    projection: np.ndarray
    orthographic: bool
    focus_distance: float
    lens_positions: np.ndarray
    jitter: np.ndarray
    subpixels: int
    subpixel_weights: np.ndarray
    subsample_offsets: np.ndarray
    subsample_counts: np.ndarray
    subsample_places: np.ndarray
    level_bias: float | None
    least_triangles: int
    reuse_grid: int
    progressive: bool
    lens_extent: np.ndarray
    coc_scale: float
    sharp_radius: float
    empty_coc: float
    passes: tuple[str, ...]
    alpha_threshold: float
    previous: np.ndarray
    next: np.ndarray
    bokeh: BokehPlan | None = None
    chromatic: ChromaticPlan | None = None
    plain: "FramePlan | None" = None
    distortion: DistortionPlan | None = None
    source: SampleSource | None = None
    automatic: AutomaticSampling | None = None
    first: int = 0
    time_limit: float | None = None
    layered: LayeredPlan | None = None
    subsample_sets: bool = False
    real_lens: RealLensPlan | None = None
    shadows: bool = False
    report: tuple[str, ...] = ()

    @property
    def size(self):
        """Width and height of the picture, in pixels."""
        made = self.distortion or self
        return made.width, made.height

    @property
    def samples(self):
        """Number of lens samples."""
        return len(self.lens_positions)

    def extended(self):
        """Return the plan of the next round: twice the samples, the first half as they are.

        Returns
        -------
        FramePlan
            With `automatic` sampling; the plain frame of Fringe has a plan of its own.
        """
        drawn = self.source.draw(2 * self.samples)
        chromatic = self.chromatic
        if chromatic is not None:
            chromatic = chromatic.with_samples(self.source.aberration, drawn.colors)
        return replace(
            self,
            **drawn.arrays(self.width, self.height),
            first=self.samples,
            chromatic=chromatic,
            real_lens=self.real_lens and self.real_lens.with_samples(2 * self.samples),
        )

    def weight(self, samples):
        """Return the summed weight of the first `samples` lens samples.

        Parameters
        ----------
        samples : int

        Returns
        -------
        float or tuple of 4 float
            With chromatic aberration that of red, green, blue and alpha.
        """
        found = self.sample_weights(0, samples).sum(axis=0)
        return float(found[0]) if self.chromatic is None else tuple(found.tolist())

    def sample_weights(self, first, end):
        """Return the weights of samples `first` to `end - 1` in red, green, blue and alpha.

        Returns
        -------
        ndarray of shape (end - first, 4)
        """
        own = self.subpixel_weights[first:end].sum(axis=2).prod(axis=1)
        own = own * (1 + self.subsample_counts[first:end])
        if self.chromatic is None:
            return np.repeat(own[:, None], 4, axis=1)
        return own[:, None] * self.chromatic.weights[first:end]

    def in_round(self, sample):
        """Return the index of a sample in its round, and the number of samples of the round."""
        return sample - self.first, self.samples - self.first

    def lens_sample(self, index):
        """Return a sample's place on the lens in m and its jitter in clip units, 4 numbers."""
        return (*self.lens_positions[index].tolist(), *self.jitter[index].tolist())

    @property
    def lens_places(self):
        """Places on the lens of the samples of all sets, in m, shape (sets, N, 2)."""
        if self.layered is None:
            return self.lens_positions[None]
        return self.layered.places[: 1 if self.layered.in_step else None]

    @property
    def blurs(self):
        """Whether any lens sample is blurred over subsamples."""
        return bool(self.subsample_counts.any())

    @property
    def blur_doubt(self):
        """How far a real lens' blur may differ from the thin lens' circle of confusion, px."""
        if self.real_lens is None:
            return 0.0
        return self.real_lens.most_blurred * float(self.projection[1, 1]) * self.height / 2.0

    @property
    def sweep(self):
        """Movement of surfaces between two places on the lens; see ``lib/bokeh/sweep_lib.glsl``.

        Returns
        -------
        ndarray of shape (4,)
            In texels a metre: constant, x and y, and per unit of the depth buffer.
        """
        size = np.array([self.width, self.height]) * self.subpixels
        scale = np.diag(self.projection)[:2] * size / 2.0
        slope, offset = self.projection[2, 2:]
        focus = self.focus_distance
        if self.orthographic:
            constant, linear = (offset + 1.0) / (slope * focus) - 1.0, -2.0 / (slope * focus)
        else:
            constant, linear = 1.0 / focus - (slope - 1.0) / offset, -2.0 / offset
        return np.concatenate([scale * constant, scale * linear])

    def lens_colors(self, part):
        """Return the shares of a real lens' colours, as of `SampleTables.moves`, of samples.

        Parameters
        ----------
        part : slice
            Of the samples.
        """
        if self.chromatic is None:
            return None
        return self.real_lens.color_shares(self.chromatic.wavelengths_nm[part])

    def turns(self, lens_positions, colors=None):
        """Return what the real lens adds to `sweep` at lens samples.

        Parameters
        ----------
        lens_positions : ndarray of shape (N, 2)
            In m.
        colors : ndarray or None
            As of `SampleTables.moves`.

        Returns
        -------
        ndarray of shape (N, rows, columns, 2, 2, 2)
            At the nodes of the displacements: constant, and per unit of the depth buffer; x and y
            of the movement in texels; by x and y on the lens, m.
        """
        tables = self.real_lens.tables
        found = tables.turns(lens_positions, colors)
        slope, offset = self.projection[2, 2:]
        # 1 / depth, in units of the largest vergence, is affine in the depth buffer's value.
        first = (slope - 1.0) / offset / tables.largest_vergence
        step = 2.0 / offset / tables.largest_vergence
        parts = found[..., 0, :, :] + first * found[..., 1, :, :], step * found[..., 1, :, :]
        size = np.array([self.width, self.height]) * self.subpixels
        scale = np.diag(self.projection)[:2] * size / 2.0
        return np.stack(parts, axis=-3) * scale[:, None]

    @property
    def sweep_parts(self):
        """The `sweep` in two parts, for a focus that varies over the field.

        Returns
        -------
        base, gain : ndarray of shape (4,)
            The sweep is ``base + gain / focus_distance``.
        """
        size = np.array([self.width, self.height]) * self.subpixels
        scale = np.diag(self.projection)[:2] * size / 2.0
        slope, offset = self.projection[2, 2:]
        if self.orthographic:
            base, gain = (-1.0, 0.0), ((offset + 1.0) / slope, -2.0 / slope)
        else:
            base, gain = (-(slope - 1.0) / offset, -2.0 / offset), (1.0, 0.0)
        return tuple(np.outer(part, scale).ravel() for part in (base, gain))
