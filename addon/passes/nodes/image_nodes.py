"""Generators of GLSL for images."""

from .registry import generator_registry

GENERATORS, generates = generator_registry()


@generates("environment_texture")
def _environment_texture(node, writer):
    rows = ", ".join(writer.value(node.input(axis), "vec3") for axis in "XYZ")
    texel = writer.let("vec4", f"environment_sample({writer.image(node.image)}, {rows})")
    color = f"{texel}.rgb"
    if node.setting("encoding") == "srgb":
        color = writer.let("vec3", f"srgb_to_linear({color})")
    return {"Color": ("color", color)}


_PROJECTION = "lib/nodes/projection_lib.glsl"
# Places in an image, of a vector.
_FLAT = {
    "FLAT": "({}).xy",
    "SPHERE": "project_sphere({})",
    "TUBE": "project_tube({})",
    "EQUIRECTANGULAR": "project_equirectangular({})",
    "IES": "project_photometric({})",
    "SKY": "project_sky({})",
    "MIRROR_BALL": "project_mirror_ball({})",
}


@generates("image_texture", _PROJECTION, "lib/nodes/tiles_lib.glsl")
def _image_texture(node, writer):
    vector = writer.value(node.input("Vector"), "vec3")
    projection = node.setting("projection", "FLAT")
    if projection == "BOX":
        texel = _box(node, writer, writer.let("vec3", vector))
    else:
        texel = _texel(node, writer, _FLAT[projection].format(vector))
    return {"Color": ("color", f"{texel}.rgb"), "Alpha": ("float", f"{texel}.a")}


def _box(node, writer, vector):
    """Write the look-ups of the sides of a box, weighed."""
    writer.normal()
    blend = writer.value(node.input("Blend"), "float")
    normal = writer.let("vec3", "box_normal()")
    weights = writer.let("vec3", f"box_weights({normal}, {blend})")
    sides = [
        f"{weights}.{axis} * {_texel(node, writer, f'box_uv({vector}, {normal}, {number})')}"
        for number, axis in enumerate("xyz")
    ]
    return writer.let("vec4", " + ".join(sides))


_TAPS = {"Closest": 1, "Linear": 2, "Cubic": 4}


def _tiled(node, writer, uv, extension):
    """Write the search for the tile of a place, and return the look-up in it."""
    place = writer.let("vec2", uv)
    first = writer.table(list(node.table))
    # As in Cycles, what is less than a tile below the first row or column is in it.
    slot = writer.let("int", "-1")
    writer.lines.append(
        f"  for (int i = 0; i < {len(node.table)}; i++) {{"
        f" {slot} = (material_buf.constants[{first} + i].xy == trunc({place})) ? i : {slot}; }}"
    )
    taps = _TAPS[node.setting("interpolation", "Linear")]
    grid = f"ivec2({node.setting('grid')})"
    share = f"material_buf.constants[{first} + max({slot}, 0)].zw"
    where = f"{writer.image(node.image)}, {place}, {slot}, {grid}, {share}"
    return f"image_tiled({where}, {taps}, {extension})"


def _texel(node, writer, uv):
    """Write a look-up and return the colour, scene linear, and alpha."""
    function = f"image_{node.setting('interpolation', 'Linear').lower()}"
    extension = f"EXTENSION_{node.setting('extension', 'REPEAT')}"
    expression = f"{function}({writer.image(node.image)}, {uv}, {extension})"
    if node.table:
        expression = _tiled(node, writer, uv, extension)
    if node.setting("associated") and writer.uses(node, "Alpha"):
        # Where alpha is not asked for, colour stays multiplied by it, as in Cycles and EEVEE.
        expression = f"image_unassociate({expression})"
    texel = writer.let("vec4", expression)
    if node.setting("encoding") == "srgb":
        texel = writer.let("vec4", f"vec4(srgb_to_linear({texel}.rgb), {texel}.a)")
    return texel
