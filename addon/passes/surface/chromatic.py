"""Chromatic aberration in shaders: variants, shared resources, a sample's wavelength (methods 8).

Passes that draw one lens sample have a variant for it, `declared`; what all samples share comes
from `resources`, and a sample's own numbers are in its `ChromaticSample`. The shader side is
``lib/chromatic_lib.glsl``.
"""

from dataclasses import dataclass, replace

from ...device.textures import texture_2d
from ...device.uniform_block import UniformStruct
from ...device.uniforms import bind_resource, uniform_buffer

CHROMATIC_PARAMS = UniformStruct("shared/chromatic_params.glsl", "ChromaticParams")

UNIFORMS = (("ChromaticParams", "chromatic_buf"),)
SAMPLERS = (("FLOAT_2D", "field_tx"),)
PUSH_CONSTANTS = (("VEC2", "dispersion"),)
DEFINES = (("CHROMATIC", "1"),)


@dataclass(frozen=True)
class ChromaticSample:
    """A lens sample's wavelength.

    Parameters
    ----------
    dispersion : tuple of 2 float
        Relative difference of the focal length from the reference wavelength's, and lateral
        strength.
    tint : tuple of 4 float
        Weight of the sample in red, green, blue and alpha.
    resources : tuple of (str, GPUUniformBuf or GPUTexture)
        As `resources` gives them.
    """

    dispersion: tuple[float, float]
    tint: tuple[float, float, float, float]
    resources: tuple

    def bind(self, shader):
        """Set what `declared` has declared in a bound shader."""
        self.bind_resources(shader)
        shader.uniform_float("dispersion", self.dispersion)

    def bind_resources(self, shader):
        """Bind only the shared resources, for a shader `over_field` without a wavelength."""
        for name, resource in self.resources:
            bind_resource(shader, name, resource)


def over_field(info):
    """Return the variant of a shader that looks up the field table, but has no wavelength.

    Parameters
    ----------
    info : ShaderInfo

    Returns
    -------
    ShaderInfo
    """
    return replace(
        info,
        typedefs=info.typedefs + CHROMATIC_PARAMS.source,
        uniforms=(*info.uniforms, *UNIFORMS),
        samplers=(*info.samplers, *SAMPLERS),
        defines=(*info.defines, *DEFINES),
    )


def declared(info, push_constants=()):
    """Return the variant of a shader for chromatic aberration.

    Parameters
    ----------
    info : ShaderInfo
    push_constants : tuple of (str, str)
        Of its own, beside those that every variant has.

    Returns
    -------
    ShaderInfo
    """
    info = over_field(info)
    return replace(info, push_constants=(*info.push_constants, *PUSH_CONSTANTS, *push_constants))


def resources(*, table, radius, parallel, focus, raster, extremes, typical):
    """Upload the field table and `ChromaticParams`, which all samples of a frame share.

    Parameters
    ----------
    table : ndarray of shape (R, C, 2)
        The field table.
    radius : float
        Distance from the axis in the field where t is 1.
    parallel : bool
    focus : tuple of 4 float
        Inverse focus distance and inverse focal length of the reference wavelength, 1/m; unused;
        least lateral scale.
    raster : sequence of 4 float
        From pixels to the field: scale and offset.
    extremes : tuple of 3 float
        Least and largest difference of the focal length, largest lateral strength.
    typical : tuple of 2 float
        Differences of the focal length whose circles of confusion represent all wavelengths.

    Returns
    -------
    tuple of (str, GPUUniformBuf or GPUTexture)
    """
    rows, columns = table.shape[:2]
    block = CHROMATIC_PARAMS.pack(
        field=(1.0 / radius, float(parallel), columns - 1.0, rows),
        focus=focus,
        raster=raster,
        extremes=(*extremes, 0.0),
        typical=(*typical, 0.0, 0.0),
    )
    return (("chromatic_buf", uniform_buffer(block)), ("field_tx", texture_2d(table, "RG32F")))
