"""From drawn surfaces to a list of highlights, in an order that is always the same (methods 9).

Surfaces that may exceed the highlight threshold are drawn once, into a raster with several texels a
pixel; each fragment brighter than the threshold is appended to its texel's list, whatever lies in
front. The texels' lists are then sorted by depth, the highlights of each pixel counted, prefix sums
of the counts taken, and each pixel writes its highlights to its place in the list. Only tiles with
fragments in them take part.

The list of highlights lies in two textures of `COLUMNS` columns: x, y, depth (camera space, m) and
extent (px); energy (radiance times pixels) and the region of the lens that the highlight stands
for: 0 for all of it.

References
----------
Yang, Hensley, Gruen and Thibieroz, *Real-time concurrent linked list construction on the GPU*,
EGSR 2010.
"""

from dataclasses import dataclass

import numpy as np

from ...device import shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from ...device.targets import Targets, TargetSpec
from ...device.textures import texture_2d
from ...device.uniforms import bind_resource
from ..surface import chromatic
from ..surface.surface import HIGHLIGHT_PARAMS, VIEW_PARAMS
from ..visibility import prefix_sums
from ..visibility.prefix_sums import COLUMNS

# Side of a tile, px.
TILE = 8
# Parallax, px, below which a surface in front of a source is no occluder: all places on the lens
# see the source as the lens' centre does.
SAME_VIEW = 0.25

_THREADS = 64
# Most groups along the first axis of a dispatch.
_GROUPS = 16384

_DEFINES = (("SOURCE_COLUMNS", f"{COLUMNS}u"),)
_NUMBERS = ("R32UI", "UINT_2D")

# What a shader that includes passes/bokeh/highlights_append.glsl declares.
APPEND_IMAGES = (
    (*_NUMBERS, "used_img", ("READ", "WRITE")),
    (*_NUMBERS, "heads_img", ("READ", "WRITE")),
    (*_NUMBERS, "tiles_img", ("READ", "WRITE")),
    ("RGBA32F", "FLOAT_2D", "light_img", ("WRITE",)),
    ("RGBA32UI", "UINT_2D", "nodes_img", ("WRITE",)),
)
# What a shader declares that takes the light of listed fragments.
TAKE_IMAGES = (
    (*_NUMBERS, "heads_img", ("READ",)),
    ("RGBA32F", "FLOAT_2D", "light_img", ("READ", "WRITE")),
    ("RGBA32UI", "UINT_2D", "nodes_img", ("READ",)),
)
# What a shader declares besides that counts the texels of instances.
COUNT_IMAGES = ((*_NUMBERS, "hits_img", ("READ", "WRITE")),)
COUNT_SAMPLERS = (("FLOAT_2D", "areas_tx"),)
APPEND_CONSTANTS = (("INT", "capacity"), ("INT", "tile_texels"))
APPEND_DEFINES = _DEFINES

# Behind dispatches, Blender lets the device finish what it writes to images; behind draws it does
# not.
_FINISH = ShaderInfo(
    name="aplanat_highlights_finish",
    compute="void main()\n{\n  imageStore(sharp_img, ivec2(1, 0), uvec4(0u));\n}\n",
    images=((*_NUMBERS, "sharp_img", ("WRITE",)),),
    local_size=(1, 1, 1),
)


@variants(world=(False, True), in_wavelengths=(False, True))
def _order_info(world, in_wavelengths):
    samplers = [("UINT_2D", "nodes_tx")]
    if not world:
        samplers += [("FLOAT_2D", "scene_tx"), ("FLOAT_2D", "areas_tx"), ("UINT_2D", "hits_tx")]
    constants = [("INT", "number")] + [("INT", "layers"), ("FLOAT", "same_view")] * (not world)
    constants += [("VEC4", "lens_view")] * in_wavelengths
    info = ShaderInfo(
        name="aplanat_highlights_order",
        compute=shader_source.load("passes/bokeh/highlights_order_comp.glsl"),
        typedefs=VIEW_PARAMS.source + HIGHLIGHT_PARAMS.source,
        samplers=tuple(samplers),
        images=(
            (*_NUMBERS, "heads_img", ("READ", "WRITE")),
            (*_NUMBERS, "order_img", ("READ", "WRITE")),
            ("RGBA32F", "FLOAT_2D", "light_img", ("READ", "WRITE")),
        ),
        uniforms=(("ViewParams", "view_buf"), ("HighlightParams", "highlight_buf")),
        push_constants=tuple(constants),
        defines=_DEFINES + (("WORLD", "1"),) * world,
        local_size=(_THREADS, 1, 1),
    )
    return chromatic.over_field(info) if in_wavelengths else info


@variants(emits=(False, True))
def _gather_info(emits):
    samplers = [("FLOAT_2D", "listed_tx"), ("FLOAT_2D", "light_tx")]
    samplers += [("UINT_2D", "heads_tx"), ("UINT_2D", "order_tx")]
    samplers += [("UINT_2D", "starts_tx"), ("UINT_2D", "totals_tx")] * emits
    images = [(*_NUMBERS, name, ("READ", "WRITE")) for name in ("starts_img", "sharp_img")]
    if emits:
        images = [("RGBA32F", "FLOAT_2D", name, ("WRITE",)) for name in ("a_img", "b_img")]
    constants = [("INT", "tiles"), ("INT", "subpixels")]
    constants += [("INT", "first"), ("VEC4", "lens_view")] * emits
    return ShaderInfo(
        name="aplanat_highlights",
        compute=shader_source.load("passes/bokeh/highlights_comp.glsl"),
        typedefs=VIEW_PARAMS.source,
        samplers=tuple(samplers),
        images=tuple(images),
        uniforms=(("ViewParams", "view_buf"),),
        push_constants=tuple(constants),
        defines=(*_DEFINES, ("TILE", str(TILE)), *(("EMIT", "1"),) * emits),
        local_size=(TILE, TILE, 1),
    )


@dataclass(frozen=True)
class SearchedRaster:
    """How the raster was drawn from which highlights are listed.

    Parameters
    ----------
    view : GPUUniformBuf
        `ViewParams` of the raster.
    split : split_light.SplitLight
    subpixels : int
        Texels along a side of a pixel.
    layers : int
        Fragments of a texel that are listed.
    lens : tuple of 2 float
        Place on the lens that it was seen from, m.
    region : int
        Number of the region of the lens that this view represents; 0 is the whole lens.
    field : tuple of (str, GPUUniformBuf or GPUTexture) or None
        `passes.surface.chromatic.resources`, with chromatic aberration: light is then split by the
        mean circle of confusion of all wavelengths.
    """

    view: object
    split: object
    subpixels: int
    layers: int
    lens: tuple[float, float] = (0.0, 0.0)
    region: int = 0
    field: tuple | None = None


def finish(written):
    """Let the device finish what draws write to images, before it reads them.

    Parameters
    ----------
    written : GPUTexture
        R32UI, two texels wide at least; its second texel becomes 0.
    """
    shader = compile_shader(_FINISH)
    shader.bind()
    shader.image("sharp_img", written)
    dispatch(shader, 1, 1)


class TexelCounts:
    """Numbers of texels that instances cover in a raster, and areas of their triangles there.

    Parameters
    ----------
    areas : sequence of float
        Of each row of the instance table, in texels: the light that is found of it is scaled by
        this area over the counted texels; 0 leaves the light as it is.
    growth : sequence of float, optional
        Of each row: another factor of its light.
    """

    def __init__(self, areas=(), growth=()):
        rows = max(1, -(-len(areas) // COLUMNS))
        table = np.zeros((rows * COLUMNS, 2), np.float32)
        table[:, 1] = 1.0
        table[: len(areas), 0] = areas
        table[: len(growth), 1] = growth
        table = table.reshape(rows, COLUMNS, 2)
        self.areas = texture_2d(table, "RG32F")
        self._none = texture_2d(np.zeros_like(table), "RG32F")
        self._targets = Targets(COLUMNS, rows, [TargetSpec("hits", "R32UI")])
        self.hits.clear(format="UINT", value=(0,))

    @property
    def hits(self):
        """Texels of each row of the instance table, as a texture."""
        return self._targets["hits"]

    def bindings(self, counting):
        """Return the bindings of a shader that counts texels; counts grow only if `counting`."""
        return (("hits_img", self.hits), ("areas_tx", self.areas if counting else self._none))

    def release(self):
        """Release the textures."""
        self._targets.release()


class FragmentLists:
    """The fragments of a raster that are brighter than the threshold, texel by texel.

    Parameters
    ----------
    width, height : int
        Of the raster in pixels.
    subpixels : int
    capacity : int
        Fragments that there is room for; rounded up to whole rows.
    """

    def __init__(self, width, height, subpixels, capacity):
        rows = -(-capacity // COLUMNS)
        self.capacity = rows * COLUMNS
        self._tile_texels = TILE * subpixels
        side = tuple(-(-n // TILE) for n in (width, height))
        self.targets = Targets(
            COLUMNS,
            rows,
            [
                TargetSpec("heads", "R32UI", size=(width * subpixels, height * subpixels)),
                TargetSpec("used", "R32UI", size=(1, 1)),
                TargetSpec("tiles", "R32UI", size=side),
                TargetSpec("light", "RGBA32F"),
                TargetSpec("nodes", "RGBA32UI"),
                TargetSpec("order", "R32UI"),
                TargetSpec("sharp", "R32UI", size=(2, 1)),
            ],
        )

    def clear(self):
        """Empty the lists."""
        for name in ("heads", "used", "tiles"):
            self.targets[name].clear(format="UINT", value=(0,))

    def bindings(self):
        """Return the bindings of a shader that appends fragments: names, textures or numbers."""
        numbers = (("capacity", self.capacity), ("tile_texels", self._tile_texels))
        return (*self._images(APPEND_IMAGES), *numbers)

    def taken(self):
        """Return the bindings of a shader that takes the light of fragments."""
        return self._images(TAKE_IMAGES)

    def _images(self, declared):
        names = [name for _, _, name, _ in declared]
        return tuple((name, self.targets[name.removesuffix("_img")]) for name in names)

    def read(self):
        """Wait for the device.

        Returns
        -------
        number : int
            Of fragments; may be more than there was room for.
        tiles : ndarray of shape (N, 2)
            Column and row of the tiles that have fragments.
        thresholds : ndarray of shape (N,)
            The largest threshold of each.
        """
        finish(self.targets["sharp"])
        number = int(np.asarray(self.targets["used"].read()).ravel()[0])
        tiles = self.targets["tiles"]
        shines = np.array(tiles.read(), np.uint32).reshape(tiles.height, tiles.width)
        return number, np.argwhere(shines)[:, ::-1], shines[shines > 0].view(np.float32)

    def release(self):
        """Release the textures."""
        self.targets.release()


def order(raster, lists, number, scene=None, counts=None):
    """Sort the fragments of each texel by depth; drop those hidden from the whole lens.

    Parameters
    ----------
    raster : SearchedRaster
    lists : FragmentLists
    number : int
        Of fragments.
    scene : GPUTexture or None
        Window depth of the nearest opaque surface; None: the fragments are the world's.
    counts : TexelCounts, optional
        Of the instances, complete for what the raster shows; not used for the world.
    """
    counts = counts or TexelCounts()
    shader = compile_shader(_order_info(scene is None, raster.field is not None))
    shader.bind()
    if raster.field is not None:
        for name, resource in raster.field:
            bind_resource(shader, name, resource)
        shader.uniform_float("lens_view", (*raster.lens, 0.0, 0.0))
    shader.uniform_sampler("nodes_tx", lists.targets["nodes"])
    for name in ("heads", "order", "light"):
        shader.image(f"{name}_img", lists.targets[name])
    shader.uniform_block("view_buf", raster.view)
    raster.split.bind(shader)
    shader.uniform_int("number", number)
    if scene is not None:
        shader.uniform_sampler("scene_tx", scene)
        shader.uniform_sampler("areas_tx", counts.areas)
        shader.uniform_sampler("hits_tx", counts.hits)
        shader.uniform_int("layers", raster.layers)
        shader.uniform_float("same_view", SAME_VIEW)
    _dispatch(shader, -(-number // _THREADS))


def emit(raster, lists, tiles, sources, first):
    """Append the highlights of a raster to the list of highlights.

    Parameters
    ----------
    raster : SearchedRaster
    lists : FragmentLists
        In order.
    tiles : ndarray of shape (N, 2)
        As of `FragmentLists.read`.
    sources : tuple of 2 GPUTexture
        RGBA32F, `COLUMNS` wide; highlights beyond their size are left out.
    first : int
        Number of highlights in the list so far.

    Returns
    -------
    count : int
        Highlights listed now.
    sharp : int
        Pixels with light above the threshold whose circle of confusion is too small to be splatted.
    """
    rows = -(-len(tiles) // COLUMNS)
    listed = np.zeros((rows * COLUMNS, 4), np.float32)
    listed[: len(tiles), :2] = tiles
    listed = texture_2d(listed.reshape(rows, COLUMNS, 4))
    # One more row, for the sum of all.
    height = -(-len(tiles) * TILE**2 // COLUMNS) + 1
    specs = [
        TargetSpec("starts", "R32UI"),
        TargetSpec("totals", "R32UI", size=(COLUMNS, -(-height // COLUMNS))),
    ]
    sharp = lists.targets["sharp"]
    with Targets(COLUMNS, height, specs) as tables:
        starts, totals = tables["starts"], tables["totals"]
        for texture in (starts, sharp):
            texture.clear(format="UINT", value=(0,))
        images = (("starts_img", starts), ("sharp_img", sharp))
        _gather(raster, lists, listed, len(tiles), images)
        prefix_sums.add_up(starts, totals)
        images = zip(("a_img", "b_img"), sources, strict=True)
        _gather(raster, lists, listed, len(tiles), images, (starts, totals, first))
        # Also waits until the device has read the tables.
        count = int(np.asarray(totals.read()).ravel()[height - 1])
        return count, int(np.asarray(sharp.read()).ravel()[0])


def _gather(raster, lists, listed, tiles, images, places=None):
    shader = compile_shader(_gather_info(places is not None))
    shader.bind()
    shader.uniform_sampler("listed_tx", listed)
    for name in ("light", "heads", "order"):
        shader.uniform_sampler(f"{name}_tx", lists.targets[name])
    for name, image in images:
        shader.image(name, image)
    shader.uniform_block("view_buf", raster.view)
    shader.uniform_int("tiles", tiles)
    shader.uniform_int("subpixels", raster.subpixels)
    if places is not None:
        starts, totals, first = places
        shader.uniform_sampler("starts_tx", starts)
        shader.uniform_sampler("totals_tx", totals)
        shader.uniform_int("first", first)
        shader.uniform_float("lens_view", (*raster.lens, float(raster.region), 0.0))
    _dispatch(shader, tiles)


def _dispatch(shader, groups):
    across = min(groups, _GROUPS)
    dispatch(shader, across, -(-groups // across))
