"""The plan of a frame's bokeh: where highlights are searched, how light is split and splatted.

Highlights are searched from the lens' centre in a raster with overscan: it reaches beyond the frame
as far as discs from there reach into it. Its pixels are those of the picture, divided into
sub-pixels so that small emitters are not missed.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...lens_bokeh.samples.artist_rays import ArtistRays
from ...lens_bokeh.samples.cylinder_rays import CylinderRays
from ...levels.choosing import coc_radius, extents
from ...sampling.highlights import contrast, highlight_share, least_coc
from ...sampling.iris import Iris
from ...sampling.pixel_filter import filter_density
from ...snapshot.brightness import brightest, mirrors, reflects
from ...snapshot.camera import BokehSettings, LensSettings
from .bokeh_colors import BokehColors, colors_of_frame
from .bokeh_search import (
    LEAST_SUBPIXELS,
    corners_of,
    deep_projection,
    emitting,
    glinting,
    graph_of,
    part_of,
    rectangles_of,
    rows_of,
    subpixels_of_lamps,
    subpixels_of_mirrors,
    subpixels_of_triangles,
    uneven_groups,
)
from .lens_plan import artist_rays
from .seen_from_edge import seen_from_edge

# Depth that represents infinity, in focus distances: the circle of confusion differs by 1e-6.
INFINITY = 1e6
# Least margin around the frame, px, for the edges of discs just outside.
_RIM = 2
# Limits of drafts: layers of highlights, and sub-pixels of the raster.
_DRAFT_LAYERS = 2
_DRAFT_RASTER = 1 << 20


@dataclass(frozen=True, eq=False)
class BokehPlan:
    """Parameters of the search for a frame's highlights, and of their discs.

    Parameters
    ----------
    settings : BokehSettings
    shining : frozenset of (int, int)
        Group and slot of the surfaces that may be brighter than the threshold and are splatted.
    mirroring : frozenset of (int, int)
        Those of them whose reflections depend on the place on the lens.
    uneven : frozenset of int
        Groups with shining surfaces whose light varies over the surface.
    reflecting, glinting : frozenset of (int, int)
        Shining surfaces that have no light of their own, and those of them whose reflections of
        lamps may be smaller than a pixel.
    unsplit : frozenset of (int, int)
        Group and slot of bright surfaces whose light the lens samples keep: the lens' middle, from
        where highlights are searched, sees them from the edge.
    least_coc : float
        Radius of the circle of confusion from which on light is splatted, px.
    width, height : int
        Size of the peeled raster in pixels of the picture.
    margin : tuple of 2 int
        Overscan on the left and below, px; the same on the other sides.
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the peeled raster.
    subpixels : int
        Along each side of a pixel of the peeled raster.
    small_mirrors : int
        As `subpixels`, for the sake of small mirroring objects and small glints.
    part : tuple of 4 int
        x, y, width and height of the part of the raster that holds all shining surfaces that do
        not mirror, px.
    world : bool
        The world's image may give highlights.
    world_share : float
        Share of its light above the threshold that is splatted.
    world_depth : float
        Depth that represents infinity, m.
    iris : Iris
        The lens' opening.
    real_lens : LensSettings or None
        The traced lens that shapes the discs; None: the thin lens.
    filter_width : float
        Side of the box with the variance of the pixel filter, px.
    search_projections : tuple of 2 ndarray of shape (4, 4), optional
        As `projection`, for the search of surfaces that do not mirror and of those that do; see
        `bokeh_search.deep_projection`. None: highlights are those of captured layers.
    colors : BokehColors or None
        None: one disc for all wavelengths.
    draft : bool
        A draft with bounded work, for a moving view; see `drafted`.
    artist : ArtistRays or None
        The artist's lens that shapes the discs.
    cylinders : CylinderRays or None
        The rays of a lens with cylinders, which shapes them.
    contrast : float
        Of an automatic threshold: see `sampling.highlights.contrast`; 0 where it is not.
    """

    settings: BokehSettings
    shining: frozenset[tuple[int, int]]
    mirroring: frozenset[tuple[int, int]]
    uneven: frozenset[int]
    unsplit: frozenset[tuple[int, int]]
    least_coc: float
    width: int
    height: int
    margin: tuple[int, int]
    projection: np.ndarray
    subpixels: int
    small_mirrors: int
    part: tuple[int, int, int, int]
    world: bool
    world_share: float
    world_depth: float
    iris: Iris
    real_lens: LensSettings | None
    filter_width: float
    search_projections: tuple[np.ndarray, np.ndarray] | None = None
    colors: BokehColors | None = None
    draft: bool = False
    artist: ArtistRays | None = None
    reflecting: frozenset[tuple[int, int]] = frozenset()
    glinting: frozenset[tuple[int, int]] = frozenset()
    cylinders: CylinderRays | None = None
    contrast: float = 0.0

    @property
    def lens_views(self):
        """Places on the lens from which mirroring surfaces are searched.

        Returns
        -------
        ndarray of shape (n^2, 2)
            In units of half the opening, row by row: the centres of n x n regions; one place where
            no surface mirrors.
        """
        side = _views_across(self.settings) if self.mirroring else 1
        axis = (2.0 * np.arange(side) + 1.0) / side - 1.0
        return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)

    @property
    def mirroring_subpixels(self):
        """As `subpixels`, for mirroring surfaces: all views together have as many as one."""
        if self.draft:
            return 1
        least = LEAST_SUBPIXELS // int(np.sqrt(len(self.lens_views)))
        return max(1, least, self.small_mirrors)

    @property
    def world_subpixels(self):
        """As `subpixels`, for the world, whose image has no detail finer than its own pixels."""
        return 1 if self.draft else LEAST_SUBPIXELS

    @property
    def whole(self):
        """The whole peeled raster as a `part`: x, y, width and height."""
        return (0, 0, self.width, self.height)

    @property
    def layers(self):
        """Most highlights behind one another that are found, without the world's."""
        return self.settings.layers

    def drafted(self):
        """Return the plan of a draft: few sources, few layers, coarse masks.

        Light is split between splats and lens samples in the same way, so that the same samples fit
        to both.

        Returns
        -------
        BokehPlan
        """
        settings = self.settings
        _, _, width, height = self.part
        affordable = int(np.sqrt(_DRAFT_RASTER / max(width * height, 1)))
        return replace(
            self,
            settings=replace(
                settings,
                model="CLUSTERED",
                similarity=max(settings.similarity, 1.0),
                global_merge=False,
                visibility="WARP",
                layers=min(settings.layers, _DRAFT_LAYERS),
                lens_views=1,
            ),
            subpixels=max(1, min(self.subpixels, LEAST_SUBPIXELS, affordable)),
            colors=self.colors and self.colors.draft(),
            draft=True,
        )


def plan_bokeh(snapshot, plan):
    """Plan the highlights of a frame.

    Parameters
    ----------
    snapshot : SceneSnapshot
    plan : FramePlan
        Without `bokeh`.

    Returns
    -------
    BokehPlan or None
        None where nothing is splatted: bokeh is off, everything is sharp, or lens samples see
        through a lens that shapes no discs.
    """
    settings, lens = snapshot.camera.bokeh, snapshot.camera.lens
    sampling = snapshot.sampling
    wanted = sampling.method != "REFERENCE" or sampling.reference_bokeh
    if settings is None or lens is None or plan.coc_scale == 0.0 or not wanted:
        return None
    camera = snapshot.camera
    shaping = shaping_lens(camera) or shaping_artist(camera) or shaping_cylinders(plan)
    if plan.real_lens and not shaping:
        # No discs are traced for it, and those of a thin lens would not be where the samples are.
        return None
    least = least_splatted(plan)
    bright = _shining(snapshot.content, settings.least_threshold)
    unsplit = seen_from_edge(snapshot.content, bright, plan)
    shining = bright - unsplit
    rows, _ = rows_of(snapshot.content, shining)
    seen = extents(corners_of(snapshot.content, rows), plan.view)
    farthest = float(seen.farthest.max(initial=plan.focus_distance))
    colors = colors_of_frame(snapshot.camera.chromatic, plan, farthest)
    largest = _largest_coc(snapshot.content, plan, seen, colors)
    if largest <= least:
        return None
    margin = _margin(plan, snapshot.film, settings, largest, colors)
    width, height = plan.width + 2 * margin[0], plan.height + 2 * margin[1]
    # With a parallel projection, all pixels show the same point at infinity: no highlight.
    world = settings.world and bool(snapshot.content.world.image)
    world = world and not snapshot.film.transparent
    world = world and not plan.orthographic
    film = snapshot.film
    projection = np.diag([plan.width / width, plan.height / height, 1.0, 1.0]) @ plan.projection
    mirroring = _mirroring(snapshot.content, shining)
    size = (width, height)

    def seen_in_raster(keys):
        rows, _ = rows_of(snapshot.content, keys)
        return rectangles_of(snapshot.content, rows, plan, projection, size)

    def deep(keys):
        rows, _ = rows_of(snapshot.content, keys)
        return deep_projection(snapshot.content, rows, plan, projection)

    steady = seen_in_raster(shining - mirroring)
    part = part_of(steady)
    rows, of_group = rows_of(snapshot.content, emitting(snapshot.content, shining))
    return BokehPlan(
        settings=settings,
        shining=shining,
        mirroring=mirroring,
        uneven=uneven_groups(snapshot.content, shining),
        reflecting=frozenset(k for k in shining if reflects(graph_of(snapshot.content, k))),
        glinting=glinting(snapshot.content, mirroring),
        unsplit=unsplit,
        least_coc=least,
        width=width,
        height=height,
        margin=margin,
        projection=projection,
        search_projections=(deep(shining - mirroring), deep(mirroring)),
        subpixels=max(
            subpixels_of_triangles(snapshot.content, plan, rows, of_group, size),
            subpixels_of_lamps(steady, part),
        ),
        small_mirrors=subpixels_of_mirrors(
            snapshot.content,
            mirroring,
            seen_in_raster(mirroring),
            size,
            _views_across(settings) ** 2,
        ),
        part=part,
        world=world,
        world_share=float(highlight_share(plan.empty_coc, least)) if world else 0.0,
        world_depth=INFINITY * max(plan.focus_distance, 1.0),
        iris=lens.iris,
        real_lens=shaping_lens(snapshot.camera),
        filter_width=filter_width(film.filter_kind, film.filter_size_px),
        colors=colors,
        artist=shaping_artist(snapshot.camera),
        cylinders=shaping_cylinders(plan),
        contrast=contrast_of(settings, plan),
    )


def least_splatted(plan):
    """Return the radius of the circle of confusion from which on a frame splats light, px."""
    return least_coc(_samples_of_one(plan))


def contrast_of(settings, plan):
    """Return the `BokehPlan.contrast` of a frame."""
    return contrast(_samples_of_one(plan)) if settings.automatic else 0.0


def _samples_of_one(plan):
    return plan.samples / (plan.chromatic.samples_for_one if plan.chromatic else 1.0)


def shaping_lens(camera):
    """Return the traced lens that shapes a camera's discs, as `LensSettings`, or None."""
    lens = camera.real_lens
    return lens if lens and lens.shapes_bokeh and not camera.orthographic else None


def shaping_cylinders(plan):
    """Return the rays of a lens with cylinders that shapes a frame's discs, or None."""
    if plan.real_lens is None or plan.orthographic:
        return None
    return plan.real_lens.cylinders


def shaping_artist(camera):
    """Return the artist's lens that shapes a camera's discs, as `ArtistRays`, or None."""
    if camera.real_lens is not None or camera.artist is None or camera.orthographic:
        return None
    return artist_rays(camera)


def _views_across(settings):
    return max(1, int(np.sqrt(settings.lens_views)))


def _shining(content, threshold):
    """Return the surfaces that may be brighter than the threshold: (group, slot)."""
    return frozenset(
        (number, slot)
        for number, (group, bounds) in enumerate(
            zip(content.groups, brightest(content), strict=True)
        )
        for (slot, _, _), bound in zip(content.meshes[group.mesh].slots, bounds, strict=True)
        if bound > threshold
        and content.materials[group.materials[slot]].highlights
        and not group.holdout
    )


def _mirroring(content, shining):
    """Return the surfaces whose reflections depend on the place on the lens."""
    return frozenset(key for key in shining if mirrors(graph_of(content, key)))


def _largest_coc(content, plan, seen, colors):
    changes = (0.0,) if colors is None else colors.focus_changes[:2]
    largest = 0.0
    if content.world.image:
        largest = max(abs(plan.empty_coc + plan.coc_scale * change) for change in changes)
    front = seen.farthest > 0.0
    near = np.maximum(seen.nearest[front], 1e-3 * plan.focus_distance)
    for depth in (near, seen.farthest[front]):
        coc = coc_radius(depth, plan)
        for change in changes:
            moved = coc + plan.coc_scale * change * (depth if plan.orthographic else 1.0)
            largest = max(largest, float(np.abs(moved).max(initial=0.0)))
    return largest


def _margin(plan, film, settings, largest, colors):
    narrowing = plan.lens_extent / plan.lens_extent[1]
    # Of the whole picture: a part of it is no place where less is searched.
    side = max(film.width, film.height)
    limit = settings.overscan * side
    # A lateral scale below 1 moves discs inwards: search farther out.
    moved = colors.growth * side if colors else 0.0
    return tuple(int(np.ceil(min(largest * n + moved, limit))) + _RIM for n in narrowing)


def filter_width(kind, size_px):
    """Return the width, px, of the box with the variance of a pixel filter along an axis."""
    reach = 2.0 * size_px
    places = (np.arange(1024) + 0.5) / 1024 * 2.0 * reach - reach
    density = filter_density(places, kind, size_px)
    return float(np.sqrt(12.0 * (density * places**2).sum() / density.sum()))
