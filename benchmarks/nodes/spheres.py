"""Closures on spheres in one picture, in a grey world and under a sun, as Cycles draws them."""

import math
from dataclasses import dataclass, field

import numpy as np

# Pixels along a side of a sphere's cell.
CELL_PX = 24
_RADIUS = 0.98
# Pixels whose normal is further from the view are not compared: edges of the sphere's triangles.
_LEAST_COSINE = 0.3
_COLOR = (0.8, 0.5, 0.3)
SUN = ((1.0, 0.3, 1.0), 3.0)


@dataclass(frozen=True)
class Lit:
    """A closure with its inputs and settings.

    Parameters
    ----------
    node : str
        Blender's type without ``ShaderNode``.
    inputs, settings : dict
        As of `case.Case`; the first colour is `_COLOR` unless it is given.
    world, sun : float
        Largest mean difference from Cycles in a grey world and under a sun, in 1/255 of the
        displayed picture, for the tests.
    """

    node: str
    inputs: dict = field(default_factory=dict)
    settings: dict = field(default_factory=dict)
    world: float = 3.0
    sun: float = 3.0

    @property
    def name(self):
        """What tells it from others of the same node."""
        return f"{self.node} {self.inputs} {self.settings}"


def _sheen(kind, roughness, sun):
    # The share of the world is a fit, good to 0.04.
    return Lit("BsdfSheen", {"Roughness": roughness}, {"distribution": kind}, 4.0, sun)


def _toon(component, size, smooth, sun):
    inputs = {"Size": size, "Smooth": smooth}
    return Lit("BsdfToon", inputs, {"component": component}, 3.0, sun)


def _hair(component, along, around):
    # Cycles turns the lobes about a tangent of its own triangles.
    inputs = {"RoughnessU": along, "RoughnessV": around}
    return Lit("BsdfHair", inputs, {"component": component}, 1.0, 27.0)


CASES = [
    # In Cycles the fibres' light comes back to where it came from, too.
    *(_sheen("MICROFIBER", r, 16.0) for r in (0.2, 0.5, 1.0)),
    *(_sheen("ASHIKHMIN", r, 3.0) for r in (0.2, 0.5, 1.0)),
    *(Lit("BsdfDiffuse", {"Roughness": r}, {}, 3.0, 4.0) for r in (0.0, 0.4, 1.0)),
    # The edge of a toon's light is sharper than a triangle.
    *(_toon("DIFFUSE", *sizes, 5.0) for sizes in ((0.5, 0.02), (0.3, 0.2), (0.8, 0.5))),
    *(_toon("GLOSSY", *sizes, 6.0) for sizes in ((0.5, 0.02), (0.3, 0.2))),
    *(_hair("Reflection", *sizes) for sizes in ((0.1, 1.0), (0.3, 0.5))),
    *(_hair("Transmission", *sizes) for sizes in ((0.1, 1.0), (0.3, 0.5))),
    *(
        Lit("BsdfPrincipled", {"Sheen Weight": 1.0, "Sheen Roughness": r}, {}, 3.0, 10.0)
        for r in (0.3, 0.8)
    ),
    Lit("BsdfPrincipled", {"Diffuse Roughness": 1.0}, {}, 3.0, 4.0),
    # Light leaves where it enters: none is lost at edges.
    Lit("BsdfPrincipled", {"Subsurface Weight": 1.0}, {}, 10.0, 10.0),
    Lit("SubsurfaceScattering", {}, {}, 12.0, 12.0),
    Lit("BsdfTranslucent", {}, {}, 3.0, 3.0),
]


def build_spheres(bpy, cases, sun):
    """Replace the open file by a scene with a sphere for each case.

    Parameters
    ----------
    bpy : module
    cases : sequence of Lit
    sun : bool
        Under a sun; else in a grey world.

    Returns
    -------
    bpy.types.Scene
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    columns = _columns(cases)
    scene.render.resolution_x = scene.render.resolution_y = columns * CELL_PX
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.0 * columns
    camera.location.z = 10.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    for number, case in enumerate(cases):
        row, column = divmod(number, columns)
        place = (2.0 * column - columns + 1.0, 2.0 * row - columns + 1.0, 0.0)
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=64, ring_count=32, radius=_RADIUS, location=place
        )
        ball = bpy.context.object
        ball.data.polygons.foreach_set("use_smooth", np.ones(len(ball.data.polygons), bool))
        # Each by itself.
        ball.visible_shadow = ball.visible_diffuse = ball.visible_glossy = False
        ball.visible_transmission = False
        ball.data.materials.append(_material(bpy, case))
    world = scene.world = bpy.data.worlds.new("world")
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.0,) * 4 if sun else (0.5, 0.5, 0.5, 1.0)
    if sun:
        from mathutils import Vector

        direction, strength = SUN
        lamp = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
        lamp.data.energy, lamp.data.angle = strength, 0.0
        lamp.rotation_euler = Vector(direction).to_track_quat("Z", "Y").to_euler()
        scene.collection.objects.link(lamp)
    return scene


def compare(cases, ours, cycles):
    """Return the mean difference of each case, in 1/255 of the sRGB encoded picture.

    Parameters
    ----------
    cases : sequence of Lit
    ours, cycles : ndarray of shape (height, width, 4)
        Scene linear, top row first.

    Returns
    -------
    list of float
    """
    from .sheet import encoded

    line = (np.arange(CELL_PX) + 0.5) / CELL_PX * 2.0 - 1.0
    x, y = np.meshgrid(line, line)
    seen = 1.0 - (x * x + y * y) / _RADIUS**2 > _LEAST_COSINE**2
    found = []
    for number in range(len(cases)):
        row, column = divmod(number, _columns(cases))
        cell = tuple(slice(i * CELL_PX, (i + 1) * CELL_PX) for i in (row, column))
        a, b = (encoded(picture[::-1][cell][..., :3]) for picture in (ours, cycles))
        found.append(float(np.abs(a - b)[seen].mean()))
    return found


def _columns(cases):
    return math.ceil(math.sqrt(len(cases)))


def _material(bpy, case):
    material = bpy.data.materials.new(case.name[:60])
    tree = material.node_tree
    tree.nodes.clear()
    output, node = (tree.nodes.new(f"ShaderNode{k}") for k in ("OutputMaterial", case.node))
    for name, value in case.settings.items():
        setattr(node, name, value)
    colors = [s.name for s in node.inputs if s.type == "RGBA"][:1]
    for name, value in ({name: _COLOR for name in colors} | case.inputs).items():
        socket = next(s for s in node.inputs if s.name == name and s.enabled)
        socket.default_value = (*value, 1.0)[:4] if socket.type == "RGBA" else value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material
