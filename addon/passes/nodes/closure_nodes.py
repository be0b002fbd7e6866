"""Generators of GLSL for closures."""

from .registry import generator_registry

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
    members = {"color": writer.value(node.input("Color"), "vec3")}
    roughness = dict(node.inputs).get("Roughness")
    if roughness is not None:
        members["shape"] = _shape(writer, "ROUGH", writer.value(roughness, "float"))
    return writer.lit_closure("BSDF", "BSDF_DIFFUSE", members | _normal(node, writer))


def _shape(writer, kind, *numbers, tangent="vec3(0.0)"):
    """Return a shape of diffuse light; see lib/surface/shapes_lib.glsl."""
    writer.features.add("SHAPES")
    numbers = ", ".join([*numbers, *["0.0"] * (4 - len(numbers))])
    return f"Shape(SHAPE_{kind}, vec4({numbers}), {tangent})"


@generates("sheen")
def _sheen(node, writer):
    roughness = f"clamp({writer.value(node.input('Roughness'), 'float')}, 0.0, 1.0)"
    members = {
        "color": writer.value(node.input("Color"), "vec3"),
        "shape": _shape(writer, node.setting("distribution"), roughness),
    }
    return writer.lit_closure("BSDF", "BSDF_DIFFUSE", members | _normal(node, writer))


@generates("toon")
def _toon(node, writer):
    # Shares of a right angle.
    size, smooth = (
        f"1.5707963 * clamp({writer.value(node.input(name), 'float')}, {least}, 1.0)"
        for name, least in (("Size", "1e-5"), ("Smooth", "0.0"))
    )
    members = {
        "color": writer.value(node.input("Color"), "vec3"),
        "shape": _shape(writer, node.setting("component"), size, smooth),
    }
    return writer.lit_closure("BSDF", "BSDF_DIFFUSE", members | _normal(node, writer))


@generates("hair", "lib/nodes/input_nodes_lib.glsl")
def _hair(node, writer):
    writer.normal()
    along, around = (writer.value(node.input(f"Roughness{a}"), "float") for a in "UV")
    given = dict(node.inputs).get("Tangent")
    if given is None:
        tangent = f"tangent_of({writer.attribute('tangent:')}.xyz)"
    else:
        tangent = f"unit_or({writer.value(given, 'vec3')}, vec3(0.0))"
    tangent = writer.let("vec3", tangent)
    members = {
        "color": writer.value(node.input("Color"), "vec3"),
        "shape": _shape(writer, node.setting("component"), along, around, tangent=tangent),
    }
    return writer.lit_closure("BSDF", "BSDF_DIFFUSE", members)


@generates("hair_color")
def _hair_color(node, writer):
    absorbed, roughness = (
        writer.let("vec3", writer.value(node.input("Absorption"), "vec3")),
        writer.let("float", writer.value(node.input("Roughness"), "float")),
    )
    # Chiang et al., A practical and controllable hair and fur model, 2016: colour of many strands.
    terms = "5.969 + r * (-0.215 + r * (2.532 + r * (-10.73 + r * (5.574 + r * 0.245))))"
    spread = writer.let("float", terms.replace("r ", f"{roughness} "))
    color = f"exp(-sqrt(max({absorbed}, vec3(0.0))) * {spread})"
    return {"Color": ("color", writer.let("vec3", color))}


@generates("glossy")
def _glossy(node, writer):
    members = {
        "color": writer.value(node.input("Color"), "vec3"),
        "roughness": writer.value(node.input("Roughness"), "float"),
        "repeats": "true" if node.setting("multiple_scattering") else "false",
    }
    return writer.lit_closure("BSDF", "BSDF_GLOSSY", members | _normal(node, writer))


def _normal(node, writer):
    """Return the normal of a closure as a member, where a node gives it."""
    normal = dict(node.inputs).get("Normal")
    return {} if normal is None else {"normal": writer.value(normal, "vec3")}


_PRINCIPLED = {
    "color": ("Base Color", "vec3"),
    "metallic": ("Metallic", "float"),
    "roughness": ("Roughness", "float"),
    "ior": ("IOR", "float"),
    "specular_level": ("Specular IOR Level", "float"),
    "specular_tint": ("Specular Tint", "vec3"),
    "emission_color": ("Emission Color", "vec3"),
    "emission_strength": ("Emission Strength", "float"),
}


# Where a surface has them.
_ON_TOP = {
    "transmission": ("Transmission Weight", "float"),
    "coat": ("Coat Weight", "float"),
    "coat_roughness": ("Coat Roughness", "float"),
    "coat_ior": ("Coat IOR", "float"),
    "coat_tint": ("Coat Tint", "vec3"),
    "coat_normal": ("Coat Normal", "vec3"),
    "sheen": ("Sheen Weight", "float"),
    "sheen_roughness": ("Sheen Roughness", "float"),
    "sheen_tint": ("Sheen Tint", "vec3"),
}


@generates("principled")
def _principled(node, writer):
    members = {
        member: writer.value(node.input(name), kind) for member, (name, kind) in _PRINCIPLED.items()
    }
    given = dict(node.inputs)
    for member, (name, kind) in _ON_TOP.items():
        if name in given:
            members[member] = writer.value(given[name], kind)
    if "Coat Weight" in given:
        writer.features.add("COATED")
    if "Sheen Weight" in given:
        writer.features |= {"SHEEN", "SHAPES"}
    if "Diffuse Roughness" in given:
        rough = writer.value(given["Diffuse Roughness"], "float")
        members["shape"] = _shape(writer, "ROUGH", rough)
    surface = writer.lit_closure("BSDF", "BSDF_PRINCIPLED", members | _normal(node, writer))
    if "Transmission Weight" in given:
        _see_through(writer, surface, node.input("Base Color"))
    alpha = dict(node.inputs).get("Alpha")
    if alpha is None:
        return surface
    cover = f"closure_cover({surface['BSDF'][1]}, {writer.value(alpha, 'float')})"
    covered = writer.closure("BSDF", cover)
    writer.transmitting.add(covered["BSDF"][1])
    return covered


@generates("translucent")
def _translucent(node, writer):
    writer.features.add("OTHER_CLOSURES")
    members = {"color": writer.value(node.input("Color"), "vec3")}
    return writer.lit_closure("BSDF", "BSDF_TRANSLUCENT", members | _normal(node, writer))


@generates("metallic")
def _metallic(node, writer):
    writer.features.add("OTHER_CLOSURES")
    members = {
        "color": writer.value(node.input("Color"), "vec3"),
        "specular_tint": writer.value(node.input("Edge Tint"), "vec3"),
        "roughness": writer.value(node.input("Roughness"), "float"),
        "repeats": "true" if node.setting("multiple_scattering") else "false",
    }
    return writer.lit_closure("BSDF", "BSDF_METALLIC", members | _normal(node, writer))


@generates("glass")
def _glass(node, writer):
    writer.features.add("OTHER_CLOSURES")
    members = {
        "color": writer.value(node.input("Color"), "vec3"),
        "roughness": writer.value(node.input("Roughness"), "float"),
        "ior": writer.value(node.input("IOR"), "float"),
        "repeats": "true" if node.setting("multiple_scattering") else "false",
        # What only refracts mirrors nothing.
        "specular_level": "1.0" if node.setting("mirrors") else "0.0",
    }
    glass = writer.lit_closure("BSDF", "BSDF_GLASS", members | _normal(node, writer))
    _see_through(writer, glass, node.input("Color"))
    return glass


def _see_through(writer, outputs, color):
    writer.features.add("GLASS")
    if writer.straight:
        writer.filter(color)
        writer.transmitting.add(outputs["BSDF"][1])
    else:
        # What it shows of what is behind it is its own light.
        writer.refracts = True


@generates("fog", "lib/nodes/fog_lib.glsl")
def _fog(node, writer):
    writer.features |= {"FOG", "SHAPES"}
    writer.normal()
    corners = ", ".join(writer.attribute(key) for key in ("lowest", "highest"))
    scattered, absorbed = (
        writer.let("vec3", f"max({writer.value(node.input(name), 'vec3')}, vec3(0.0))")
        for name in ("Scatter", "Absorption")
    )
    members = {
        "color": scattered,
        "extinction": f"{scattered} + {absorbed}",
        "emission_color": writer.value(node.input("Emission"), "vec3"),
        "thickness": f"fog_thickness({writer.place()}, {corners})",
        "shape": _shape(writer, "FOG", writer.value(node.input("Anisotropy"), "float")),
    }
    writer.filter(node.input("Scatter"), node.input("Absorption"))
    fog = writer.lit_closure("Volume", "BSDF_FOG", members)
    writer.transmitting.add(fog["Volume"][1])
    writer.glows = True
    return fog


@generates("transparent")
def _transparent(node, writer):
    color = writer.value(node.input("Color"), "vec3")
    writer.filter(node.input("Color"))
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
