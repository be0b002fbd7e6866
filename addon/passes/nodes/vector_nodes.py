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


_NORMALS = "lib/nodes/normal_nodes_lib.glsl"


@generates("bump", _NORMALS)
def _bump(node, writer):
    writer.normal()
    height = writer.let("float", writer.value(node.input("Height"), "float"))
    strength, distance = (
        writer.value(node.input(name), "float") for name in ("Strength", "Distance")
    )
    sign = "-" if node.setting("invert") else ""
    normal = writer.given_normal(node)
    bent = f"bump_normal({height}, {strength}, {sign}{distance}, {normal})"
    return {"Normal": ("vec3", writer.let("vec3", bent))}


@generates("normal_map", _NORMALS)
def _normal_map(node, writer):
    writer.normal()
    color = writer.value(node.input("Color"), "vec3")
    if node.setting("directx"):
        color = writer.let("vec3", color)
        color = f"vec3({color}.x, 1.0 - {color}.y, {color}.z)"
    strength = writer.value(node.input("Strength"), "float")
    space = node.setting("space")
    if space == "TANGENT":
        key = f"tangent:{node.setting('name')}"
        if key not in writer.available or "normal" not in writer.available:
            return {"Normal": ("vec3", writer.let("vec3", "point_normal()"))}
        tangent, normal = writer.attribute(key), writer.attribute("normal")
        bent = f"tangent_space_normal({color}, {strength}, {tangent}, {normal})"
        return {"Normal": ("vec3", writer.let("vec3", bent))}
    if space.startswith("BLENDER"):
        color = writer.let("vec3", color)
        color = f"vec3({color}.x, 1.0 - {color}.yz)"
    of_object = "true" if space.endswith("OBJECT") else "false"
    bent = f"spatial_normal({color}, {strength}, {of_object})"
    return {"Normal": ("vec3", writer.let("vec3", bent))}


@generates("normal", "lib/surface/vector_lib.glsl")
def _normal(node, writer):
    direction = writer.value(node.input("Direction"), "vec3")
    normal = writer.value(node.input("Normal"), "vec3")
    product = f"dot(safe_normalize({direction}), safe_normalize({normal}))"
    return {"Normal": ("vec3", direction), "Dot": ("float", writer.let("float", product))}


_AXES = {"X_AXIS": "vec3(1, 0, 0)", "Y_AXIS": "vec3(0, 1, 0)", "Z_AXIS": "vec3(0, 0, 1)"}


@generates("vector_rotate", _NORMALS)
def _vector_rotate(node, writer):
    vector, center = (writer.value(node.input(name), "vec3") for name in ("Vector", "Center"))
    inverts, kind = node.setting("invert"), node.setting("type")
    if kind == "EULER_XYZ":
        turn = f"euler_matrix({writer.value(node.input('Rotation'), 'vec3')})"
        turn = f"transpose({turn})" if inverts else turn
        turned = f"{turn} * ({vector} - {center}) + {center}"
    else:
        axis = _AXES.get(kind) or writer.value(node.input("Axis"), "vec3")
        angle = ("-" if inverts else "") + writer.value(node.input("Angle"), "float")
        turned = f"rotate_about({vector}, {center}, {axis}, {angle})"
    return {"Vector": ("vec3", writer.let("vec3", turned))}


@generates("vector_transform", _NORMALS)
def _vector_transform(node, writer):
    vector = writer.value(node.input("Vector"), "vec3")
    start, end = (f"SPACE_{node.setting(name)}" for name in ("from", "to"))
    kind = node.setting("type")
    if kind == "NORMAL":
        turned = f"normal_between({vector}, {start}, {end})"
    else:
        what = "place" if kind == "POINT" else "direction"
        turned = f"{what}_from_world({what}_to_world({vector}, {start}), {end})"
    return {"Vector": ("vec3", writer.let("vec3", turned))}


@generates("displacement", _NORMALS)
def _displacement(node, writer):
    writer.normal()
    middle, scale = (writer.value(node.input(name), "float") for name in ("Midlevel", "Scale"))
    space = node.setting("space")
    if node.setting("kind") == "HEIGHT":
        height = f"({writer.value(node.input('Height'), 'float')} - {middle}) * {scale}"
    else:
        moved = writer.let(
            "vec3", f"({writer.value(node.input('Vector'), 'vec3')} - {middle}) * {scale}"
        )
        # In tangent space y is along the normal.
        along = "point_normal()"
        if space == "OBJECT":
            along = "unit_or(normal_to_object(point_object(), point_normal()), vec3(0.0))"
        height = f"{moved}.y" if space == "TANGENT" else f"dot({moved}, {along})"
    name = writer.let("float", height)
    bent = f"bump_normal({name}, 1.0, 1.0, point_normal())"
    if space != "WORLD":
        bent = f"bump_normal_of_object({name}, point_normal())"
    writer.lines.append(f"  point_bent = {bent};")
    return {}
