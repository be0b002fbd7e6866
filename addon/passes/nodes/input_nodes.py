"""Generators of GLSL for what a tree reads of the mesh, the object and the camera."""

from .registry import generator_registry

GENERATORS, generates = generator_registry()


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
