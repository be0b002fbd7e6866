"""From which places on the lens each highlight of a frame is seen (methods 10, 11).

Tests sort out what needs no mask. What is left gets a mask over the lens in an atlas, drawn by
projecting the scene (RASTER) or by rays through the peeled layers (WARP), or is left to rays that
the splat casts pixel by pixel (SPLAT). AUTO compares the work of the first two by counts: triangles
of the pairs of highlight and cluster against steps of the rays; where highlights are very many, it
takes the layers, without asking for triangles.

Masks have about a texel for each pixel of the disc. There is room for a number of texels that does
not depend on the number of highlights: where they are many, their masks are smaller, so that the
cost of the masks stays within bounds.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..device import geometry, readback
from ..device.targets import Targets, TargetSpec
from ..device.uniforms import uniform_buffer
from ..passes import bokeh_culling, peel, surface, surface_code, visibility_raster, visibility_warp
from ..passes.highlights import COLUMNS
from .occluders import CLUSTER, Occluders, Part

# Steps of a ray that take as long as a triangle of a cluster: 120 to 130 ns against 7 to 8 on
# software OpenGL.
STEPS_PER_TRIANGLE = 16
# Texels of the atlas, at most, also where sources are very many, and its longer side.
_LARGEST_ATLAS = 1 << 25
_ATLAS_OF_MANY = 1 << 23
_LONGEST_ATLAS = 16384
# Cells of the N-buffers over the peeled raster.
_MOST_CELLS = 1 << 18
# Pairs that are drawn at once.
_WINDOW = 1 << 20
# Surfaces so close before a source that the lens' rim sees them moved by less, in pixels, do not
# part the lens into places that see it and places that do not.
_SAME_VIEW = 0.25
# The square root of 3: the spline that masks are read with then blurs as a pixel does.
_MASK_TEXELS_PER_PIXEL = 1.73
# Of the layers, along a side of a pixel: coarser ones miss what is thin. And of all their texels.
_TEXELS_PER_PIXEL = 3
_LARGEST_RASTER = 1 << 23

# More sources are left to the layers alone, which cost the less a source the smaller the masks are.
_MOST_CONES = 1 << 15
# Of drafts: layers, and texels of the atlas.
_DRAFT_LAYERS = 2
_DRAFT_ATLAS = 1 << 19

MASKED, IN_SPLAT = 2, 3


@dataclass
class VisibilityCounts:
    """What the tests found.

    Attributes
    ----------
    outside, hidden, visible, free, masked : int
        Sources whose disc is outside the frame; that nothing of the lens sees; that no surface of
        the layers lies before; that have no triangles in their cone; that are left.
    pairs, surface_pairs : int
        Of source and cluster of opaque triangles, of source and instance that lets light through.
    work : int
        Steps of rays that masks by WARP take.
    texels : int
        Of all masks.
    method : str
        RASTER, WARP or SPLAT; empty if no source is left.
    """

    outside: int = 0
    hidden: int = 0
    visible: int = 0
    free: int = 0
    masked: int = 0
    pairs: int = 0
    surface_pairs: int = 0
    work: int = 0
    texels: int = 0
    method: str = ""

    @property
    def triangles(self):
        """Triangles that masks by RASTER take, without surfaces that let light through."""
        return self.pairs * CLUSTER


class SceneOccluders:
    """What of a scene can hide a highlight.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
        Updated to it.

    Attributes
    ----------
    groups : tuple of passes.bokeh_culling.GroupRange
        Groups of instances with a surface that lets light through.
    """

    def __init__(self, content, buffers):
        self._content = content
        self._buffers = buffers
        self._groups = [group for group in content.groups if any(self._see_through(group).values())]
        self.groups = tuple(
            bokeh_culling.GroupRange(
                group.first, group.first + group.count - 1, content.meshes[group.mesh].bounds
            )
            for group in self._groups
        )

    def _see_through(self, group):
        """Return which slots of a group's mesh let light through, dict of slot to bool."""
        mesh = self._content.meshes[group.mesh]
        return {
            slot: not group.holdout
            and surface_code.generate(
                self._content.materials[group.materials[slot]].graph, mesh.attributes
            ).transparent
            for slot, _, _ in mesh.slots
        }

    @cached_property
    def opaque(self):
        """The opaque triangles, as `Occluders`."""
        cache, parts, same = self._buffers.shapes, [], {}
        for group in self._content.groups:
            meshes = self._buffers.level_meshes(self._content.meshes[group.mesh])
            for slot, see_through in self._see_through(group).items():
                if see_through:
                    continue
                key = (group.mesh, slot)
                if key not in same:
                    shapes = [cache.shape(mesh, slot) for mesh in meshes]
                    # A level may lack a slot that has only few triangles.
                    same[key] = tuple(s for s in shapes if s is not None)
                if same[key]:
                    parts.append(Part(group.first, group.count, same[key]))
        return Occluders(parts, self._content.instances.world)

    @cached_property
    def _draws(self):
        draws = surface.build_draws(self._content, self._buffers, visibility_raster.TARGET)
        return [draw for draw in draws if draw.level == 0 and draw.constants is not None]

    def draws_of(self, number):
        """Return the draws of surfaces of a group that let light through."""
        group = self._content.groups.index(self._groups[number])
        return [draw for draw in self._draws if draw.group == group]


@dataclass(frozen=True, eq=False)
class Visibility:
    """What the splat reads.

    Parameters
    ----------
    tiles : GPUTexture
        A texel for each source: place and side of its mask, kind (see lib/visibility_lib.glsl).
    masks : GPUTexture
        The atlas.
    layers, opacity, states : GPUTexture
        The peeled layers, and how far each source's rays go, for rays that the splat casts.
    parameters : GPUUniformBuf
        `VisibilityParams`.
    counts : VisibilityCounts
    bytes : int
        Of its textures.
    """

    tiles: object
    masks: object
    layers: object
    opacity: object
    states: object
    parameters: object
    counts: VisibilityCounts
    bytes: int


def visibility_params(plan, fine=1, reach=1.0):
    """Return the values of `VisibilityParams` for a frame.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    fine : int
        Texels of the layers along a side of a pixel.
    reach : float
        How far a disc reaches in units of its radius.

    Returns
    -------
    dict of str to sequence of float or ndarray
    """
    bokeh = plan.bokeh
    projection = bokeh.projection
    raster = np.array([bokeh.width, bokeh.height]) * fine
    slope, offset = projection[2, 2:]
    focus = plan.focus_distance
    if plan.orthographic:
        start = (1.0 + offset) / slope
        depth = (0.5 + 0.5 * offset, -0.5 * slope)
        rate = -2.0 / (slope * focus)
    else:
        start = offset / (slope - 1.0)
        depth = (0.5 - 0.5 * slope, 0.5 * offset)
        rate = -2.0 / offset
    sweep = np.diag(projection)[:2] * raster / 2.0 * rate
    return {
        "view": plan.view,
        "projection": projection,
        "lens": (focus, float(plan.orthographic), plan.coc_scale, bokeh.iris.ratio),
        "opening": (*plan.lens_extent, start, reach),
        "raster": (*raster, fine, _SAME_VIEW),
        "frame": (*bokeh.margin, plan.width, plan.height),
        "sweep": (*sweep, *depth),
        "tiles": (
            bokeh_culling.SIZES,
            bokeh_culling.LEAST_SIDE,
            _MASK_TEXELS_PER_PIXEL,
            _reaching_depth(plan),
        ),
        "colors": _colors(bokeh.colors, focus),
    }


def _colors(colors, focus_distance):
    if colors is None:
        return (0.0, 0.0, 0.0, focus_distance)
    return (*colors.focus_changes[:2], colors.growth, colors.focus_distance)


def _texels_per_pixel(bokeh):
    if bokeh.draft:
        return 1
    affordable = int(np.sqrt(_LARGEST_RASTER / (bokeh.width * bokeh.height)))
    longest = _LONGEST_ATLAS // max(bokeh.width, bokeh.height)
    return max(1, min(_TEXELS_PER_PIXEL, affordable, longest))


def _reaching_depth(plan):
    """Return up to which depth discs are wider than what the raster has around the frame, m.

    A surface outside the raster that is farther away, but nearer than a highlight whose own disc is
    not, is seen at no pixel of the frame: it hides nothing of what the frame shows.
    """
    margin = min(plan.bokeh.margin)
    colors = plan.bokeh.colors
    if colors is not None:
        # The wavelength that is blurred most, moved to the frame by the lateral scale.
        margin -= colors.growth * max(plan.bokeh.width, plan.bokeh.height)
        focus = 1.0 / plan.focus_distance + colors.focus_changes[0]
        away = margin / plan.coc_scale
        # Beyond any highlight where even that does not hide it.
        reach = (1.0 - away) / focus if plan.orthographic else 1.0 / max(focus + away, 1e-9)
        return max(reach, 0.0)
    if plan.orthographic:
        return max(plan.focus_distance * (1.0 - margin / plan.coc_scale), 0.0)
    return 1.0 / (1.0 / plan.focus_distance + margin / plan.coc_scale)


@dataclass(frozen=True, eq=False)
class AtlasLayout:
    """Where the masks of each size lie.

    Parameters
    ----------
    width, height : int
        Of the atlas, texels.
    sizes : ndarray of shape (SIZES, 4)
        Of each size: masks of other sizes before, height of the first row, side, masks a row.
    """

    width: int
    height: int
    sizes: np.ndarray


def lay_out(numbers, most_texels=_LARGEST_ATLAS):
    """Lay out an atlas; where the masks are too many, larger ones are made smaller.

    Parameters
    ----------
    numbers : sequence of int
        Masks of each size.
    most_texels : int

    Returns
    -------
    AtlasLayout
    """
    numbers = np.asarray(numbers, np.int64)
    sides = bokeh_culling.LEAST_SIDE << np.arange(len(numbers))
    largest = sides[-1]
    while (numbers * sides**2).sum() > most_texels and largest > bokeh_culling.LEAST_SIDE // 4:
        largest //= 2
        sides = np.minimum(sides, largest)
    texels = max(int((numbers * sides**2).sum()), 1)
    widest = int(sides[numbers > 0].max(initial=bokeh_culling.LEAST_SIDE))
    width = min(max(1 << int(np.ceil(np.log2(texels) / 2)), widest), _LONGEST_ATLAS)
    layout = np.zeros((len(numbers), 4))
    height = 0
    for size, (number, side) in enumerate(zip(numbers, sides, strict=True)):
        each = max(width // side, 1)
        layout[size] = numbers[:size].sum(), height, side, each
        height += -(-number // each) * side
    return AtlasLayout(width, max(int(height), 1), layout)


class BokehVisibility:
    """Finds what hides the highlights of a frame.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    occluders : SceneOccluders
    buffers : SceneBuffers
    reach : float
        How far a disc reaches in units of its radius.
    """

    def __init__(self, plan, occluders, buffers, reach=1.0):
        self._plan = plan
        self._occluders = occluders
        self._buffers = buffers
        self._fine = _texels_per_pixel(plan.bokeh)
        self._values = visibility_params(plan, self._fine, reach)
        self._parameters = uniform_buffer(bokeh_culling.VISIBILITY_PARAMS.pack(**self._values))

    def find(self, sources, count, drawing, targets, method=None, culls=True):
        """Test the sources and make the masks of those that need one.

        Parameters
        ----------
        sources : GPUTexture
            First texture of the list of highlights.
        count : int
        drawing : SceneDrawing
            Aimed at the frame.
        targets : list
            Gets the `Targets` that the result lives in, for the caller to release.
        method : {'AUTO', 'RASTER', 'WARP', 'SPLAT'}, optional
            Default: the plan's.
        culls : bool
            False gives every source a mask, for comparison.

        Returns
        -------
        Visibility
        """
        method = method or self._plan.bokeh.settings.visibility
        rows = max(1, -(-count // COLUMNS))
        lists = Targets(
            COLUMNS, rows, [TargetSpec(n, "RGBA32F") for n in ("tiles", "masked", "states")]
        )
        raster = Targets(
            self._plan.bokeh.width * self._fine,
            self._plan.bokeh.height * self._fine,
            [TargetSpec("layers", "RGBA32F"), TargetSpec("opacity", "RGBA8")],
        )
        targets += [lists, raster]
        self._peel(drawing, raster)
        counts = VisibilityCounts()
        key_rows = bokeh_culling.segments(len(self._occluders.groups)) * rows
        with (
            Targets(COLUMNS, key_rows, [TargetSpec("keys", "R32UI")]) as keys,
            Targets(COLUMNS, -(-key_rows // COLUMNS), [TargetSpec("totals", "R32UI")]) as totals,
            Targets(
                bokeh_culling.COUNT_GROUPS + len(self._occluders.groups),
                1,
                [TargetSpec("counts", "R32UI")],
            ) as numbers,
        ):
            numbers["counts"].clear(format="UINT", value=(0,))
            tables = bokeh_culling.CullingTables(
                rows, lists["states"], keys["keys"], totals["totals"], numbers["counts"]
            )
            # What only rays through the layers mask, only the layers need to leave unmasked.
            if method == "AUTO" and count > _MOST_CONES:
                method = "WARP"
            exact = method in {"AUTO", "RASTER"}
            cones = exact or (count <= _MOST_CONES and not self._plan.bokeh.draft)
            self._cull(sources, count, raster, tables, culls, exact, cones)
            found = np.asarray(tables.counts.read()).ravel()
            _note(counts, found)
            drawn = found[bokeh_culling.COUNT_SIZES :][: bokeh_culling.SIZES].astype(np.int64)
            layout = lay_out(drawn, self._room(count))
            counts.texels = int((drawn * layout.sizes[:, 2] ** 2).sum())
            wanted = (drawn * (bokeh_culling.LEAST_SIDE << np.arange(len(drawn))) ** 2).sum()
            counts.work = int(counts.work * (counts.texels / max(wanted, 1)))
            counts.method = self._choose(counts, method)
            if counts.method not in {"RASTER", "WARP"}:
                layout = lay_out(drawn * 0)
                counts.texels = 0
            buffer = uniform_buffer(
                bokeh_culling.TILE_LAYOUT.pack(
                    atlas=(layout.width, layout.height, 0.0, 0.0), sizes=layout.sizes
                )
            )
            bokeh_culling.scan(tables)
            kind = IN_SPLAT if counts.method == "SPLAT" else MASKED
            bokeh_culling.place_tiles(count, buffer, kind, tables, lists["tiles"], lists["masked"])
            masks = Targets(layout.width, layout.height, [TargetSpec("masks", self._format())])
            targets.append(masks)
            atlas = masks.framebuffer("masks")
            with atlas.bind():
                atlas.clear(color=(1.0, 1.0, 1.0, 1.0))
                if counts.method == "WARP":
                    self._warp(sources, counts.masked, lists, raster, buffer)
                elif counts.method == "RASTER":
                    self._raster(sources, count, counts, found, tables, lists, buffer, atlas)
            size = keys.bytes + lists.bytes + raster.bytes + masks.bytes
        return Visibility(
            lists["tiles"],
            masks["masks"],
            raster["layers"],
            raster["opacity"],
            lists["states"],
            self._parameters,
            counts,
            size,
        )

    def _peel(self, drawing, raster):
        """Draw the surfaces that a pinhole at the lens' centre sees behind one another."""
        plan = self._plan
        view = uniform_buffer(
            surface.VIEW_PARAMS.pack(
                view=plan.view,
                view_inverse=np.linalg.inv(plan.view),
                projection=plan.bokeh.projection,
                lens=(
                    plan.focus_distance,
                    float(plan.orthographic),
                    plan.coc_scale,
                    plan.sharp_radius,
                ),
                film=(raster.width, raster.height, 0.0, 0.0),
            )
        )
        draws = drawing.full_detail_draws(peel.OCCLUDERS)
        number = _DRAFT_LAYERS if plan.bokeh.draft else visibility_warp.MOST_LAYERS
        specs = [TargetSpec("color", "RGBA32F")]
        specs += [TargetSpec(name, "DEPTH_COMPONENT32F") for name in ("depth", "front")]
        with Targets(raster.width, raster.height, specs) as layers:
            depth, front = "depth", "front"
            nothing = layers.framebuffer("color", depth=front)
            with nothing.bind():
                nothing.clear(depth=0.0)
            for channel in range(number):
                framebuffer = layers.framebuffer("color", depth=depth)
                with framebuffer.bind():
                    framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
                    peel.draw_layer(draws, view, self._buffers.instances, [layers[front]])
                visibility_warp.pack(
                    layers["color"], layers[depth], channel, raster["layers"], raster["opacity"]
                )
                depth, front = front, depth
            # The layers are given back only after the device has read them.
            readback.wait(layers.framebuffer("color", depth=front))
        drawing.counts.draw_calls += number * len(draws)
        drawn = sum(d.triangles * d.count for d in draws)
        drawing.counts.triangles += number * drawn

    def _room(self, count):
        """Return how many texels masks may take."""
        if self._plan.bokeh.draft:
            return _DRAFT_ATLAS
        return _LARGEST_ATLAS if count <= _MOST_CONES else _ATLAS_OF_MANY

    def _format(self):
        # Products of several surfaces must not be rounded to 8 bits each.
        return "R16F" if self._occluders.groups else "R8"

    def _cull(self, sources, count, raster, tables, culls, exact, cones):
        occluders = self._occluders
        layers = raster["layers"]
        cell = 1
        while -(-layers.width // cell) * -(-layers.height // cell) > _MOST_CELLS:
            cell += 1
        cells = (-(-layers.width // cell), -(-layers.height // cell))
        levels = max(cells).bit_length()
        with Targets(*cells, [TargetSpec("bounds", "RGBA32F", levels)]) as stack:
            bounds = stack["bounds"]
            bokeh_culling.build_bounds(layers, raster["opacity"], bounds, levels, cell)
            bokeh_culling.cull(
                sources,
                count,
                self._parameters,
                layers,
                bounds,
                cell,
                culls,
                tables.states,
            )
            if cones:
                bokeh_culling.count_pairs(
                    sources,
                    count,
                    self._parameters,
                    occluders.opaque,
                    self._buffers.instances,
                    occluders.groups,
                    (culls, exact),
                    tables,
                )
            bokeh_culling.mark_sizes(count, self._parameters, tables)
            # The stack is given back only after the device has read it.
            np.asarray(tables.counts.read())

    @staticmethod
    def _choose(counts, method):
        if counts.masked == 0:
            return ""
        if method != "AUTO":
            return method
        triangles = counts.triangles + counts.surface_pairs * CLUSTER
        return "RASTER" if triangles * STEPS_PER_TRIANGLE <= counts.work else "WARP"

    def _warp(self, sources, masked, lists, raster, layout):
        tables = {name: lists[name] for name in ("masked", "tiles", "states")}
        tables |= {"sources": sources, "layers": raster["layers"], "opacity": raster["opacity"]}
        square = geometry.square_batch()
        visibility_warp.draw_masks(square, masked, tables, self._parameters, layout)

    def _raster(self, sources, count, counts, found, tables, lists, layout, atlas):
        occluders = self._occluders
        shared = {"sources": sources, "tiles": lists["tiles"], "instances": self._buffers.instances}
        batch = geometry.numbered_batch(bokeh_culling.CLUSTER_CORNERS)
        # Places of the prefix sums begin behind the masks'.
        first = counts.masked
        numbers = [counts.pairs, *found[bokeh_culling.COUNT_GROUPS :].tolist()]
        rows = max(1, -(-min(max(numbers), _WINDOW) // COLUMNS))
        with Targets(COLUMNS, rows, [TargetSpec("pairs", "RGBA32F")]) as lists_of_pairs:
            pairs = lists_of_pairs["pairs"]
            for number, total in enumerate(numbers, start=-1):
                for start in range(0, total, _WINDOW):
                    window = (first + start, min(total - start, _WINDOW))
                    bokeh_culling.fill_pairs(
                        sources,
                        count,
                        self._parameters,
                        occluders.opaque,
                        self._buffers.instances,
                        occluders.groups,
                        number,
                        tables,
                        pairs,
                        window,
                    )
                    drawn = {**shared, "pairs": pairs}
                    with atlas.bind():
                        if number < 0:
                            drawn["corners"] = occluders.opaque.corners
                            visibility_raster.draw_clusters(
                                batch, window[1], drawn, self._parameters, layout
                            )
                        else:
                            visibility_raster.draw_surfaces(
                                occluders.draws_of(number),
                                window[1],
                                drawn,
                                self._parameters,
                                layout,
                            )
                first += total
            # The pairs are given back only after the device has read them.
            atlas.read_color(0, 0, 1, 1, 1, 0, "FLOAT")


def _note(counts, found):
    for name, places in bokeh_culling.STATES.items():
        setattr(counts, name, sum(int(found[place]) for place in places))
    counts.work = 64 * int(found[bokeh_culling.COUNT_WORK])
    counts.pairs = int(found[bokeh_culling.COUNT_PAIRS])
    counts.surface_pairs = int(found[bokeh_culling.COUNT_GROUPS :].sum())
