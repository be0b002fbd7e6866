"""Builds the demo scene: a table-top at night, a figurine in focus, rows of small lamps behind.

Everything is made from Blender's own primitives and seeded random numbers. Run it with the bpy
package, `python scripts/demo_scene.py -o demo.blend`, or inside Blender,
`blender -b --python scripts/demo_scene.py -- -o demo.blend`.
"""

import argparse
import math
import random
import sys
from pathlib import Path

import bpy
import numpy as np

# isort: split
# Modules of Blender, there once bpy is imported.
import bmesh
from mathutils import Matrix, Vector

# Linear colours of the lamps with their share; warm ones prevail, as on any promenade.
LAMP_COLORS = (
    ((1.0, 0.46, 0.12), 6),
    ((1.0, 0.62, 0.26), 4),
    ((1.0, 0.16, 0.07), 3),
    ((1.0, 0.10, 0.32), 3),
    ((0.06, 0.42, 1.0), 3),
    ((0.06, 1.0, 0.50), 3),
    ((0.34, 0.16, 1.0), 2),
)


def material(name, color, roughness=0.5, metallic=0.0, alpha=1.0, glow=0.0):
    """Make a Principled material with constant inputs."""
    made = bpy.data.materials.new(name)
    node = made.node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (*color, 1.0)
    node.inputs["Roughness"].default_value = roughness
    node.inputs["Metallic"].default_value = metallic
    node.inputs["Alpha"].default_value = alpha
    node.inputs["Emission Color"].default_value = (*color, 1.0)
    node.inputs["Emission Strength"].default_value = glow
    return made


def emission(name, color, strength):
    """Make an Emission material."""
    made = bpy.data.materials.new(name)
    tree = made.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    node = tree.nodes.new("ShaderNodeEmission")
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Strength"].default_value = strength
    tree.links.new(node.outputs["Emission"], output.inputs["Surface"])
    return made


def add(name, mesh, surface, matrix=None, smooth=True, collection=None):
    """Link a mesh, made by a `bmesh` operation or at hand, as an object."""
    if isinstance(mesh, bmesh.types.BMesh):
        data = bpy.data.meshes.new(name)
        mesh.to_mesh(data)
        mesh.free()
        data.shade_smooth() if smooth else data.shade_flat()
        data.materials.append(surface)
        mesh = data
    made = bpy.data.objects.new(name, mesh)
    made.matrix_world = matrix or Matrix()
    (collection or bpy.context.scene.collection).objects.link(made)
    return made


def box(size, bevel=0.0):
    """Return a box, its edges rounded."""
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=1.0, matrix=Matrix.Diagonal((*size, 1.0)))
    if bevel:
        bmesh.ops.bevel(
            mesh, geom=mesh.edges, offset=bevel, segments=3, profile=0.5, affect="EDGES"
        )
    return mesh


def sphere(radius, segments=32):
    """Return a sphere of longitude and latitude."""
    mesh = bmesh.new()
    bmesh.ops.create_uvsphere(mesh, u_segments=segments, v_segments=segments // 2, radius=radius)
    return mesh


def lathe(profile, steps=64):
    """Turn (radius, height) points about the z axis."""
    mesh = bmesh.new()
    points = [mesh.verts.new((radius, 0.0, height)) for radius, height in profile]
    edges = [mesh.edges.new(pair) for pair in zip(points, points[1:], strict=False)]
    bmesh.ops.spin(
        mesh,
        geom=[*points, *edges],
        cent=(0, 0, 0),
        axis=(0, 0, 1),
        angle=math.tau,
        steps=steps,
        use_merge=True,
        use_normal_flip=True,
    )
    bmesh.ops.remove_doubles(mesh, verts=mesh.verts, dist=1e-6)
    bmesh.ops.recalc_face_normals(mesh, faces=mesh.faces)
    return mesh


def smooth_by_angle(made, degrees):
    """Keep the edges sharper than an angle, as Blender's Shade Smooth by Angle does."""
    made.data.set_sharp_from_angle(angle=math.radians(degrees))
    return made


class Lamps:
    """Small glowing spheres that share one mesh per colour, and their images in the table."""

    def __init__(self, rng):
        self._rng = rng
        self._meshes = {}
        self.collection = bpy.data.collections.new("Lamps")
        bpy.context.scene.collection.children.link(self.collection)

    def any_color(self):
        """Draw a colour by its share."""
        colors, shares = zip(*LAMP_COLORS, strict=True)
        return self._rng.choices(colors, shares)[0]

    def add(self, position, radius, color, strength):
        """Hang one lamp."""
        key = (color, round(2.0 * strength) / 2.0)
        if key not in self._meshes:
            name = f"Lamp {len(self._meshes) + 1}"
            made = add(name, sphere(1.0, 12), emission(name, *key))
            self._meshes[key] = made.data
            bpy.data.objects.remove(made)
        matrix = Matrix.Translation(position) @ Matrix.Scale(radius, 4)
        add("Lamp", self._meshes[key], None, matrix, collection=self.collection)

    def string(self, start, end, sag, count, radius, strength):
        """Hang a string of lamps between two points."""
        start, end = Vector(start), Vector(end)
        for index in range(count):
            along = (index + self._rng.uniform(0.3, 0.7)) / count
            position = start.lerp(end, along)
            position.z -= 4.0 * sag * along * (1.0 - along)
            position += Vector(self._rng.gauss(0.0, 0.006) for _ in range(3))
            brightness = strength * self._rng.uniform(0.6, 1.4)
            self.add(position, radius, self.any_color(), brightness)


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


def paint(made, colors):
    """Give each vertex a colour, computed from its place in the object."""
    mesh = made.data
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", places)
    layer = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    values = np.ones((len(mesh.vertices), 4), np.float32)
    values[:, :3] = colors(places.reshape(-1, 3))
    layer.data.foreach_set("color", values.ravel())


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


def build_lamps(rng):
    """Hang the lamps: on the table, in strings behind it, and along a promenade by the water."""
    lamps = Lamps(rng)
    # A twig of them close to the camera, before the focus.
    lamps.string((0.168, -0.44, 0.175), (0.060, -0.47, 0.247), 0.006, 4, 0.0030, 18.0)
    # On the table behind the figurine, and strings above it.
    lamps.string((-0.62, 0.20, 0.012), (0.62, 0.34, 0.012), 0.0, 16, 0.0030, 8.0)
    lamps.string((-1.0, 0.75, 0.40), (0.9, 0.95, 0.52), 0.13, 15, 0.0065, 9.5)
    lamps.string((-1.5, 1.35, 0.66), (1.6, 1.15, 0.60), 0.16, 17, 0.0098, 9.0)
    lamps.string((-2.0, 2.3, 0.85), (2.2, 2.6, 1.00), 0.25, 18, 0.0165, 9.0)
    # Two rows of lanterns that go off to the horizon.
    for side in (-1, 1):
        distance = 4.6
        while distance < 80.0:
            x = side * 1.8 + 0.03 * distance
            lamps.add((x, distance, 0.75), 0.0048 * distance, (1.0, 0.42, 0.10), 11.5)
            distance *= 1.6
    # The far shore: windows and signs.
    for _ in range(48):
        angle = rng.uniform(-0.42, 0.42)
        distance = rng.uniform(55.0, 110.0)
        height = 0.25 + distance * abs(rng.gauss(0.0, 0.075))
        position = (distance * math.sin(angle), distance * math.cos(angle), height)
        brightness = rng.choice((7.0, 11.0, 17.0))
        lamps.add(position, 0.0040 * distance, lamps.any_color(), brightness)
    # What the polished table and the water show of them.
    image = bpy.data.objects.new("Lamps in the polish", None)
    image.instance_type = "COLLECTION"
    image.instance_collection = lamps.collection
    image.scale = (1.0, 1.0, -1.0)
    bpy.context.scene.collection.objects.link(image)


def light(name, kind, position, color, energy, size=0.0, target=None):
    """Add a light without shadow."""
    data = bpy.data.lights.new(name, kind)
    data.color = color
    data.energy = energy
    data.use_shadow = False
    made = bpy.data.objects.new(name, data)
    made.location = position
    if target is not None:
        direction = Vector(target) - Vector(position)
        made.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()
    if kind in {"POINT", "SPOT"}:
        data.shadow_soft_size = size
    if kind == "SPOT":
        data.spot_size = math.radians(58)
        data.spot_blend = 1.0
    bpy.context.scene.collection.objects.link(made)


def build_lights(candle):
    """Light the table: the candle, a warm lamp from the left, the blue of the evening behind."""
    flame = candle @ Vector((0.0, 0.0, 0.118))
    light("Candle light", "POINT", flame, (1.0, 0.50, 0.18), 1.1, 0.01)
    key = (-0.75, -0.34, 0.55)
    light("Key", "SPOT", key, (1.0, 0.72, 0.45), 48.0, 0.05, target=(0.0, 0.0, 0.08))
    rim = (0.55, 0.55, 0.45)
    light("Rim", "SPOT", rim, (0.30, 0.52, 1.0), 42.0, 0.05, target=(0.0, 0.0, 0.10))
    light("Moon", "SUN", (0, 0, 1), (0.35, 0.5, 1.0), 0.05, target=(0.4, -0.5, 0.0))


def build_camera(focus, width):
    """Set up a 50 mm f/1.4 of seven elements wide open, focused on the bird's eye."""
    scene = bpy.context.scene
    data = bpy.data.cameras.new("Camera")
    data.lens, data.sensor_width = 50.0, 36.0
    data.clip_start, data.clip_end = 0.02, 500.0
    data.dof.use_dof = True
    data.dof.focus_object = focus
    data.dof.aperture_fstop = 1.4
    data.aplanat.lens = "planar-50mm-f1.4"
    # A little of what such a lens does to colours; bokeh is on by default.
    data.aplanat.chromatic.use = True
    data.aplanat.chromatic.axial = 0.25
    data.aplanat.chromatic.lateral = 0.15
    camera = bpy.data.objects.new("Camera", data)
    camera.location = (0.02, -0.88, 0.205)
    aim = Vector((0.02, 0.0, 0.118)) - camera.location
    camera.rotation_euler = aim.to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = width, width * 9 // 16
    scene.render.resolution_percentage = 100


def register_engine():
    """Register Aplanat from this checkout, unless it is installed and enabled."""
    if not hasattr(bpy.types.Scene, "aplanat"):
        sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
        import addon

        addon.register()


def build(width=768, seed=3):
    """Replace what is open by the demo scene."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    register_engine()
    scene = bpy.context.scene
    scene.render.engine = "APLANAT"
    scene.name = "Table-top at night"
    world = scene.world = bpy.data.worlds.new("Night")
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.010, 0.018, 0.045, 1.0)
    background.inputs["Strength"].default_value = 1.0

    cup = Matrix.Translation((0.215, -0.075, 0.0)) @ Matrix.Rotation(math.radians(-35), 4, "Z")
    candle = Matrix.Translation((-0.235, 0.10, 0.0))
    bauble = Matrix.Translation((-0.150, -0.250, 0.034))
    focus = build_subject()
    build_cup(cup)
    build_candle(candle)
    build_near_object(bauble)
    build_table(
        [
            (0.0, 0.0, 0.150),
            (0.215, -0.075, 0.062),
            (-0.235, 0.10, 0.045),
            (-0.150, -0.250, 0.024),
        ]
    )
    build_lamps(random.Random(seed))
    build_lights(candle)
    build_camera(focus, width)
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Punchy"


def main():
    """Build the scene and save it."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-o", "--output", type=Path, required=True, help="the .blend to write")
    parser.add_argument("--width", type=int, default=768, help="picture width in pixels (768)")
    parser.add_argument("--seed", type=int, default=3, help="seed of the lamps (3)")
    options = parser.parse_args(arguments)
    build(options.width, options.seed)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(
        filepath=str(options.output.resolve()), compress=True, check_existing=False
    )


if __name__ == "__main__":
    main()
