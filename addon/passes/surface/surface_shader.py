"""The shader of a surface: declarations and sources, of a tree of nodes, a mesh and a target."""

from ...device import shader_source
from ...device.geometry import attribute_identifier, attribute_type
from ...device.shaders import ShaderInfo
from ...device.uniform_block import UniformStruct
from . import environment
from .surface_target import whole

# Samplers of a lit surface: the light table, the world's image and its prefiltered levels, and the
# reflectance table of GGX lobes.
LIGHTING_TEXTURES = (
    "lights_tx",
    "environment_tx",
    "environment_levels_tx",
    "ggx_tx",
)
# The same with shadows: the atlas of light maps, and which light samples a drawing is lit by.
SHADOW_TEXTURES = ("light_maps_tx", "lit_by_tx")
# How far a coarser level of detail may be from the true surface, in the mesh's units.
SHADOW_CONSTANTS = (("FLOAT", "slack"),)
# What glass reads: the picture and depth of what is behind it, its backs, and a probe of the scene.
GLASS_TEXTURES = ("behind_tx", "behind_depth_tx", "exits_tx", "probe_tx", "probe_depth_tx")

VIEW_PARAMS = UniformStruct("shared/view_params.glsl", "ViewParams")
HIGHLIGHT_PARAMS = UniformStruct("shared/highlight_params.glsl", "HighlightParams")
GLASS_PARAMS = UniformStruct("shared/glass_params.glsl", "GlassParams")

GLASS_LIBRARIES = ("lib/lens_lib.glsl", "lib/depth_lib.glsl", "lib/surface/probe_lib.glsl")
LENS_LIBRARIES = (
    ("CHROMATIC", "lib/chromatic_lib.glsl"),
    ("REAL_LENS", "lib/real_lens_lib.glsl"),
)
_LIBRARIES = (
    "lib/hash_lib.glsl",
    "lib/surface/color_lib.glsl",
    "lib/surface/texture_lib.glsl",
    "lib/surface/vector_lib.glsl",
    "passes/surface/surface_lighting.glsl",
)


def surface_info(target, code, mesh_attributes, holdout=False, deforms=False, part=None, given=""):
    """Return the declarations and sources of the shader of a surface on a mesh.

    Parameters
    ----------
    target : SurfaceTarget
    code : SurfaceCode
    mesh_attributes : dict of str to ndarray
    holdout : bool
    deforms : bool
        The mesh has positions in the neighbouring frames.
    part : {None, 'GLOW', 'FILTER'}
        Only the light that the surface adds, or the colour that it filters light with.
    given : str
        Declarations that come first in the fragment shader.

    Returns
    -------
    ShaderInfo
    """
    if holdout or part == "FILTER":
        # No light to split.
        target = whole(target)
    attributes = [("VEC3", "pos")]
    varyings = [("VEC3", "world_position"), ("FLAT INT", "instance_row"), *target.varyings]
    forward = []
    transparent = code.transparent and not holdout
    shades = not holdout and (target.shades or transparent)
    own = tuple(key for key in target.attributes if key in mesh_attributes)
    defines = [*target.defines, *["HOLDOUT"] * holdout, *["TRANSPARENT"] * transparent]
    if target.shades and not holdout:
        defines += [*["SHADES"], *["LIT"] * code.lit, *code.features]
        if code.glows or part:
            defines.append(part or "GLOW_APART")
    if "HAS_VECTOR" in defines and deforms:
        defines.append("HAS_DEFORMATION")
        attributes += [("VEC3", "pos_previous"), ("VEC3", "pos_next")]
    defines = dict.fromkeys(defines, "1") | dict(target.values)
    for key in dict.fromkeys((code.attributes if shades else ()) + own):
        name = attribute_identifier(key)
        kind = attribute_type(mesh_attributes[key].shape[1])
        attributes.append((kind, name))
        if key == "normal":
            varyings.append(("VEC3", "world_normal"))
            defines |= {"HAS_NORMAL": "1", "ATTRIBUTE_NORMAL": name}
        varyings.append((kind, f"v_{name}"))
        forward.append(f"  v_{name} = {name};")
    if shades and code.reads_place:
        varyings.append(("VEC3", "v_object_position"))
        forward.append("  v_object_position = pos;")
    vertex = "void forward_attributes()\n{\n" + "\n".join(forward) + "\n}\n"
    vertex = shader_source.join((shader_source.Text(vertex), target.vertex))
    libraries_of_parts = []
    if target.splits and target.shades and not holdout:
        # Lighting asks whether light may be splatted.
        libraries_of_parts += ["lib/lens_lib.glsl", "lib/bokeh/highlight_lib.glsl"]
    structs, uniforms = target.structs, [*target.uniforms]
    samplers = [("FLOAT_2D", "instances_tx"), *target.samplers]
    push_constants = [("INT", "instance_base"), *target.push_constants]
    if target.seen:
        structs = VIEW_PARAMS.source + structs
        uniforms.insert(0, ("ViewParams", "view_buf"))
        push_constants += [("VEC4", "lens_sample"), ("INT", "sample_index")]
        defines["SEEN"] = "1"
    generated = ""
    if shades:
        generated = code.source
        structs += f"struct MaterialParams {{ vec4 constants[{len(code.constants)}]; }};\n"
        uniforms.append(("MaterialParams", "material_buf"))
        samplers += [("FLOAT_2D", f"image_{i}_tx") for i in range(len(code.images))]
    if target.splits and shades:
        structs += HIGHLIGHT_PARAMS.source
        uniforms.append(("HighlightParams", "highlight_buf"))
        defines |= {"MIRRORING": "1"} if code.mirrors else {}
        defines |= {"REFLECTING": "1"} if code.reflects else {}
    if "LIT" in defines:
        structs += environment.ENVIRONMENT_PARAMS.source
        uniforms.append(("EnvironmentParams", "environment_buf"))
        samplers += [("FLOAT_2D", name) for name in LIGHTING_TEXTURES]
        if "SHADOWS" in defines:
            samplers += [("FLOAT_2D", name) for name in SHADOW_TEXTURES]
            push_constants += SHADOW_CONSTANTS
    if code.refracts and target.refracts and not (holdout or part):
        defines["REFRACTS"] = "1"
        libraries_of_parts += GLASS_LIBRARIES
        libraries_of_parts += [path for name, path in LENS_LIBRARIES if name in defines]
        structs += GLASS_PARAMS.source
        uniforms.append(("GlassParams", "glass_buf"))
        samplers += [("FLOAT_2D", name) for name in GLASS_TEXTURES]
    if target.names_material and not holdout:
        push_constants.append(("FLOAT", "material_id"))
    libraries = (*libraries_of_parts, *_LIBRARIES, *(code.libraries if shades else ()))
    parts = (*libraries, shader_source.Text(generated), target.fragment)
    if given:
        parts = (shader_source.Text(given), *parts)
    fragment = shader_source.join(parts)
    return ShaderInfo(
        name="aplanat_surface",
        vertex=vertex,
        fragment=fragment,
        typedefs=structs,
        attributes=tuple(attributes),
        varyings=tuple(varyings),
        outputs=target.outputs,
        samplers=tuple(samplers),
        images=target.images,
        uniforms=tuple(uniforms),
        push_constants=tuple(push_constants),
        defines=tuple(defines.items()),
    )
