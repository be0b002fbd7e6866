"""Generators of GLSL for nodes that turn, map and bend vectors."""

from .registry import generator_registry

GENERATORS, generates = generator_registry()


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
