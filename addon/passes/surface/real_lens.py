"""A real lens in shaders: variants, shared resources, a lens sample's tables (methods 1).

Passes that draw one lens sample have a variant for it, `declared`; the shader side is
``lib/real_lens_lib.glsl``.
"""

from dataclasses import dataclass, replace

from ...device.textures import texture_2d
from ...device.uniform_block import UniformStruct
from ...device.uniforms import bind_resource, uniform_buffer

REAL_LENS_PARAMS = UniformStruct("shared/real_lens_params.glsl", "RealLensParams")

UNIFORMS = (("RealLensParams", "real_lens_buf"),)
SAMPLERS = (("FLOAT_2D", "moves_tx"),)
PUSH_CONSTANTS = (("INT", "lens_slot"),)
DEFINES = (("REAL_LENS", "1"),)
# Of passes that tell or weigh the circle of confusion.
BLUR_SAMPLERS = (("FLOAT_2D", "blur_tx"),)
BLUR_DEFINES = (("LENS_BLUR", "1"),)
# Of passes that draw what the whole iris shows of a point.
AREA_SAMPLERS = (("FLOAT_2D", "area_tx"),)
# Of passes that weigh samples, or divide by their weights, over the picture.
LIGHT_SAMPLERS = (("FLOAT_2D", "light_tx"),)
LIGHT_CONSTANTS = (("VEC4", "light_table"), ("INT", "light_sets"))
LIGHT_DEFINES = (("LIGHT", "1"),)


@dataclass(frozen=True)
class LensSample:
    """A lens sample of a real lens.

    Parameters
    ----------
    slot : int
        Its place in the tables.
    resources : tuple of (str, GPUUniformBuf or GPUTexture)
        As `resources` gives them.
    light : SampleLight or None
        None: the light is not weighted.
    turns : GPUTexture or None
        Of `turns_texture`, for subsamples.
    sets : int
        Places in the tables from that one on that pixels have in turn; see `SampleLight`.
    tables : int
        Number of the tables that are drawn one after the other, from its own on: of the middle of
        the lens one for each band of wavelengths.
    blur, area : callable or None
        Return the `field_texture` of either, for passes that have one.
    """

    slot: int
    resources: tuple
    light: "SampleLight | None" = None
    turns: object = None
    sets: int = 1
    tables: int = 1
    blur: object = None
    area: object = None

    @property
    def blur_resources(self):
        """What a target `blurred_by_lens` reads, as `resources`."""
        return (("real_lens_buf", dict(self.resources)["real_lens_buf"]), ("blur_tx", self.blur()))

    def bind(self, shader):
        """Set what `declared` has declared in a bound shader."""
        for name, resource in self.resources:
            bind_resource(shader, name, resource)
        if shader.declares("blur_tx"):
            shader.uniform_sampler("blur_tx", self.blur())
        if shader.declares("area_tx"):
            shader.uniform_sampler("area_tx", self.area())
        shader.uniform_int("lens_slot", self.slot)


@dataclass(frozen=True)
class SampleLight:
    """The light that a lens sample gives the places of a picture.

    Parameters
    ----------
    texture : GPUTexture
        Tables of samples, one above the other, of nodes from edge to edge of the picture; linear
        filtering.
    table : tuple of 4 float
        Columns and rows of a table, number of tables, and which is the sample's.
    sets : int
        Tables from that one on that pixels have in turn, as places on the lens (see
        `engine.planning.layered_plan`); 1: all pixels have the same.
    """

    texture: object
    table: tuple[float, float, float, float]
    sets: int = 1

    def bind(self, shader):
        """Set ``light_tx``, ``light_table`` and ``light_sets`` in a bound shader."""
        shader.uniform_sampler("light_tx", self.texture)
        shader.uniform_float("light_table", self.table)
        shader.uniform_int("light_sets", self.sets)


@dataclass(frozen=True)
class SampleOptics:
    """Wavelength and lens of a sample, bound together.

    Parameters
    ----------
    wavelength : chromatic.ChromaticSample or None
    lens : LensSample or None
    """

    wavelength: object
    lens: LensSample | None

    def bind(self, shader):
        """Set what the sample's target declares."""
        for part in (self.wavelength, self.lens):
            if part is not None:
                part.bind(shader)


def declared(info, samplers=()):
    """Return the variant of a shader for a real lens.

    Parameters
    ----------
    info : ShaderInfo
    samplers : tuple of (str, str)
        Of its own, beside those that every variant has.

    Returns
    -------
    ShaderInfo
    """
    return replace(
        info,
        typedefs=info.typedefs + REAL_LENS_PARAMS.source,
        uniforms=(*info.uniforms, *UNIFORMS),
        samplers=(*info.samplers, *SAMPLERS, *samplers),
        push_constants=(*info.push_constants, *PUSH_CONSTANTS),
        defines=(*info.defines, *DEFINES),
    )


def resources(moves, tables, size):
    """Upload the displacements of lens samples.

    Parameters
    ----------
    moves : ndarray of shape (N, rows, columns, 4, 2)
        Coefficients of the powers of the vergence over the largest, as tangents.
    tables : lens_bokeh.samples.sample_tables.SampleTables
        Those that they are of: grids over the field, vergences.
    size : tuple of 2 int
        Of the region, px.

    Returns
    -------
    tuple of (str, GPUUniformBuf or GPUTexture)
    """
    grid, shown = tables.moves_grid, tables.light_grid
    largest, focus = tables.largest_vergence, tables.focus_vergence
    block = REAL_LENS_PARAMS.pack(
        grid=(*grid.low, *(1.0 / (grid.high - grid.low))),
        table=(grid.columns, grid.rows, len(moves), 0.0),
        vergence=(1.0 / largest, focus, 1.0 / (largest - focus), 0.0),
        raster=(*((shown.high - shown.low) / size), *shown.low),
        light=(shown.columns, shown.rows, 0.0, 0.0),
    )
    texture = _in_halves(moves.reshape(*moves.shape[:3], 2, 4))
    return (("real_lens_buf", uniform_buffer(block)), ("moves_tx", texture))


def field_texture(table):
    """Upload a number for each field and vergence.

    Parameters
    ----------
    table : ndarray of float32, shape (rows, columns, 4)
        At the nodes of the displacements: coefficients of the powers of the vergence over the
        largest.

    Returns
    -------
    GPUTexture
    """
    texture = texture_2d(table)
    texture.filter_mode(True)
    texture.extend_mode("EXTEND")
    return texture


def turns_texture(turns):
    """Upload how the displacements of lens samples change with the place on the lens.

    Parameters
    ----------
    turns : ndarray of shape (N, rows, columns, 2, 2, 2)
        Constant, and per unit of the depth buffer; x and y of the movement in texels; by x and y
        on the lens, m.

    Returns
    -------
    GPUTexture
    """
    # Columns of the matrices one after the other.
    return _in_halves(turns.swapaxes(-1, -2).reshape(*turns.shape[:3], 2, 4))


def _in_halves(tables):
    """Upload tables of shape (N, rows, columns, 2, 4): two side by side, samples in a column."""
    count, rows, columns = tables.shape[:3]
    halves = tables.reshape(count * rows, columns, 2, 4).transpose(0, 2, 1, 3)
    texture = texture_2d(halves.reshape(count * rows, 2 * columns, 4))
    texture.filter_mode(True)
    texture.extend_mode("EXTEND")
    return texture


def light_texture(tables):
    """Upload tables of light.

    Parameters
    ----------
    tables : ndarray of shape (N, rows, columns) or (N, rows, columns, 4)

    Returns
    -------
    GPUTexture
        Linear filtering, ending at its edges.
    """
    if tables.ndim == 3:
        tables, kind = tables[..., None], "R32F"
    else:
        kind = "RGBA32F"
    texture = texture_2d(tables.reshape(-1, *tables.shape[2:]), kind)
    texture.filter_mode(True)
    texture.extend_mode("EXTEND")
    return texture
