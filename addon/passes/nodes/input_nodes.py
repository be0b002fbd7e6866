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
        mean = f"dot({color}, vec3(1.0 / 3.0))"
    else:
        # A mesh without the attribute gives zeros, and an alpha of 1 only where there is a value.
        present = f"uv:{name}" in writer.available
        uv = writer.attribute(f"uv:{name}")
        color, alpha = f"vec3({uv}, 0.0)", "1.0" if present else "0.0"
        mean = f"{uv}.x"
    return {
        "Color": ("color", color),
        "Vector": ("vec3", color),
        "Fac": ("float", mean),
        "Alpha": ("float", alpha),
    }


_POINT = "lib/nodes/point_lib.glsl"
_INPUT = "lib/nodes/input_nodes_lib.glsl"


@generates("geometry", _INPUT)
def _geometry(node, writer):
    writer.normal()
    outputs = {
        "Position": ("vec3", "world_position"),
        "Normal": ("vec3", "point_normal()"),
        "True Normal": ("vec3", "point_true_normal()"),
        "Incoming": ("vec3", "point_view()"),
        "Backfacing": ("float", "point_backfacing()"),
    }
    if writer.uses(node, "Tangent"):
        around = f"tangent_around({writer.attribute('generated')}, 2)"
        outputs["Tangent"] = ("vec3", f"tangent_of({around})")
    return _let_used(node, writer, outputs)


@generates("pointiness")
def _pointiness(node, writer):
    # Flat where a mesh has none.
    known = "pointiness" in writer.available
    value = f"{writer.attribute('pointiness')}.x" if known else "0.5"
    return {"Value": ("float", value)}


@generates("island")
def _island(node, writer):
    return {"Value": ("float", f"{writer.attribute('island')}.x")}


@generates("parametric")
def _parametric(node, writer):
    return {"Value": ("vec3", f"vec3({writer.attribute('barycentric')}, 0.0)")}


@generates("wireframe", "lib/nodes/wireframe_lib.glsl")
def _wireframe(node, writer):
    size = writer.value(node.input("Size"), "float")
    if "barycentric" not in writer.available:
        return {"Fac": ("float", "0.0")}
    place = writer.attribute("barycentric")
    unit = "pixel" if node.setting("pixels") else "world"
    return {"Fac": ("float", writer.let("float", f"wireframe_{unit}({place}, {size})"))}


@generates("texture_coordinate", _INPUT)
def _texture_coordinate(node, writer):
    writer.normal()
    normal = "unit_or(normal_to_object(point_object(), point_normal()), vec3(0.0))"
    outputs = {
        "Normal": ("vec3", normal),
        "Camera": ("vec3", "place_in_camera(world_position)"),
        "Window": ("vec3", "point_window()"),
        "Reflection": ("vec3", "-reflect(point_view(), point_normal())"),
    }
    if writer.uses(node, "Object"):
        outputs["Object"] = ("vec3", writer.place())
    return _let_used(node, writer, outputs)


@generates("object_info", _POINT)
def _object_info(node, writer):
    texels = [
        f"texelFetch(instances_tx, instance_texel(instance_row, {texel}), 0)" for texel in (4, 5)
    ]
    outputs = {
        "Location": ("vec3", "point_object()[3].xyz"),
        "Color": ("color", f"{texels[0]}.rgb"),
        "Alpha": ("float", f"{texels[0]}.a"),
        "Random": ("float", f"{texels[1]}.x"),
        "Object Index": ("float", f"{texels[1]}.y"),
    }
    return _let_used(node, writer, outputs)


@generates("camera_data", _POINT)
def _camera_data(node, writer):
    place = writer.let("vec3", "place_in_camera(world_position)")
    outputs = {
        "View Vector": ("vec3", f"unit_or({place}, vec3(0.0))"),
        "View Z Depth": ("float", f"{place}.z"),
        "View Distance": ("float", f"length({place})"),
    }
    return _let_used(node, writer, outputs)


@generates("fresnel", _INPUT)
def _fresnel(node, writer):
    writer.normal()
    ior, normal = writer.value(node.input("IOR"), "float"), writer.given_normal(node, as_given=True)
    return {"Fac": ("float", writer.let("float", f"node_fresnel({ior}, {normal})"))}


@generates("layer_weight", _INPUT)
def _layer_weight(node, writer):
    writer.normal()
    blend, normal = (
        writer.value(node.input("Blend"), "float"),
        writer.given_normal(node, as_given=True),
    )
    arguments = f"({blend}, {normal})"
    outputs = {
        "Fresnel": ("float", f"layer_fresnel{arguments}"),
        "Facing": ("float", f"layer_facing{arguments}"),
    }
    return _let_used(node, writer, outputs)


@generates("tangent", _INPUT)
def _tangent(node, writer):
    writer.normal()
    name = node.setting("name", None)
    if name is None:
        axis = "XYZ".index(node.setting("axis"))
        around = f"tangent_around({writer.attribute('generated')}, {axis})"
    else:
        around = f"{writer.attribute(f'tangent:{name}')}.xyz"
    return {"Tangent": ("vec3", writer.let("vec3", f"tangent_of({around})"))}


def _let_used(node, writer, outputs):
    """Write a variable for each output that something reads."""
    return {
        name: (kind, writer.let("vec3" if kind == "color" else kind, expression))
        for name, (kind, expression) in outputs.items()
        if writer.uses(node, name)
    }
