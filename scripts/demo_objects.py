"""What stands on the table of the demo scene: figurine, cup, candle, bauble."""

import math

import bpy
import numpy as np

# isort: split
# Modules of Blender, there once bpy is imported.
import bmesh
from demo_shapes import add, box, emission, lathe, material, paint, sphere
from mathutils import Matrix, Vector


def wood_image(width, depth, shadows):
    """Paint dark planks, darker under what stands on them; distances in metres."""
    columns = 2048
    rows = round(columns * depth / width)
    x = (np.arange(columns) + 0.5) / columns * width
    y = (np.arange(rows)[:, None] + 0.5) / rows * depth
    along = (x + 0.3 * y) / 0.115
    plank = np.floor(along)
    within = along - plank
    tone = 0.75 + 0.5 * np.modf(np.abs(np.sin(plank * 12.9898) * 43758.5453))[0]
    across = within * 40.0 + 2.5 * np.sin(y * 7.0 + plank * 3.0)
    grain = 1.0 + 0.16 * np.sin(across) + 0.10 * np.sin(across * 2.7 + y * 31.0)
    joint = np.clip(np.minimum(within, 1.0 - within) / 0.02, 0.15, 1.0)
    shade = tone * grain * joint
    for cx, cy, radius in shadows:
        distance = np.hypot(x - cx, y - cy) / radius
        shade *= 1.0 - 0.85 * np.exp(-(np.clip(distance - 0.75, 0.0, None) ** 2) * 6.0)
    pixels = np.ones((rows, columns, 4), np.float32)
    # The image is stored as sRGB: about 2.2.
    pixels[..., :3] = (shade[..., None] * np.array((0.20, 0.085, 0.036))) ** (1.0 / 2.2)
    image = bpy.data.images.new("Walnut", columns, rows)
    image.pixels.foreach_set(np.clip(pixels, 0.0, 1.0).reshape(-1))
    image.pack()
    return image


def build_table(shadows):
    """Lay the table and paint it; shadows are (x, y, radius) of what stands on it."""
    width, depth, left, front = 2.6, 1.75, -1.3, -1.1
    data = bpy.data.meshes.new("Table")
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    points = [(left + x * width, front + y * depth, 0.0) for x, y in corners]
    data.from_pydata(points, [], [(0, 1, 2, 3)])
    data.uv_layers.new(name="UVMap").uv.foreach_set("vector", np.ravel(corners).astype(np.float32))
    # A little of the lamps shows through: the images below stand for the polish.
    surface = material("Walnut", (1, 1, 1), roughness=0.38, alpha=0.90)
    tree = surface.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = wood_image(width, depth, [(x - left, y - front, r) for x, y, r in shadows])
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    data.materials.append(surface)
    return add("Table", data, surface)


def build_subject():
    """Put a porcelain bird on two books; return what the camera focuses on."""
    paper = material("Paper", (0.70, 0.60, 0.44), roughness=0.9)
    below = 0.0
    covers = (
        ((0.26, 0.18, 0.034), (0.028, 0.075, 0.16), 5.0),
        ((0.21, 0.15, 0.026), (0.30, 0.022, 0.030), -9.0),
    )
    for index, (size, color, angle) in enumerate(covers):
        cloth = material(f"Cloth {index + 1}", color, roughness=0.65)
        turn = Matrix.Rotation(math.radians(angle), 4, "Z")
        for name, part, surface, height in (
            ("Pages", (size[0] - 0.008, size[1] - 0.008, size[2] - 0.006), paper, size[2] / 2),
            ("Board", (size[0], size[1], 0.003), cloth, 0.0015),
            ("Board", (size[0], size[1], 0.003), cloth, size[2] - 0.0015),
        ):
            place = Matrix.Translation((0.0, 0.0, below + height)) @ turn
            add(name, box(part, 0.001), surface, place, smooth=False)
        spine = Matrix.Translation((0.0, 0.0, below + size[2] / 2)) @ turn
        spine @= Matrix.Translation((0.0, -size[1] / 2, 0.0))
        add("Spine", box((size[0], 0.003, size[2]), 0.001), cloth, spine, smooth=False)
        gold = material(f"Gold band {index + 1}", (0.95, 0.62, 0.20), roughness=0.4)
        for shift in (-0.35, 0.35):
            place = spine @ Matrix.Translation((shift * size[0], -0.0012, 0.0))
            add("Band", box((0.005, 0.0022, size[2] * 0.94)), gold, place, smooth=False)
        below += size[2]
    return build_bird(below)


def build_bird(below):
    """Put a painted porcelain bird on the books; return its place.

    Body, head and tail are metaballs, which flow into each other as clay does, and become a mesh
    that is painted vertex by vertex. The bird looks along -y and a little to the left.
    """
    place = (
        Matrix.Translation((0.0, 0.0, below))
        @ Matrix.Rotation(math.radians(-34), 4, "Z")
        @ Matrix.Scale(1.3, 4)
    )
    body = _porcelain(
        "Bird",
        (
            # Centre, radii, tilt about x in degrees.
            ((0.0, 0.004, 0.046), (0.032, 0.042, 0.035), -24.0),
            ((0.0, -0.012, 0.038), (0.029, 0.030, 0.031), 0.0),
            ((0.0, -0.026, 0.083), (0.0255, 0.0265, 0.0245), 0.0),
            ((0.0, -0.020, 0.064), (0.023, 0.025, 0.026), 0.0),
            ((0.0, 0.050, 0.050), (0.013, 0.034, 0.0085), -30.0),
            ((0.0, 0.083, 0.067), (0.011, 0.030, 0.0055), -26.0),
        ),
        place,
    )
    paint(body, _feathers)
    wings = material("Wing glaze", (0.012, 0.055, 0.16), roughness=0.16)
    for side in (-1, 1):
        wing = sphere(1.0, 48)
        _taper(wing, 0.75)
        turn = (
            Matrix.Translation((side * 0.0285, 0.018, 0.051))
            @ Matrix.Rotation(math.radians(-27), 4, "X")
            @ Matrix.Rotation(math.radians(side * 12), 4, "Z")
            @ Matrix.Diagonal((0.0062, 0.040, 0.0215, 1.0))
        )
        add("Wing", wing, wings, place @ turn)
    horn = material("Beak", (0.75, 0.30, 0.05), roughness=0.3)
    beak = lathe([(0.0078, 0.0), (0.0062, 0.004), (0.0038, 0.0095), (0.0, 0.0165)], 24)
    turn = Matrix.Translation((0.0, -0.0495, 0.081)) @ Matrix.Rotation(math.radians(97), 4, "X")
    add("Beak", beak, horn, place @ turn)
    black = material("Eye", (0.004, 0.004, 0.005), roughness=0.05)
    shine = emission("Glint", (1.0, 0.95, 0.85), 2.5)
    ring = material("Eye ring", (0.86, 0.83, 0.76), roughness=0.2)
    eye = None
    for side in (-1, 1):
        centre = Vector((side * 0.0165, -0.0425, 0.0905))
        out = (centre - Vector((0.0, -0.026, 0.083))).normalized()
        add("Eye ring", sphere(0.0062, 32), ring, place @ Matrix.Translation(centre - 0.0021 * out))
        add("Eye", sphere(0.0052, 32), black, place @ Matrix.Translation(centre))
        spark = centre + 0.0046 * (out + Vector((-0.25, -0.2, 0.55))).normalized()
        add("Glint", sphere(0.00085, 12), shine, place @ Matrix.Translation(spark))
        if side < 0:
            eye = place @ (centre + 0.005 * out)
    gold = material("Gold foot", (0.95, 0.62, 0.20), roughness=0.25)
    foot = [(0.0, 0.010), (0.010, 0.010), (0.0145, 0.006), (0.021, 0.0025), (0.022, 0.0)]
    add("Foot", lathe(foot), gold, place @ Matrix.Translation((0.0, 0.0, 0.0)))
    target = bpy.data.objects.new("Focus", None)
    target.location = eye
    target.empty_display_size = 0.02
    bpy.context.scene.collection.objects.link(target)
    return target


def _porcelain(name, parts, place):
    """Make one smooth mesh of ellipsoids that flow into each other."""
    data = bpy.data.metaballs.new(name)
    data.resolution = data.render_resolution = 0.0016
    data.threshold = 0.35
    for centre, radii, tilt in parts:
        ball = data.elements.new(type="ELLIPSOID")
        # An element's surface lies at about three quarters of its radius at this threshold.
        ball.radius = 1.55 * max(radii)
        ball.size_x, ball.size_y, ball.size_z = (size / max(radii) for size in radii)
        ball.co = centre
        ball.rotation = Matrix.Rotation(math.radians(tilt), 3, "X").to_quaternion()
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(made.evaluated_get(graph))
    bpy.data.objects.remove(made)
    mesh.shade_smooth()
    glaze = material("Glaze", (1.0, 1.0, 1.0), roughness=0.14)
    tree = glaze.node_tree
    colors = tree.nodes.new("ShaderNodeVertexColor")
    colors.layer_name = "Paint"
    tree.links.new(colors.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    mesh.materials.clear()
    mesh.materials.append(glaze)
    return add(name, mesh, None, place)


def _feathers(places):
    """Return the colours of a bluethroat: blue above, an orange breast, a white belly and cheek."""
    x, y, z = places.T
    blue = np.array([0.03, 0.20, 0.46])
    orange = np.array([0.72, 0.17, 0.028])
    white = np.array([0.82, 0.76, 0.66])
    # Fine dark rows on the back, as a brush draws them.
    strokes = 0.82 + 0.18 * np.sin(z * 1500.0 + 3.0 * np.sin(x * 420.0) + y * 380.0)
    back = blue * strokes[:, None]
    breast = _step((-y - 0.012 + 0.35 * (z - 0.05)) / 0.012) * _step((0.074 - z) / 0.006)
    belly = _step((0.036 - z + 0.25 * y) / 0.012)
    cheek = _step(1.0 - np.hypot(np.abs(x) - 0.019, 0.8 * (y + 0.030)) / 0.010)
    cheek *= _step(1.0 - np.abs(z - 0.077) / 0.0075) * _step((-y - 0.012) / 0.004)
    color = back
    for share, paint_color in ((breast, orange), (belly, white), (cheek, white)):
        color = color + share[:, None] * (paint_color - color)
    return color


def _step(value):
    """Go smoothly from 0 at -1 to 1 at 1."""
    t = np.clip(0.5 * value + 0.5, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _taper(mesh, share):
    """Make a unit sphere narrow towards +y, as a folded wing is."""
    for vertex in mesh.verts:
        along = 0.5 * (vertex.co.y + 1.0)
        vertex.co.x *= 1.0 - share * along
        vertex.co.z *= 1.0 - share * along
        vertex.co.z += 0.35 * along * along


def build_cup(place):
    """Put an enamel cup with its saucer on the table."""
    enamel = material("Enamel", (0.014, 0.10, 0.13), roughness=0.18)
    ivory = material("Ivory", (0.72, 0.66, 0.54), roughness=0.3)
    coffee = material("Coffee", (0.020, 0.008, 0.003), roughness=0.08)
    outer = [(0.0, 0.006), (0.022, 0.006), (0.024, 0.008), (0.033, 0.022), (0.039, 0.045)]
    rim = [(0.041, 0.064), (0.0418, 0.0655), (0.0405, 0.0663), (0.0393, 0.0655)]
    inner = [(0.037, 0.045), (0.031, 0.024), (0.020, 0.0115), (0.0, 0.0105)]
    add("Cup", lathe([*outer, *rim, *inner]), enamel, place)
    band = [
        (0.0404, 0.0610),
        (0.0413, 0.0645),
        (0.0418, 0.0660),
        (0.0402, 0.0668),
        (0.0388, 0.0650),
    ]
    add("Rim", lathe(band), ivory, place)
    add("Coffee", lathe([(0.0, 0.055), (0.0386, 0.055)]), coffee, place)
    plate = [(0.0, 0.003), (0.035, 0.003), (0.052, 0.007), (0.070, 0.013), (0.0708, 0.0146)]
    add("Saucer", lathe([*plate, (0.069, 0.0148), (0.050, 0.0095), (0.0, 0.006)]), ivory, place)
    handle = bmesh.new()
    ring, tube = 0.017, 0.0042
    bmesh.ops.create_circle(
        handle, segments=20, radius=tube, matrix=Matrix.Translation((ring, 0, 0))
    )
    bmesh.ops.rotate(
        handle,
        verts=handle.verts,
        cent=(ring, 0, 0),
        matrix=Matrix.Rotation(math.pi / 2, 3, "X"),
    )
    bmesh.ops.spin(
        handle,
        geom=[*handle.verts, *handle.edges],
        cent=(0, 0, 0),
        axis=(0, 0, 1),
        angle=math.tau,
        steps=40,
        use_merge=True,
    )
    bmesh.ops.remove_doubles(handle, verts=handle.verts, dist=1e-6)
    bmesh.ops.recalc_face_normals(handle, faces=handle.faces)
    stand = Matrix.Translation((0.043, 0, 0.036)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    add("Handle", handle, enamel, place @ stand)


def build_candle(place):
    """Put a burning candle in a brass bowl on the table; its light goes with it."""
    wax = material("Wax", (0.90, 0.50, 0.22), roughness=0.45, glow=0.16)
    brass = material("Brass", (0.80, 0.47, 0.13), roughness=0.3, metallic=0.6)
    add("Candle", lathe([(0.0, 0.095), (0.021, 0.097), (0.023, 0.093), (0.023, 0.0)]), wax, place)
    bowl = [
        (0.0, 0.002),
        (0.030, 0.002),
        (0.042, 0.012),
        (0.044, 0.022),
        (0.042, 0.022),
        (0.03, 0.01),
    ]
    add("Bowl", lathe(bowl), brass, place)
    flame = [(0.0, 0.100), (0.0045, 0.105), (0.0062, 0.112), (0.0045, 0.122), (0.0, 0.136)]
    glow = emission("Flame", (1.0, 0.47, 0.12), 22.0)
    add("Flame", lathe(flame, 24), glow, place)


def build_near_object(place):
    """Put a brushed metal bauble close to the camera, far out of focus."""
    metal = material("Bauble", (0.80, 0.24, 0.05), roughness=0.30, glow=0.05)
    cap = material("Cap", (0.80, 0.60, 0.25), roughness=0.3, metallic=0.5)
    add("Bauble", sphere(0.034, 64), metal, place)
    turn = Matrix.Rotation(math.radians(-24), 4, "Y")
    add("Cap", lathe([(0.0, 0.042), (0.009, 0.041), (0.0095, 0.031)]), cap, place @ turn)
