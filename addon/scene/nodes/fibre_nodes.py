"""Readers of Blender's closures of cloth, hair and drawings, and of those of other engines."""

from ...snapshot.surface_graph import Constant, Link
from .tree_reader import is_constant, reader_registry

READERS, reads = reader_registry()


@reads("BSDF_SHEEN")
def _sheen(reader, node, groups):
    inputs = reader.values(node, ("Color", "Roughness"), groups) + reader.normal(node, groups)
    kind = "VELVET" if node.distribution == "ASHIKHMIN" else "MICROFIBER"
    return Link(reader.add("sheen", inputs, (("distribution", kind),)), "BSDF")


@reads("BSDF_TOON")
def _toon(reader, node, groups):
    inputs = reader.values(node, ("Color", "Size", "Smooth"), groups)
    inputs += reader.normal(node, groups)
    kind = "TOON_GLOSSY" if node.component == "GLOSSY" else "TOON"
    return Link(reader.add("toon", inputs, (("component", kind),)), "BSDF")


@reads("BSDF_HAIR")
def _hair(reader, node, groups):
    inputs = reader.values(node, ("Color", "RoughnessU", "RoughnessV"), groups)
    if reader.linked(node, "Tangent", groups):
        inputs += reader.values(node, ("Tangent",), groups)
    kind = "HAIR_THROUGH" if node.component == "Transmission" else "HAIR"
    return Link(reader.add("hair", inputs, (("component", kind),)), "BSDF")


# What a unit of black and of red pigment absorbs in a strand's diameter (Chiang et al., 2016).
_EUMELANIN = (0.506, 0.841, 1.653)
_PHEOMELANIN = (0.343, 0.733, 1.924)
# Reflected by the outside of a strand, seen head on.
_CUTICLE = 0.046


@reads("BSDF_HAIR_PRINCIPLED")
def _principled_hair(reader, node, groups):
    reader.note(
        f"node '{node.bl_label}' is drawn as a surface of the colour of many strands, half of its"
        " light from behind"
    )
    color = _strand_color(reader, node, groups)
    half = Constant((0.5,))
    front = Link(reader.add("diffuse", [("Color", color)]), "BSDF")
    back = Link(reader.add("translucent", [("Color", color)]), "BSDF")
    inside = [("Fac", half), ("Shader", front), ("Shader_001", back)]
    rough = reader.value(node, "Roughness", groups)
    around = reader.value(node, "Radial Roughness", groups)
    shine = [("Color", Constant((_CUTICLE,) * 3)), ("RoughnessU", rough), ("RoughnessV", around)]
    outside = Link(reader.add("hair", shine, (("component", "HAIR"),)), "BSDF")
    both = [
        ("Shader", Link(reader.add("mix_shader", inside), "Shader")),
        ("Shader_001", outside),
    ]
    return Link(reader.add("add_shader", both), "Shader")


def _strand_color(reader, node, groups):
    if node.parametrization == "COLOR":
        return reader.value(node, "Color", groups)
    rough = reader.value(node, "Radial Roughness", groups)
    if node.parametrization == "ABSORPTION":
        absorbed = reader.value(node, "Absorption Coefficient", groups)
        tint = Constant((1.0, 1.0, 1.0))
    else:
        absorbed = _of_pigment(reader, node, groups)
        tint = reader.value(node, "Tint", groups)
    inputs = [("Absorption", absorbed), ("Roughness", rough)]
    color = Link(reader.add("hair_color", inputs), "Color")
    if is_constant(tint, 1.0):
        return color
    zero = Constant((0.0, 0.0, 0.0))
    product = [("a", color), ("b", tint), ("c", zero), ("scale", Constant((1.0,)))]
    return Link(reader.add("vector_math", product, (("operation", "MULTIPLY"),)), "Vector")


def _of_pigment(reader, node, groups):
    """Return what the pigment of a strand absorbs: melanin, a share of which is red."""
    amount, red = (reader.value(node, name, groups) for name in ("Melanin", "Melanin Redness"))

    def math(operation, a, b):
        inputs = [("a", a), ("b", b), ("c", Constant((0.0,)))]
        return Link(reader.add("math", inputs, (("operation", operation), ("clamp", ""))), "Value")

    # From a share of light to an amount, as Blender's slider has it.
    left = math("MAXIMUM", math("SUBTRACT", Constant((1.0,)), amount), Constant((0.0001,)))
    pigment = math("MULTIPLY", math("LOGARITHM", left, Constant((2.718281828,))), Constant((-1.0,)))
    reddish = math("MULTIPLY", pigment, red)
    black = math("SUBTRACT", pigment, reddish)
    absorbed = Constant((0.0, 0.0, 0.0))
    for part, color in ((black, _EUMELANIN), (reddish, _PHEOMELANIN)):
        inputs = [("a", part), ("b", Constant(color)), ("c", absorbed), ("scale", Constant((1.0,)))]
        index = reader.add("vector_math", inputs, (("operation", "MULTIPLY_ADD"),))
        absorbed = Link(index, "Vector")
    return absorbed


@reads("BSDF_RAY_PORTAL")
def _ray_portal(reader, node, groups):
    if any(reader.linked(node, name, groups) for name in ("Position", "Direction")):
        reader.note(f"node '{node.bl_label}' shows what is straight behind it")
    return reader.add("transparent", reader.values(node, ("Color",), groups))


@reads("EEVEE_SPECULAR")
def _specular(reader, node, groups):
    """Read what only EEVEE draws: a diffuse base under a reflection of any colour."""
    if not is_constant(reader.value(node, "Clear Coat", groups), 0.0):
        reader.note(f"the clear coat of node '{node.bl_label}' is not drawn")
    normal = reader.normal(node, groups)
    base = [("Color", reader.value(node, "Base Color", groups)), *normal]
    shine = [("Color", reader.value(node, "Specular", groups))]
    shine += [("Edge Tint", Constant((1.0, 1.0, 1.0)))]
    shine += [*reader.values(node, ("Roughness",), groups), *normal]
    glow = [("Color", reader.value(node, "Emissive Color", groups)), ("Strength", Constant((1.0,)))]
    parts = [
        Link(reader.add("diffuse", base), "BSDF"),
        Link(reader.add("metallic", shine, (("multiple_scattering", ""),)), "BSDF"),
        Link(reader.add("emission", glow), "Emission"),
    ]
    whole = parts[0]
    for part in parts[1:]:
        inputs = [("Shader", whole), ("Shader_001", part)]
        whole = Link(reader.add("add_shader", inputs), "Shader")
    clear = reader.value(node, "Transparency", groups)
    if is_constant(clear, 0.0):
        return {"BSDF": whole}
    window = reader.add("transparent", [("Color", Constant((1.0, 1.0, 1.0)))])
    inputs = [("Fac", clear), ("Shader", whole), ("Shader_001", Link(window, "BSDF"))]
    return {"BSDF": Link(reader.add("mix_shader", inputs), "Shader")}
