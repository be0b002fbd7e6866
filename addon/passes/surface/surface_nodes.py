"""One generator of GLSL a kind of `ShaderNode`.

A generator takes the node and a `Writer` and returns the type and expression of each output by the
socket's identifier; types are GLSL's, and ``"color"`` for a vec3 that converts to a number as its
luminance.
"""

from .surface_registry import generator_registry

GENERATORS, generates = generator_registry()


@generates("none")
def _none(node, writer):
    name = writer.closure("BSDF", "closure_none()")
    writer.dark.add(name["BSDF"][1])
    return name


@generates("emission")
def _emission(node, writer):
    color = writer.value(node.input("Color"), "vec3")
    strength = writer.value(node.input("Strength"), "float")
    return writer.closure("Emission", f"closure_emission({color}, {strength})")


@generates("diffuse")
def _diffuse(node, writer):
    writer.light()
    color = writer.value(node.input("Color"), "vec3")
    return writer.closure("BSDF", f"closure_diffuse({color})")


@generates("glossy")
def _glossy(node, writer):
    writer.light()
    color = writer.value(node.input("Color"), "vec3")
    roughness = writer.value(node.input("Roughness"), "float")
    repeats = "true" if node.setting("multiple_scattering") else "false"
    return writer.closure("BSDF", f"closure_glossy({color}, {roughness}, {repeats})")


@generates("principled")
def _principled(node, writer):
    writer.light()
    arguments = ", ".join(
        writer.value(node.input(name), kind)
        for name, kind in (
            ("Base Color", "vec3"),
            ("Metallic", "float"),
            ("Roughness", "float"),
            ("IOR", "float"),
            ("Specular IOR Level", "float"),
            ("Specular Tint", "vec3"),
            ("Emission Color", "vec3"),
            ("Emission Strength", "float"),
        )
    )
    surface = writer.let("Closure", f"closure_principled({arguments})")
    alpha = dict(node.inputs).get("Alpha")
    if alpha is None:
        return {"BSDF": ("closure", surface)}
    covered = writer.closure("BSDF", f"closure_cover({surface}, {writer.value(alpha, 'float')})")
    writer.transmitting.add(covered["BSDF"][1])
    return covered


@generates("transparent")
def _transparent(node, writer):
    color = writer.value(node.input("Color"), "vec3")
    result = writer.closure("BSDF", f"closure_transparent({color})")
    writer.transmitting.add(result["BSDF"][1])
    writer.dark.add(result["BSDF"][1])
    return result


@generates("holdout")
def _holdout(node, writer):
    # A holdout has no light but is not `dark`: its hole must not depend on the random opacity.
    return writer.closure("Holdout", "closure_holdout()")


@generates("mix_shader")
def _mix_shader(node, writer):
    factor = writer.value(node.input("Fac"), "float")
    first = writer.value(node.input("Shader"), "closure")
    second = writer.value(node.input("Shader_001"), "closure")
    result = writer.closure("Shader", f"closure_mix({first}, {second}, {factor})")
    name = result["Shader"][1]
    if {first, second} & writer.transmitting:
        writer.transmitting.add(name)
    if {first, second} <= writer.dark:
        writer.dark.add(name)
    return result


@generates("add_shader")
def _add_shader(node, writer):
    first = writer.value(node.input("Shader"), "closure")
    second = writer.value(node.input("Shader_001"), "closure")
    result = writer.closure("Shader", f"closure_add({first}, {second})")
    name = result["Shader"][1]
    if {first, second} & writer.transmitting:
        writer.transmitting.add(name)
        # Light that does not fade as the surface gets more transparent.
        writer.glows = writer.glows or not {first, second} <= writer.dark
    if {first, second} <= writer.dark:
        writer.dark.add(name)
    return result


@generates("uv")
def _uv(node, writer):
    uv = writer.attribute(f"uv:{node.setting('name')}")
    return {"UV": ("vec3", f"vec3({uv}, 0.0)")}


@generates("generated")
def _generated(node, writer):
    return {"Generated": ("vec3", writer.attribute("generated"))}


@generates("color_attribute")
def _color_attribute(node, writer):
    value = writer.attribute(f"color:{node.setting('name')}")
    return {"Color": ("color", f"{value}.rgb"), "Alpha": ("float", f"{value}.a")}


@generates("attribute")
def _attribute(node, writer):
    name = node.setting("name")
    if f"color:{name}" in writer.available:
        value = writer.attribute(f"color:{name}")
        color, alpha = f"{value}.rgb", f"{value}.a"
    else:
        # A mesh without the attribute gives zeros, and an alpha of 1 only where there is a value.
        present = f"uv:{name}" in writer.available
        uv = writer.attribute(f"uv:{name}")
        color, alpha = f"vec3({uv}, 0.0)", "1.0" if present else "0.0"
    return {
        "Color": ("color", color),
        "Vector": ("vec3", color),
        "Fac": ("vec3", color),
        "Alpha": ("float", alpha),
    }


@generates("affine")
def _affine(node, writer):
    vector = writer.let("vec3", writer.value(node.input("Vector"), "vec3"))
    rows = [writer.value(node.input(axis), "vec3") for axis in "XYZ"]
    products = ", ".join(f"dot({row}, {vector})" for row in rows)
    offset = writer.value(node.input("Offset"), "vec3")
    return {"Vector": ("vec3", writer.let("vec3", f"vec3({products}) + {offset}"))}


@generates("mapping")
def _mapping(node, writer):
    kind = node.setting("type")
    names = ["Vector", *(["Location"] if kind in {"POINT", "TEXTURE"} else []), "Rotation", "Scale"]
    arguments = ", ".join(writer.value(node.input(name), "vec3") for name in names)
    return {"Vector": ("vec3", writer.let("vec3", f"mapping_{kind.lower()}({arguments})"))}


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
