"""Many small cards in one picture, each with a material that glows with what a node gives."""

import math

import numpy as np

# Pixels along a side of a card; its outermost ones are not compared.
CELL_PX = 8
# Width around the pixel's middle in which Cycles' sample lies, in pixels.
TINY_FILTER = 0.01


def build_sheet(bpy, cases, orthographic=False):
    """Replace the open file by a scene with a card for each case.

    Parameters
    ----------
    bpy : module
    cases : sequence of Case
    orthographic : bool
        The camera's projection.

    Returns
    -------
    bpy.types.Scene
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    columns = math.ceil(math.sqrt(len(cases)))
    scene.render.resolution_x = scene.render.resolution_y = columns * CELL_PX
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO" if orthographic else "PERSP"
    camera.data.ortho_scale = 2.0 * columns
    camera.location = (0.3, -0.2, 3.0 * columns)
    camera.data.shift_x, camera.data.shift_y = (
        (-0.3, 0.2) if orthographic else (-0.1 / columns, 0.2 / (3 * columns))
    )
    camera.data.sensor_width, camera.data.lens = 36.0, 54.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    if not orthographic:
        camera.data.shift_x = -0.3 / (2.0 * columns)
        camera.data.shift_y = 0.2 / (2.0 * columns)
    else:
        camera.location.x = camera.location.y = camera.data.shift_x = camera.data.shift_y = 0.0
    image = picture(bpy)
    for number, case in enumerate(cases):
        row, column = divmod(number, columns)
        place = (2.0 * column - columns + 1.0, 2.0 * row - columns + 1.0, 0.0)
        mesh = _dome(bpy) if case.shape == "dome" else card(bpy)
        thing = bpy.data.objects.new(f"card {number}", mesh)
        thing.location = place
        thing.scale = (1.0, 1.0, 0.7)
        thing.color = (0.2 + 0.05 * (number % 9), 0.7, 0.1, 0.6)
        thing.pass_index = number % 3
        scene.collection.objects.link(thing)
        material = bpy.data.materials.new(f"material {number}")
        material.pass_index = 1
        mesh.materials.append(material)
        _fill(bpy, material.node_tree, case, image)
    return scene


def compare(cases, ours, cycles):
    """Return the largest difference of each case, in 1/255 of the sRGB encoded picture.

    Parameters
    ----------
    cases : sequence of Case
    ours, cycles : ndarray of shape (height, width, 4)
        Scene linear, top row first.

    Returns
    -------
    list of float
    """
    columns = math.ceil(math.sqrt(len(cases)))
    found = []
    for number, case in enumerate(cases):
        row, column = divmod(number, columns)
        inner = tuple(slice(i * CELL_PX + 1, (i + 1) * CELL_PX - 1) for i in (row, column))
        a, b = (encoded(shown[::-1][inner][..., :3]) for shown in (ours, cycles))
        difference = np.sort(np.abs(a - b).max(axis=2).ravel())
        left_out = int(case.exempt * difference.size)
        found.append(float(difference[difference.size - 1 - left_out]))
    return found


def encoded(linear):
    """Return linear colours as the displayed picture has them, 0 to 255."""
    x = np.clip(np.nan_to_num(linear.astype(np.float64), posinf=1e6), 0.0, 1.0)
    encoded = np.where(x <= 0.0031308, x * 12.92, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    return 255.0 * encoded


def picture(bpy):
    """Make an image of 4 x 3 random colours."""
    pixels = np.random.default_rng(5).random((3, 4, 4)).astype(np.float32)
    pixels[..., 3] = 1.0
    image = bpy.data.images.new("picture", 4, 3, alpha=True, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels.reshape(-1))
    image.update()
    image.pack()
    return image


def _grid(bpy, steps, height):
    """Make a card of 2 x 2 m, from -1 to 1, bulging up to a height in the middle.

    At most as many triangles as pixels: with more, Aplanat draws pixels as means of several places.
    """
    mesh = bpy.data.meshes.new("card")
    line = np.linspace(-1.0, 1.0, steps + 1)
    # No edge of a triangle runs through the middle of a pixel.
    x, y = np.meshgrid(line + 0.11 * (1.0 - line**2), line - 0.07 * (1.0 - line**2))
    z = height * (1.0 - 0.5 * (x**2 + y**2))
    corners = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    first = (np.arange(steps)[:, None] * (steps + 1) + np.arange(steps)).reshape(-1, 1)
    faces = first + np.array([0, 1, steps + 2, steps + 1])
    mesh.from_pydata(corners.tolist(), [], faces.tolist())
    layer = mesh.uv_layers.new(name="UVMap")
    uv = 0.5 * corners[faces.reshape(-1), :2] + 0.5
    layer.uv.foreach_set("vector", np.ascontiguousarray(uv, np.float32).reshape(-1))
    colors = mesh.color_attributes.new("Col", "FLOAT_COLOR", "POINT")
    values = np.concatenate([0.5 * corners + 0.5, np.full((len(corners), 1), 0.5)], axis=1)
    colors.data.foreach_set("color", np.ascontiguousarray(values, np.float32).reshape(-1))
    return mesh


def card(bpy):
    """Make a flat card of 2 x 2 m with a UV map and a colour attribute."""
    return _grid(bpy, 1, 0.0)


def _dome(bpy):
    mesh = _grid(bpy, 5, 0.8)
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    return mesh


def _fill(bpy, tree, case, image):
    tree.nodes.clear()
    nodes, links = tree.nodes, tree.links
    output, emission = (nodes.new(f"ShaderNode{k}") for k in ("OutputMaterial", "Emission"))
    links.new(emission.outputs[0], output.inputs["Surface"])
    node = nodes.new(f"ShaderNode{case.node}")
    for name, value in case.settings.items():
        setattr(node, name, value)
    if case.prepare is not None:
        case.prepare(bpy, node)
    for name, value in case.inputs.items():
        socket = _socket(node.inputs, name)
        if isinstance(value, str):
            links.new(_source(tree, value, image), socket)
        elif socket.type == "RGBA":
            socket.default_value = (*value, 1.0)[:4]
        else:
            socket.default_value = value
    shown = _socket(node.outputs, case.output)
    if case.output == "Displacement":
        # What it does is shown, to the normal.
        links.new(shown, output.inputs["Displacement"])
        shown = nodes.new("ShaderNodeNewGeometry").outputs["Normal"]
    if shown.type == "VECTOR":
        half = nodes.new("ShaderNodeVectorMath")
        half.operation = "MULTIPLY_ADD"
        half.inputs[1].default_value = half.inputs[2].default_value = (0.5, 0.5, 0.5)
        links.new(shown, half.inputs[0])
        shown = half.outputs[0]
    elif shown.type == "SHADER":
        links.new(shown, output.inputs["Surface"])
        return
    links.new(shown, emission.inputs["Color"])
    emission.inputs["Strength"].default_value = case.gain


def _socket(sockets, name):
    enabled = [s for s in sockets if s.enabled and name in {s.identifier, s.name}]
    return (enabled or [s for s in sockets if name in {s.identifier, s.name}])[0]


def _source(tree, name, image):
    nodes, links = tree.nodes, tree.links
    coordinates = nodes.new("ShaderNodeTexCoord")
    if name in {"uv", "object", "generated"}:
        return coordinates.outputs[{"uv": "UV"}.get(name, name.capitalize())]
    if name == "place":
        return nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    if name in {"straight up", "nowhere"}:
        up = nodes.new("ShaderNodeCombineXYZ")
        up.inputs["Z"].default_value = 1.0 if name == "straight up" else 0.0
        return up.outputs[0]
    if name == "color":
        texture = nodes.new("ShaderNodeTexImage")
        texture.image = image
        return texture.outputs["Color"]
    if name == "bent":
        mixed = nodes.new("ShaderNodeVectorMath")
        mixed.operation = "MULTIPLY_ADD"
        mixed.inputs[1].default_value = (0.6, 0.5, 0.0)
        mixed.inputs[2].default_value = (-0.3, -0.2, 1.0)
        links.new(coordinates.outputs["UV"], mixed.inputs[0])
        unit = nodes.new("ShaderNodeVectorMath")
        unit.operation = "NORMALIZE"
        links.new(mixed.outputs[0], unit.inputs[0])
        return unit.outputs[0]
    if name == "steps":
        # Few digits, so that both engines have the same bits.
        steps = nodes.new("ShaderNodeVectorMath")
        steps.operation = "FLOOR"
        links.new(_source(tree, "signed", image), steps.inputs[0])
        return steps.outputs[0]
    if name == "signed":
        scaled = nodes.new("ShaderNodeVectorMath")
        scaled.operation = "MULTIPLY_ADD"
        scaled.inputs[1].default_value = (4.0, 4.0, 0.0)
        scaled.inputs[2].default_value = (-2.0, -2.0, 0.3)
        links.new(coordinates.outputs["UV"], scaled.inputs[0])
        return scaled.outputs[0]
    parts = nodes.new("ShaderNodeSeparateXYZ")
    links.new(coordinates.outputs["UV"], parts.inputs[0])
    return parts.outputs[name.upper()]
