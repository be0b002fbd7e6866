"""From a snapshot to a frame plan: every number a frame needs, decided before anything is drawn."""

from dataclasses import dataclass, replace

import numpy as np

from ..sampling.pixel_filter import subpixel_weights
from ..sampling.sequence import lens_samples, pixel_offsets
from ..sampling.spectral_samples import wavelengths_for
from ..sampling.subsamples import subsample_offsets
from .bokeh_plan import BokehPlan, plan_bokeh
from .chromatic import ChromaticPlan, plan_chromatic
from .distortion import DistortionPlan, plan_distortion
from .quality import settle

# Diagonals of the picture over the diameter of the largest circle of confusion that counts as
# sharp: the usual criterion of depth-of-field tables (0.029 mm for 36 x 24 mm).
_SHARP_CIRCLES_PER_DIAGONAL = 1500.0

# Their wavelengths reach as far as those of many.
_TYPICAL_SAMPLES = 64

# Sub-pixels along a side of a pixel: as many as two vectors of weights hold.
_MOST_SUBPIXELS = 4
# A lens sample's raster, in pixels (20 bytes each), and its longer side: within any device's means.
_LARGEST_RASTER = 1 << 24
_LONGEST_RASTER = 8192


@dataclass(frozen=True, eq=False)
class FramePlan:
    """What the pipeline carries out.

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
        Places on the lens that a sample stands for besides its own, relative to it, in m.
    subsample_counts : ndarray of shape (N,)
        int; how many of them each sample has.
    level_bias : float or None
        Subtracted from the level of detail; None draws everything in full detail.
    least_triangles : int
        No level of detail has fewer.
    reuse_grid : int
        Cells along a pixel in which samples share a drawing; 0 shares none.
    progressive : bool
        The frame may be given up before all its samples are drawn.
    lens_extent : ndarray of shape (2,)
        Half the width and height of the opening, in m.
    coc_scale : float
        Radius of the circle of confusion in pixels, for `lib/lens_lib.glsl`.
    sharp_radius : float
        Largest radius that counts as sharp, in pixels; see `sharp_radius`.
    empty_coc : float
        Radius of the circle of confusion where nothing is, in pixels.
    passes : tuple of str
    alpha_threshold : float
        Opacity below which a surface is left out of the data passes.
    previous, next : ndarray of shape (4, 4)
        World to clip space of the region in the neighbouring frames.
    bokeh : BokehPlan or None
        None draws highlights as everything else.
    chromatic : ChromaticPlan or None
        None: every sample stands for all wavelengths.
    plain : FramePlan or None
        The same frame without chromatic aberration, where Fringe needs it.
    distortion : DistortionPlan or None
        How the picture is made of the raster that is drawn; None: it is that raster.
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

    @property
    def size(self):
        """Width and height of the picture, in pixels."""
        made = self.distortion or self
        return made.width, made.height

    @property
    def samples(self):
        """Number of lens samples."""
        return len(self.lens_positions)

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
        own = self.subpixel_weights[:samples].sum(axis=2).prod(axis=1)
        own = own * (1 + self.subsample_counts[:samples])
        if self.chromatic is None:
            return float(own.sum())
        return tuple((own @ self.chromatic.weights[:samples]).tolist())

    def lens_sample(self, index):
        """Return a sample's place on the lens in m and its jitter in clip units, 4 numbers."""
        return (*self.lens_positions[index].tolist(), *self.jitter[index].tolist())

    @property
    def blurs(self):
        """Whether any lens sample is blurred over subsamples."""
        return bool(self.subsample_counts.any())

    @property
    def sweep(self):
        """How far surfaces move between two places on the lens; see ``lib/sweep_lib.glsl``.

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


def region_projection(projection, film):
    """Restrict a projection to the rendered region of the film.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the whole picture.
    film : Film

    Returns
    -------
    ndarray of shape (4, 4)
    """
    x, y, width, height = film.region
    crop = np.eye(4)
    crop[0, 0] = film.width / width
    crop[1, 1] = film.height / height
    crop[0, 3] = (film.width - 2 * x - width) / width
    crop[1, 3] = (film.height - 2 * y - height) / height
    return crop @ projection


def subpixels(content, width, height):
    """Choose how finely a lens sample is rasterised.

    Where triangles are smaller than pixels, one place a pixel sees one triangle of many, and the
    average over the lens samples stays noisy. The raster is therefore made about as fine as the
    geometry, so that its cost stays in proportion to that of the triangles.

    Parameters
    ----------
    content : SceneContent
    width, height : int
        Of the rendered region, in pixels.

    Returns
    -------
    int
        Sub-pixels along each side of a pixel.
    """
    triangles = sum(len(content.meshes[g.mesh].triangles) * g.count for g in content.groups)
    wanted = min(int(np.ceil(np.sqrt(triangles / (width * height)))), _MOST_SUBPIXELS)
    affordable = min(
        int(np.sqrt(_LARGEST_RASTER / (width * height))), _LONGEST_RASTER // max(width, height)
    )
    return max(1, min(wanted, affordable))


def sharp_radius(width, height):
    """Return the largest radius of a circle of confusion that counts as sharp.

    A circle whose diameter is 1/1500 of the picture's diagonal, but at least one pixel, so that the
    matte of a small picture is not decided by less than it can show. Focus Matte is the share of a
    point's light that falls inside that circle: 1 up to this radius, then falling with its square.

    Parameters
    ----------
    width, height : int
        Of the whole picture, in pixels.

    Returns
    -------
    float
        In pixels.
    """
    return 0.5 * max(1.0, float(np.hypot(width, height)) / _SHARP_CIRCLES_PER_DIAGONAL)


def coc_scale(projection, film, lens):
    """Return the factor from defocus to pixels of the circle of confusion.

    The radius is that along the picture's vertical, which an anamorphic iris leaves alone.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the whole picture.
    film : Film
    lens : ThinLens or None

    Returns
    -------
    float
        In pixels times the unit of the depth for a perspective camera (aperture radius times focal
        length in pixels), in pixels for an orthographic one.
    """
    if lens is None:
        return 0.0
    return float(lens.aperture_radius * projection[1, 1] * film.height / 2.0)


def plan_frame(snapshot):
    """Plan a frame.

    Parameters
    ----------
    snapshot : SceneSnapshot

    Returns
    -------
    FramePlan
    """
    distortion, drawn = plan_distortion(snapshot)
    plan = _plan_raster(drawn)
    if distortion is None:
        return plan
    film = snapshot.film
    sharp = sharp_radius(film.width, film.height) * distortion.fineness
    bent = {"distortion": distortion, "sharp_radius": sharp}
    return replace(plan, plain=plan.plain and replace(plan.plain, **bent), **bent)


def _plan_raster(snapshot):
    sampling = snapshot.sampling
    if sampling.method == "ADAPTIVE" and sampling.target_error is not None:
        # Of wavelengths, several tell how far they reach.
        count = 1 if snapshot.camera.chromatic is None else _TYPICAL_SAMPLES
        first = _plan(snapshot, replace(sampling, lens_samples=count, subsamples=0))
        sampling = settle(sampling, snapshot, first)
    plan = _plan(snapshot, sampling)
    plan = replace(plan, bokeh=plan_bokeh(snapshot, plan))
    if plan.chromatic is None or "Fringe" not in snapshot.passes:
        return plan
    camera = replace(snapshot.camera, chromatic=None)
    achromatic = replace(snapshot, camera=camera, passes=("Combined",))
    plain = _plan(achromatic, sampling)
    return replace(plan, plain=replace(plain, bokeh=plan_bokeh(achromatic, plain)))


def _plan(snapshot, sampling):
    film, camera = snapshot.film, snapshot.camera
    x, y, width, height = film.region
    count = sampling.lens_samples
    lens = camera.lens
    adaptive = sampling.method == "ADAPTIVE"
    is_pinhole = lens is None or lens.aperture_radius == 0.0
    aberration = camera.chromatic
    if aberration is not None and not aberration.lateral and (is_pinhole or not aberration.axial):
        aberration = None
    colors = wavelengths_for(aberration, count, sampling.seed) if aberration else None
    # Samples of several wavelengths may look from the same place.
    taken = colors.lens_indices if aberration else np.arange(count)
    different = int(taken.max()) + 1
    if is_pinhole:
        positions, focus, extent = np.zeros((count, 2)), 1.0, np.zeros(2)
        offsets_on_lens, places = np.zeros((count, 0, 2)), np.zeros(count, int)
    else:
        subsamples = sampling.subsamples if adaptive else 0
        points = lens_samples(0, different * (1 + subsamples), lens.iris, sampling.seed)
        points = points * lens.aperture_radius
        focus = lens.focus_distance
        offsets_on_lens, places = subsample_offsets(
            points[:different], points[different:], sampling.progressive
        )
        positions = points[taken]
        offsets_on_lens, places = offsets_on_lens[taken], places[taken]
        extent = lens.aperture_radius * np.array([1.0 / lens.iris.ratio, 1.0])
    # Subsamples and levels of detail take the place of a finer raster.
    fine = 1 if adaptive else subpixels(snapshot.content, width, height)
    filter_kind, filter_size = film.filter_kind, film.filter_size_px
    offsets = pixel_offsets(0, different, filter_kind, filter_size, sampling.seed, fine)[taken]
    weights = [subpixel_weights(axis, filter_kind, filter_size, fine) for axis in offsets.T]
    projection = region_projection(camera.projection, film)
    current = (camera.view, camera.projection)
    previous, following = (
        region_projection(frame_projection, film) @ frame_view
        for frame_view, frame_projection in (camera.previous or current, camera.next or current)
    )
    scale = coc_scale(camera.projection, film, lens)
    return FramePlan(
        width=width,
        height=height,
        origin=(x, y),
        view=camera.view,
        projection=projection,
        orthographic=camera.orthographic,
        focus_distance=focus,
        lens_positions=positions,
        # A sample at +x in the pixel sees what lies to its right: the picture moves to the left.
        jitter=-2.0 * offsets / np.array([width, height]),
        subpixels=fine,
        subpixel_weights=np.stack(weights, axis=1),
        subsample_offsets=offsets_on_lens,
        subsample_counts=places,
        level_bias=sampling.level_bias if adaptive and sampling.uses_levels else None,
        least_triangles=sampling.least_triangles,
        reuse_grid=sampling.reuse_grid if adaptive else 0,
        progressive=sampling.progressive,
        lens_extent=extent,
        coc_scale=scale,
        sharp_radius=sharp_radius(film.width, film.height),
        empty_coc=_empty_coc(camera, scale, focus),
        passes=snapshot.passes,
        alpha_threshold=snapshot.alpha_threshold,
        previous=previous,
        next=following,
        chromatic=plan_chromatic(aberration, colors, camera, film, focus) if aberration else None,
    )


def _empty_coc(camera, scale, focus):
    if not camera.orthographic:
        # The limit of scale (d - focus) / (d focus).
        return scale / focus
    # It grows without bound with the depth; what is not there is taken to be at the far plane.
    inverse = np.linalg.inv(camera.projection)
    far = -(inverse @ np.array([0.0, 0.0, 1.0, 1.0]))[2]
    return float(scale * (far - focus) / focus)
