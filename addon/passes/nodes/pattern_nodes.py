"""Generators of GLSL for procedural textures."""

from .registry import generator_registry

GENERATORS, generates = generator_registry()

_NOISE = "lib/nodes/noise_lib.glsl"
_PATTERNS = "lib/nodes/patterns_lib.glsl"


def _floats(node, writer, *names):
    return [writer.value(node.input(name), "float") for name in names]


def _place(node, writer, scaled=True):
    """Write the place at which a texture of 1 to 4 dimensions is looked up; return it and these."""
    dims = int(node.setting("dimensions")[0])
    vector = writer.value(node.input("Vector"), "vec3")
    w = writer.value(node.input("W"), "float")
    place = {
        1: f"vec4({w}, 0.0, 0.0, 0.0)",
        2: f"vec4(({vector}).xy, 0.0, 0.0)",
        3: f"vec4({vector}, 0.0)",
        4: f"vec4({vector}, {w})",
    }[dims]
    if scaled:
        place += f" * {writer.value(node.input('Scale'), 'float')}"
    return writer.let("vec4", place), dims


@generates("noise", _NOISE)
def _noise(node, writer):
    place, dims = _place(node, writer)
    normalizes = "true" if node.setting("normalize") else "false"
    names = ("Detail", "Roughness", "Lacunarity", "Offset", "Gain")
    numbers = ", ".join(_floats(node, writer, *names))
    look = f"NoiseLook(NOISE_{node.setting('type')}, {dims}, {normalizes}, {numbers})"
    arguments = f"({place}, {writer.value(node.input('Distortion'), 'float')}, {look})"
    if writer.uses(node, "Color"):
        color = writer.let("vec3", f"noise_texture{arguments}")
        return {"Color": ("color", color), "Fac": ("float", f"{color}.x")}
    return {"Fac": ("float", writer.let("float", f"noise_texture_value{arguments}"))}


@generates("white_noise", "lib/nodes/random_lib.glsl")
def _white_noise(node, writer):
    place, dims = _place(node, writer, scaled=False)
    outputs = {}
    if writer.uses(node, "Value"):
        outputs["Value"] = ("float", writer.let("float", f"random_of({place}, {dims})"))
    if writer.uses(node, "Color"):
        outputs["Color"] = ("color", writer.let("vec3", f"random_color_of({place}, {dims})"))
    return outputs


@generates("voronoi", "lib/nodes/voronoi_lib.glsl")
def _voronoi(node, writer):
    place, dims = _place(node, writer)
    feature = node.setting("feature")
    names = ("Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent", "Randomness")
    numbers = ", ".join(_floats(node, writer, *names))
    normalizes = "true" if node.setting("normalize") else "false"
    look = writer.let(
        "VoronoiLook",
        f"VoronoiLook({dims}, VORONOI_{feature}, VORONOI_{node.setting('metric')}, {normalizes},"
        f" {numbers})",
    )
    if feature == "DISTANCE_TO_EDGE":
        return {"Distance": ("float", writer.let("float", f"voronoi_edge({place}, {look})"))}
    if feature == "N_SPHERE_RADIUS":
        return {"Radius": ("float", writer.let("float", f"voronoi_radius({place}, {look})"))}
    cell = writer.let("VoronoiCell", f"voronoi_texture({place}, {look})")
    position = f"{cell}.place.{'x' if dims == 1 else 'w'}"
    flat = f"vec3({cell}.place.xy, 0.0)" if dims == 2 else f"{cell}.place.xyz"
    return {
        "Distance": ("float", f"{cell}.distance"),
        "Color": ("color", f"{cell}.color"),
        "Position": ("vec3", flat),
        "W": ("float", position),
    }


# A point along the wave, in radians, from a place `p`; rings go around an axis.
_BANDS = {"X": "20.0 * p.x", "Y": "20.0 * p.y", "Z": "20.0 * p.z"}
_BANDS["DIAGONAL"] = "10.0 * (p.x + p.y + p.z)"
_RINGS = {"X": "p.yz", "Y": "p.xz", "Z": "p.xy", "SPHERICAL": "p"}


@generates("wave", _NOISE, _PATTERNS)
def _wave(node, writer):
    scale, distortion, detail, detail_scale, roughness, phase = _floats(
        node,
        writer,
        *("Scale", "Distortion", "Detail", "Detail Scale", "Detail Roughness", "Phase Offset"),
    )
    vector = writer.value(node.input("Vector"), "vec3")
    p = writer.let("vec3", f"off_whole({vector} * {scale})")
    direction = node.setting("direction")
    if node.setting("type") == "BANDS":
        along = _BANDS[direction].replace("p", p)
    else:
        along = f"20.0 * length({_RINGS[direction].replace('p', p, 1)})"
    clamped = f"clamp({detail}, 0.0, 15.0)"
    rough = f"max({roughness}, 0.0)"
    noise = f"noise_fbm(vec4({p} * {detail_scale}, 0.0), {clamped}, {rough}, 2.0, true, 3)"
    moved = f"({distortion} != 0.0 ? {distortion} * ({noise} * 2.0 - 1.0) : 0.0)"
    at = writer.let("float", f"{along} + {phase} + {moved}")
    value = writer.let("float", f"wave_profile({at}, WAVE_{node.setting('profile')})")
    return {"Fac": ("float", value), "Color": ("color", f"vec3({value})")}


@generates("magic", _PATTERNS)
def _magic(node, writer):
    vector = writer.value(node.input("Vector"), "vec3")
    scale, distortion = _floats(node, writer, "Scale", "Distortion")
    pattern = f"magic_pattern({vector}, {scale}, {node.setting('depth')}, {distortion})"
    color = writer.let("vec3", pattern)
    return {"Color": ("color", color), "Fac": ("float", f"dot({color}, vec3(1.0 / 3.0))")}


@generates("checker", _PATTERNS)
def _checker(node, writer):
    vector = writer.value(node.input("Vector"), "vec3")
    (scale,) = _floats(node, writer, "Scale")
    share = writer.let("float", f"checker_pattern({vector} * {scale})")
    first, second = (writer.value(node.input(name), "vec3") for name in ("Color1", "Color2"))
    color = writer.let("vec3", f"({share} > 0.5) ? {first} : {second}")
    return {"Color": ("color", color), "Fac": ("float", share)}


@generates("brick", _PATTERNS)
def _brick(node, writer):
    vector = writer.value(node.input("Vector"), "vec3")
    (scale,) = _floats(node, writer, "Scale")
    sizes = _floats(
        node, writer, "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height"
    )
    offset, every, squash, squash_every = _floats(
        node, writer, "Offset", "Offset Every", "Squash", "Squash Every"
    )
    rows = f"{offset}, int({every}), {squash}, int({squash_every})"
    shares = writer.let("vec2", f"brick_pattern({vector} * {scale}, {', '.join(sizes)}, {rows})")
    first, second, mortar = (
        writer.value(node.input(name), "vec3") for name in ("Color1", "Color2", "Mortar")
    )
    brick = f"mix({first}, {second}, {shares}.x)"
    color = writer.let("vec3", f"mix({brick}, {mortar}, {shares}.y)")
    return {"Color": ("color", color), "Fac": ("float", f"{shares}.y")}


@generates("gradient", _PATTERNS)
def _gradient(node, writer):
    vector = writer.value(node.input("Vector"), "vec3")
    pattern = f"gradient_pattern({vector}, GRADIENT_{node.setting('type')})"
    value = writer.let("float", pattern)
    return {"Fac": ("float", value), "Color": ("color", f"vec3({value})")}


@generates("gabor", "lib/nodes/gabor_lib.glsl")
def _gabor(node, writer):
    vector = writer.value(node.input("Vector"), "vec3")
    scale, frequency, anisotropy = _floats(node, writer, "Scale", "Frequency", "Anisotropy")
    if node.setting("type") == "2D":
        (turned,) = _floats(node, writer, "Orientation 2D")
        call = f"gabor_flat(({vector} * {scale}).xy, {frequency}, {anisotropy}, {turned})"
    else:
        turned = writer.value(node.input("Orientation 3D"), "vec3")
        call = f"gabor_solid({vector} * {scale}, {frequency}, {anisotropy}, {turned})"
    found = writer.let("vec3", call)
    return {
        name: ("float", f"{found}.{axis}")
        for name, axis in zip(("Value", "Phase", "Intensity"), "xyz", strict=True)
    }


@generates("radial_tiling", "lib/nodes/tiling_lib.glsl")
def _radial_tiling(node, writer):
    vector = writer.value(node.input("Vector"), "vec3")
    sides, roundness = _floats(node, writer, "Sides", "Roundness")
    normalizes = "true" if node.setting("normalize") else "false"
    found = writer.let(
        "Tiling", f"radial_tiling(({vector}).xy, {sides}, {roundness}, {normalizes})"
    )
    return {
        "Segment Coordinates": ("vec3", f"vec3({found}.place, 0.0)"),
        "Segment ID": ("float", f"{found}.id"),
        "Segment Width": ("float", f"{found}.width"),
        "Segment Rotation": ("float", f"{found}.rotation"),
    }
