"""From a snapshot to a frame plan: every number a frame needs, chosen before anything is drawn."""

from dataclasses import replace

import numpy as np

from ...errors import FocusError
from ...sampling.pixel_filter import MOST_SUBPIXELS, filter_support
from ...sampling.rounds import first_look
from ...sampling.sequence import LATTICE_PLACES, lattice_sets, subsample_places
from ...sampling.spectral_samples import GROUP
from .bokeh_plan import plan_bokeh
from .chromatic import plan_chromatic
from .depth_planes import with_fitted_planes
from .distortion import plan_distortion
from .frame_plan import AutomaticSampling, FramePlan
from .frame_samples import SampleSource
from .layered_plan import plan_layered
from .lens_plan import plan_real_lens
from .quality import LEAST_ERROR, largest_coc, settle
from .stack_bokeh import plan_stack_bokeh

# Diagonals of the picture over the diameter of the largest circle of confusion that counts as
# sharp: the usual criterion of depth-of-field tables (0.029 mm for 36 x 24 mm).
_SHARP_CIRCLES_PER_DIAGONAL = 1500.0

# Samples whose wavelengths reach as far as those of many, for bounds.
_TYPICAL_SAMPLES = 64

# Largest raster of a lens sample, in pixels (20 bytes each), and its longest side: any device has
# room for that.
_LARGEST_RASTER = 1 << 24
_LONGEST_RASTER = 8192

# Radius of the circle of confusion below which a sample is as good as a first picture, px.
_LEAST_BLUR = 0.5


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


def subpixels(content, width, height, support=1.0):
    """Choose the sub-pixels of a lens sample's raster.

    Where triangles are smaller than pixels, one sub-pixel a pixel sees one triangle of many, and
    the average over the lens samples stays noisy. The raster is therefore made about as fine as
    the geometry, so that its cost stays in proportion to that of the triangles.

    Parameters
    ----------
    content : SceneContent
    width, height : int
        Of the rendered region, in pixels.
    support : float
        Width of the pixel filter, in pixels: sub-pixels outside of it would have no weight.

    Returns
    -------
    int
        Sub-pixels along each side of a pixel.
    """
    triangles = sum(len(content.meshes[g.mesh].triangles) * g.count for g in content.groups)
    wanted = min(int(np.ceil(np.sqrt(triangles / (width * height)))), MOST_SUBPIXELS)
    wanted = int(wanted * min(support, 1.0))
    affordable = min(
        int(np.sqrt(_LARGEST_RASTER / (width * height))), _LONGEST_RASTER // max(width, height)
    )
    return max(1, min(wanted, affordable))


def sharp_radius(width, height):
    """Return the largest radius of a circle of confusion that counts as sharp.

    A circle whose diameter is 1/1500 of the picture's diagonal, but at least one pixel, which is
    the least that a small picture can show. Focus Matte is the share of a point's light that falls
    inside that circle: 1 up to this radius, then falling with the square of the radius.

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

    The radius is that along the picture's vertical, which the anamorphic ratio does not change.

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


def plan_first_picture(snapshot):
    """Plan the first picture of a frame.

    Parameters
    ----------
    snapshot : SceneSnapshot

    Returns
    -------
    FramePlan or None
        None where nothing is blurred.
    """
    # Of the colours of chromatic aberration one sample has but one; highlights that are not split
    # off need no search.
    camera = replace(snapshot.camera, bokeh=None, chromatic=None)
    sampling = replace(
        snapshot.sampling,
        method="ADAPTIVE",
        lens_samples=1,
        subsamples=LATTICE_PLACES - 1,
        target_error=None,
        time_limit=None,
        reuse_grid=0,
        uses_levels=snapshot.sampling.uses_levels and snapshot.sampling.method == "ADAPTIVE",
        progressive=False,
    )
    plan = plan_frame(replace(snapshot, camera=camera, sampling=sampling, passes=("Combined",)))
    if not plan.blurs or largest_coc(snapshot.content, plan) < _LEAST_BLUR:
        return None
    film, lens = snapshot.film, plan.source.lens
    offsets = lattice_sets(lens.iris) * lens.aperture_radius
    counts = np.full(len(offsets), LATTICE_PLACES)
    places = subsample_places(counts, film.filter_kind, film.filter_size_px)
    return replace(plan, subsample_offsets=offsets, subsample_places=places, subsample_sets=True)


def _plan_raster(snapshot):
    snapshot = replace(
        snapshot, camera=replace(snapshot.camera, projection=with_fitted_planes(snapshot))
    )
    sampling = snapshot.sampling
    automatic = None
    if sampling.method == "ADAPTIVE" and sampling.target_error is not None:
        # Bounds over the wavelengths need several samples.
        count = 1 if snapshot.camera.chromatic is None else _TYPICAL_SAMPLES
        first = _plan(snapshot, replace(sampling, lens_samples=count, subsamples=0))
        automatic = AutomaticSampling(
            max(sampling.target_error, LEAST_ERROR),
            sampling.least_samples,
            sampling.most_samples,
            1 if first.chromatic is None else GROUP,
        )
        sampling = settle(sampling, snapshot, first)
        sampling = replace(sampling, lens_samples=first_look(automatic.unit))
    plan = _plan(snapshot, sampling, automatic)
    try:
        plan = _through_lens(snapshot, plan)
    except FocusError as error:
        name = snapshot.camera.real_lens.prescription.name
        report = (f"lens '{name}' is left out, a thin lens is drawn: {error}",)
        snapshot = replace(snapshot, camera=replace(snapshot.camera, real_lens=None))
        plan = replace(plan, report=report)
    if snapshot.stack is not None:
        return replace(plan, bokeh=plan_stack_bokeh(snapshot, plan))
    plan = replace(plan, bokeh=plan_bokeh(snapshot, plan))
    if plan.chromatic is None or "Fringe" not in snapshot.passes:
        return plan
    camera = replace(snapshot.camera, chromatic=None)
    achromatic = replace(snapshot, camera=camera, passes=("Combined",))
    plain = _through_lens(achromatic, _plan(achromatic, sampling, automatic))
    return replace(plan, plain=replace(plain, bokeh=plan_bokeh(achromatic, plain)))


def _through_lens(snapshot, plan):
    """Return a plan whose samples see through the camera's real lens, where that can be."""
    camera, lens = snapshot.camera, snapshot.camera.lens
    if lens is None or not lens.aperture_radius:
        return plan
    if camera.real_lens is None and (camera.artist is None or camera.orthographic):
        return plan
    made, report = plan_real_lens(camera, snapshot.film, lens)
    if made is None:
        return replace(plan, report=report)
    if plan.chromatic is not None and made.parts_colors:
        plan = replace(plan, chromatic=plan.chromatic.through_lens())
    return replace(plan, real_lens=made.with_samples(plan.samples), report=report)


def _plan(snapshot, sampling, automatic=None):
    film, camera = snapshot.film, snapshot.camera
    x, y, width, height = film.region
    lens = camera.lens
    adaptive = sampling.method == "ADAPTIVE"
    if lens is not None and lens.aperture_radius == 0.0:
        lens = None
    aberration = camera.chromatic
    if aberration is not None and not aberration.lateral and (lens is None or not aberration.axial):
        aberration = None
    support = filter_support(film.filter_kind, film.filter_size_px)
    source = SampleSource(
        lens=lens,
        aberration=aberration,
        subsamples=sampling.subsamples if adaptive else 0,
        filter_kind=film.filter_kind,
        filter_size_px=film.filter_size_px,
        # Subsamples and levels of detail, or finer layers, take the place of a finer raster.
        subpixels=1
        if sampling.method != "REFERENCE"
        else subpixels(snapshot.content, width, height, support),
        seed=sampling.seed,
        progressive=sampling.progressive,
        endless=automatic is not None,
    )
    drawn = source.draw(sampling.lens_samples)
    focus, extent = 1.0, np.zeros(2)
    if lens is not None:
        focus = lens.focus_distance
        extent = lens.aperture_radius * np.array([1.0 / lens.iris.ratio, 1.0])
    projection = region_projection(camera.projection, film)
    current = (camera.view, camera.projection)
    previous, following = (
        region_projection(frame_projection, film) @ frame_view
        for frame_view, frame_projection in (camera.previous or current, camera.next or current)
    )
    scale = coc_scale(camera.projection, film, camera.lens)
    colors = drawn.colors
    return FramePlan(
        width=width,
        height=height,
        origin=(x, y),
        view=camera.view,
        projection=projection,
        orthographic=camera.orthographic,
        focus_distance=focus,
        subpixels=source.subpixels,
        **drawn.arrays(width, height),
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
        source=source,
        automatic=automatic,
        time_limit=sampling.time_limit,
        shadows=sampling.shadows,
        layered=plan_layered(sampling, film, source, snapshot.stack, projection),
    )


def _empty_coc(camera, scale, focus):
    if not camera.orthographic:
        # The limit of scale (d - focus) / (d focus).
        return scale / focus
    # Unbounded for a parallel projection: empty pixels count as at the far plane.
    inverse = np.linalg.inv(camera.projection)
    far = -(inverse @ np.array([0.0, 0.0, 1.0, 1.0]))[2]
    return float(scale * (far - focus) / focus)
