"""Shading once a pixel: where each opaque lit surface is seen is drawn first, its light afterwards.

A rasteriser shades whole blocks of pixels for each triangle that touches one, and what is hidden
later, too. With triangles as small as pixels that is 10 to 30 times the pixels that are seen. So
triangles only write what the shader of the surface reads (places, normals, attributes), and each
material is then shaded in one go, where it is seen: the same numbers, as often as there are pixels.

A depth buffer of marks, a depth a material, lets the device pass over what is not of the material.

Reference: Saito and Takahashi, Comprehensible rendering of 3-D shapes, SIGGRAPH 1990.
"""

from dataclasses import dataclass, replace

from ...device import shader_source, state
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader
from ...device.targets import TargetSpec
from . import surface_shader

# Most materials of a scene that are shaded so: each is looked for in the whole picture.
MOST_MATERIALS = 64
# Numbers of surfaces are marks of depth over this: a power of two, so that all devices agree.
_MARKS = 128
# Render targets that hold what is written; a device has eight.
_MOST_TARGETS = 6
_COMPONENTS = {"FLOAT": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_SWIZZLE = "xyzw"
# What nodes call that compares neighbouring pixels: of one triangle, not of one material.
_COMPARE_NEIGHBOURS = ("bump_normal", "wireframe")


@dataclass(frozen=True)
class Deferred:
    """How a surface's places are written.

    Parameters
    ----------
    places : Shader
    number : int
        Of what is shaded in one go, from 1.
    targets : int
        How many targets the places take.
    """

    places: object
    number: int
    targets: int


@dataclass(frozen=True)
class Canvas:
    """What a lens sample is drawn into.

    Parameters
    ----------
    targets : Targets
        With those of `specs`.
    colors : tuple of str
        Names of the colour targets.
    depth : str
        Name of the depth target, which is empty.
    within : callable
        Returns a context in which the bound frame buffer is drawn in the part that is wanted.
    fullscreen : GPUBatch
    """

    targets: object
    colors: tuple[str, ...]
    depth: str
    within: object
    fullscreen: object


def canvas(targets, name, within, fullscreen):
    """Return the `Canvas` of a sample or of what is copied into several.

    Parameters
    ----------
    targets : Targets
    name : {'sample', 'scratch'}
        Its colour target; those of depth and mattes are named after it.
    within, fullscreen
        See `Canvas`.
    """
    mattes = "mattes" if name == "sample" else f"{name}_mattes"
    colors = tuple(part for part in (name, mattes) if part in targets)
    return Canvas(targets, colors, f"{name}_depth", within, fullscreen)


def infos(target, code, mesh_attributes, deforms):
    """Return the shaders of a surface that is shaded once a pixel.

    Parameters
    ----------
    target : SurfaceTarget
    code : SurfaceCode
    mesh_attributes : dict of str to ndarray
    deforms : bool

    Returns
    -------
    tuple of (ShaderInfo, ShaderInfo, int) or None
        What writes places, what shades, and how many targets lie between; None for surfaces that
        are not shaded so: by chance transparent, without light of others, or reading neighbours.
    """
    if not (target.deferred and code.lit) or code.transparent or code.refracts:
        return None
    if any(name in code.source for name in _COMPARE_NEIGHBOURS):
        return None
    how = (code, mesh_attributes, False, deforms)
    shading = surface_shader.surface_info(target, *how)
    always = {"world_position", "world_normal"}
    kept = [
        (kind, name) for kind, name in shading.varyings if name in always or name in code.source
    ]
    shadowed = "slack" in [name for _, name in shading.push_constants]
    # The change of the place over a pixel is that of the triangle.
    values = [("VEC3", "surface_geometric", "cross(dFdx(world_position), dFdy(world_position))")]
    values += [("FLOAT", "surface_number", "surface_number")]
    values += [(kind, name, name) for kind, name in kept]
    values += [("FLOAT", "surface_row", "float(instance_row)")]
    values += [("FLOAT", "slack", "slack")] * shadowed
    slots = [f"{name}.{_SWIZZLE[i]}" if _COMPONENTS[kind] > 1 else name
             for kind, name, _ in values for i in range(_COMPONENTS[kind])]  # fmt: skip
    written = [f"({text}).{_SWIZZLE[i]}" if _COMPONENTS[kind] > 1 else text
               for kind, _, text in values for i in range(_COMPONENTS[kind])]  # fmt: skip
    count = -(-len(slots) // 4)
    if count > _MOST_TARGETS:
        return None
    return (
        _places_info(shading, written, count, shadowed),
        _shading_info(target, how, values, slots, count),
        count,
    )


def _places_info(shading, written, count, shadowed):
    """Return the shader that writes what another reads."""
    written = written + ["0.0"] * (4 * count - len(written))
    lines = [
        f"  out_surface_{i} = vec4({', '.join(written[4 * i : 4 * i + 4])});" for i in range(count)
    ]
    left_out = {"slack", "material_id"}
    constants = [item for item in shading.push_constants if item[1] not in left_out]
    constants += [("FLOAT", "surface_number"), *surface_shader.SHADOW_CONSTANTS * shadowed]
    of_material = [item for item in shading.samplers if item[1].startswith("image_")]
    return replace(
        shading,
        name="aplanat_places",
        fragment="void main()\n{\n" + "\n".join(lines) + "\n}\n",
        outputs=tuple(("VEC4", f"out_surface_{i}") for i in range(count)),
        samplers=tuple(item for item in shading.samplers if item not in of_material),
        uniforms=tuple(item for item in shading.uniforms if item[1] != "material_buf"),
        push_constants=tuple(constants),
    )


def _shading_info(target, how, values, slots, count):
    """Return the shader that shades a picture of places."""
    types = {"FLOAT": "float", "VEC2": "vec2", "VEC3": "vec3", "VEC4": "vec4"}
    declared = [f"{types[kind]} {name};" for kind, name, _ in values]
    lines = ["  ivec2 texel = ivec2(gl_FragCoord.xy);"]
    lines += [f"  vec4 surface_{i} = texelFetch(surface_{i}_tx, texel, 0);" for i in range(count)]
    lines += [f"  {slot} = surface_{i // 4}.{_SWIZZLE[i % 4]};" for i, slot in enumerate(slots)]
    lines += ["  instance_row = int(surface_row + 0.5);"]
    text = "\n".join([*declared, "int instance_row;", "void load_surface()", "{", *lines, "}"])
    info = surface_shader.surface_info(target, *how, given=text + "\n")
    stored = surface_shader.SHADOW_CONSTANTS
    constants = [item for item in info.push_constants if item not in stored]
    return replace(
        info,
        name="aplanat_shading",
        vertex=shader_source.load("passes/surface/shading_vert.glsl"),
        attributes=(("VEC2", "pos"),),
        varyings=(),
        samplers=(*info.samplers, *(("FLOAT_2D", f"surface_{i}_tx") for i in range(count))),
        push_constants=(*constants, ("FLOAT", "mark")),
        defines=(*info.defines, ("DEFERRED", "1")),
    )


@variants()
def _marks_info():
    return ShaderInfo(
        name="aplanat_marks_of_surfaces",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/surface/marks_frag.glsl"),
        attributes=(("VEC2", "pos"),),
        samplers=(("FLOAT_2D", "depth_tx"), ("FLOAT_2D", "surface_0_tx")),
        push_constants=(("FLOAT", "marks"),),
        writes_depth=True,
    )


def specs(draws, scale):
    """Return the targets that some draws need, `scale` times as fine as the picture.

    Parameters
    ----------
    draws : list of surface.Draw
    scale : int

    Returns
    -------
    tuple of TargetSpec
    """
    count = max((draw.deferred.targets for draw in draws if draw.deferred), default=0)
    found = [TargetSpec(f"surface_{i}", "RGBA32F", scale=scale) for i in range(count)]
    found += [TargetSpec("surface_marks", "DEPTH_COMPONENT32F", scale=scale)] * bool(count)
    return tuple(found)


def draw(draws, canvas, bind, give_material):
    """Draw surfaces as the first ones of a lens sample.

    Parameters
    ----------
    draws : list of surface.Draw
        With `deferred`.
    canvas : Canvas
    bind, give_material : callable
        Take a shader and a draw: make it the current one, with all that does not depend on the
        material; set what does.
    """
    targets, within, fullscreen = canvas.targets, canvas.within, canvas.fullscreen
    count = max(draw.deferred.targets for draw in draws)
    names = tuple(f"surface_{i}" for i in range(count))
    with targets.framebuffer(*names, depth=canvas.depth).bind(), within():
        state.opaque()
        _draw_places(draws, bind)
    with targets.framebuffer(depth="surface_marks").bind(), within():
        state.always()
        shader = compile_shader(_marks_info())
        shader.bind()
        shader.uniform_sampler("depth_tx", targets[canvas.depth])
        shader.uniform_sampler("surface_0_tx", targets["surface_0"])
        shader.uniform_float("marks", float(_MARKS))
        shader.draw(fullscreen)
    first = {}
    for one in draws:
        first.setdefault(one.deferred.number, one)
    with targets.framebuffer(*canvas.colors, depth="surface_marks").bind(), within():
        state.marked()
        current = None
        for one in first.values():
            if one.shader is not current:
                current = one.shader
                bind(current, one)
                for i in range(one.deferred.targets):
                    current.uniform_sampler(f"surface_{i}_tx", targets[f"surface_{i}"])
                current.uniform_int("instance_base", 0)
            give_material(current, one)
            current.uniform_float("mark", one.deferred.number / _MARKS)
            current.draw(fullscreen)


def _draw_places(draws, bind):
    current = None
    for one in draws:
        places = one.deferred.places
        if places is not current:
            current = places
            bind(current, one)
        current.uniform_float("surface_number", float(one.deferred.number))
        if current.declares("slack"):
            current.uniform_float("slack", one.slack)
        current.uniform_int("instance_base", one.first)
        current.draw_instanced(one.batch, one.count)
