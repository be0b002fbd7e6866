"""From peeled layers to a list of highlights, in an order that is always the same (methods 9).

Highlights are counted for every pixel, the counts are added up row by row and over the rows, and
each pixel then writes its own to where they belong. The list lies in two textures of `COLUMNS`
columns: x, y, depth (camera space, m) and extent (px); energy (radiance times pixels) and the
region of the lens that the highlight stands for: 0 for all of it.
"""

from dataclasses import dataclass

from ..device import shader_source
from ..device.shaders import ShaderInfo, compile_shader, dispatch
from .surface import HIGHLIGHT_PARAMS, VIEW_PARAMS

# Of the textures that hold the list.
COLUMNS = 1024

_GROUP = 8
_ROWS = 64
_THREADS = 256


def _gather_info(subpixels, world, emits):
    defines = [("SUBPIXELS", str(subpixels)), ("SOURCE_COLUMNS", f"{COLUMNS}u")]
    defines += [("WORLD", "1")] * world + [("EMIT", "1")] * emits
    access = ("READ",) if emits else ("WRITE",)
    images = [("R32UI", "UINT_2D_ARRAY", "counts_img", access)]
    if emits:
        images.append(("R32UI", "UINT_2D", "rows_img", ("READ",)))
        images.append(("RGBA32F", "FLOAT_2D", "a_img", ("WRITE",)))
        images.append(("RGBA32F", "FLOAT_2D", "b_img", ("WRITE",)))
    samplers = [("FLOAT_2D", "color_tx")] + [("FLOAT_2D", "depth_tx")] * (not world)
    return ShaderInfo(
        name="aplanat_highlights",
        compute=shader_source.load("passes/highlights_comp.glsl"),
        typedefs=VIEW_PARAMS.source + HIGHLIGHT_PARAMS.source,
        samplers=tuple(samplers),
        images=tuple(images),
        uniforms=(("ViewParams", "view_buf"), ("HighlightParams", "highlight_buf")),
        push_constants=(("INT", "layer"), ("IVEC2", "size"), *(("VEC4", "lens_view"),) * emits),
        defines=tuple(defines),
        local_size=(_GROUP, _GROUP, 1),
    )


def _rows_info(totals):
    images = [("R32UI", "UINT_2D", "rows_img", ("READ", "WRITE"))]
    if totals:
        images.append(("R32UI", "UINT_2D", "count_img", ("READ", "WRITE")))
    else:
        images.append(("R32UI", "UINT_2D_ARRAY", "counts_img", ("READ", "WRITE")))
    defines = (("TOTALS", "1"), ("THREADS", str(_THREADS))) if totals else ()
    return ShaderInfo(
        name="aplanat_highlights_rows",
        compute=shader_source.load("passes/highlights_rows_comp.glsl"),
        typedefs=f"shared uvec2 sums[{_THREADS}];\n" * totals,
        images=tuple(images),
        push_constants=(("IVEC3", "size"),),
        defines=defines,
        local_size=(_THREADS if totals else _ROWS, 1, 1),
    )


@dataclass(frozen=True, eq=False)
class PeeledRaster:
    """Layers that highlights are listed from.

    Parameters
    ----------
    layers : sequence of (GPUTexture, GPUTexture or None)
        Light above the threshold and window depth of each layer; the world has no depth.
    view, split : GPUUniformBuf
        `ViewParams` and `HighlightParams` of the raster.
    size : tuple of 2 int
        Of the part that counts, from the lower left corner, in pixels.
    subpixels : int
        Texels along a side of a pixel.
    lens : tuple of 2 float
        Place on the lens that it is seen from, m.
    region : int
        Of the lens, that it stands for; 0 is all of it.
    """

    layers: tuple
    view: object
    split: object
    size: tuple[int, int]
    subpixels: int
    lens: tuple[float, float] = (0.0, 0.0)
    region: int = 0


def count(raster, counts, rows, total):
    """Count the highlights and find where each row's begin.

    Parameters
    ----------
    raster : PeeledRaster
    counts : GPUTexture
        R32UI array with a layer for each, of the raster's size in pixels or larger.
    rows : GPUTexture
        R32UI, a column for each of the raster's rows, two rows a layer.
    total : GPUTexture
        R32UI, 2 x 1: the number of highlights so far and of those too sharp to be splatted.
    """
    for number in range(len(raster.layers)):
        _gather(raster, number, (("counts_img", counts),))
    shader = compile_shader(_rows_info(totals=False))
    shader.bind()
    shader.image("counts_img", counts)
    shader.image("rows_img", rows)
    shader.uniform_int("size", (*raster.size, len(raster.layers)))
    dispatch(shader, -(-raster.size[1] // _ROWS), len(raster.layers))
    shader = compile_shader(_rows_info(totals=True))
    shader.bind()
    shader.image("rows_img", rows)
    shader.image("count_img", total)
    shader.uniform_int("size", (*raster.size, len(raster.layers)))
    dispatch(shader, 1, 1)


def emit(raster, counts, rows, sources):
    """Write the highlights that `count` has counted, behind those counted before.

    Parameters
    ----------
    raster, counts, rows
        As for `count`.
    sources : tuple of 2 GPUTexture
        RGBA32F, `COLUMNS` wide; what they have no room for is left out.
    """
    images = (
        ("counts_img", counts),
        ("rows_img", rows),
        *zip(("a_img", "b_img"), sources, strict=True),
    )
    for number in range(len(raster.layers)):
        _gather(raster, number, images)


def _gather(raster, number, images):
    color, depth = raster.layers[number]
    emits = len(images) > 1
    shader = compile_shader(_gather_info(raster.subpixels, depth is None, emits))
    shader.bind()
    shader.uniform_sampler("color_tx", color)
    if depth is not None:
        shader.uniform_sampler("depth_tx", depth)
    for name, image in images:
        shader.image(name, image)
    shader.uniform_block("view_buf", raster.view)
    shader.uniform_block("highlight_buf", raster.split)
    shader.uniform_int("layer", number)
    shader.uniform_int("size", raster.size)
    if emits:
        shader.uniform_float("lens_view", (*raster.lens, float(raster.region), 0.0))
    dispatch(shader, -(-raster.size[0] // _GROUP), -(-raster.size[1] // _GROUP))
