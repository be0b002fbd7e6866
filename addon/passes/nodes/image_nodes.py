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


@generates("image_texture")
def _image_texture(node, writer):
    uv = f"({writer.value(node.input('Vector'), 'vec3')}).xy"
    function = f"image_{node.setting('interpolation', 'Linear').lower()}"
    extension = f"EXTENSION_{node.setting('extension', 'REPEAT')}"
    expression = f"{function}({writer.image(node.image)}, {uv}, {extension})"
    if node.setting("associated") and writer.uses(node, "Alpha"):
        # Where alpha is not asked for, colour stays multiplied by it, as in Cycles and EEVEE.
        expression = f"image_unassociate({expression})"
    texel = writer.let("vec4", expression)
    if node.setting("encoding") == "srgb":
        texel = writer.let("vec4", f"vec4(srgb_to_linear({texel}.rgb), {texel}.a)")
    return {"Color": ("color", f"{texel}.rgb"), "Alpha": ("float", f"{texel}.a")}
