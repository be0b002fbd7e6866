"""Scenes of things that are seen through, in front of and behind the plane of focus.

Everything emits: Cycles needs no bounces but those of glass. The camera looks along +y from the
origin, focused at 3 m; the backdrop is at 8 m, with lamps before it.
"""

import math

import numpy as np

FOCUS = 3.0


class Materials:
    """Makes materials of a few nodes.

    Parameters
    ----------
    bpy : module
    """

    def __init__(self, bpy):
        self._bpy = bpy

    def _new(self, name):
        material = self._bpy.data.materials.new(name)
        material.node_tree.nodes.clear()
        output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
        return material, material.node_tree, output.inputs["Surface"]

    @staticmethod
    def _node(tree, kind, inputs=()):
        node = tree.nodes.new(f"ShaderNode{kind}")
        for name, value in dict(inputs).items():
            socket = node.inputs[name]
            if hasattr(value, "is_output"):
                tree.links.new(value, socket)
            else:
                socket.default_value = (*value, 1.0) if isinstance(value, tuple) else value
        return node

    def glow(self, color, strength=1.0):
        """Return Emission."""
        material, tree, surface = self._new("glow")
        node = self._node(tree, "Emission", {"Color": color, "Strength": strength})
        tree.links.new(node.outputs[0], surface)
        return material

    def pattern(self, scale):
        """Return Emission of a checker board of two colours."""
        material, tree, surface = self._new("pattern")
        place = self._node(tree, "TexCoord")
        colors = {"Color1": (0.7, 0.35, 0.15), "Color2": (0.08, 0.2, 0.45), "Scale": scale}
        checker = self._node(tree, "TexChecker", {"Vector": place.outputs["Object"], **colors})
        node = self._node(tree, "Emission", {"Color": checker.outputs["Color"]})
        tree.links.new(node.outputs[0], surface)
        return material

    def pane(self, color, opacity, filtered=(1.0, 1.0, 1.0)):
        """Return Emission mixed with Transparent, each of a colour."""
        material, tree, surface = self._new("pane")
        light = self._node(tree, "Emission", {"Color": color})
        clear = self._node(tree, "BsdfTransparent", {"Color": filtered})
        mix = self._node(tree, "MixShader", {"Fac": opacity})
        tree.links.new(clear.outputs[0], mix.inputs[1])
        tree.links.new(light.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], surface)
        return material

    def filtering(self, color):
        """Return Transparent of a colour."""
        material, tree, surface = self._new("filter")
        tree.links.new(self._node(tree, "BsdfTransparent", {"Color": color}).outputs[0], surface)
        return material

    def flame(self, color, strength):
        """Return Emission added to Transparent, brightest in the middle of the card's UVs."""
        material, tree, surface = self._new("flame")
        place = self._node(tree, "TexCoord")
        middle = self._node(tree, "Mapping", {"Vector": place.outputs["UV"]})
        middle.inputs["Location"].default_value = (-1.0, -1.0, 0.0)
        middle.inputs["Scale"].default_value = (2.0, 2.0, 1.0)
        shape = self._node(tree, "TexGradient", {"Vector": middle.outputs[0]})
        shape.gradient_type = "SPHERICAL"
        bright = self._node(tree, "Math", {0: shape.outputs["Factor"], 1: strength})
        bright.operation = "MULTIPLY"
        light = self._node(tree, "Emission", {"Color": color, "Strength": bright.outputs[0]})
        clear = self._node(tree, "BsdfTransparent")
        both = self._node(tree, "AddShader")
        for number, node in enumerate((light, clear)):
            tree.links.new(node.outputs[0], both.inputs[number])
        tree.links.new(both.outputs[0], surface)
        return material

    def leaf(self):
        """Return Emission and alpha of an image: a leaf with a soft edge and holes."""
        size = 64
        y, x = (np.mgrid[:size, :size] + 0.5) / size * 2.0 - 1.0
        inside = 1.0 - np.hypot(x / (0.75 * np.sqrt(np.clip(1.0 - y**2, 1e-4, 1.0))), y)
        holes = np.sin(9.0 * x) * np.sin(9.0 * y) < 0.55
        pixels = np.ones((size, size, 4), np.float32)
        pixels[..., :3] = np.stack([0.2 + 0.2 * x, 0.5 + 0.3 * y, 0.1 + 0.0 * x], axis=-1)
        pixels[..., 3] = np.clip(inside * 8.0, 0.0, 1.0) * holes
        image = self._bpy.data.images.new("leaf", size, size, alpha=True)
        image.pixels.foreach_set(pixels.ravel())
        image.update()
        image.pack()
        material, tree, surface = self._new("leaf")
        texture = self._node(tree, "TexImage")
        texture.image = image
        light = self._node(tree, "Emission", {"Color": texture.outputs["Color"]})
        clear = self._node(tree, "BsdfTransparent")
        mix = self._node(tree, "MixShader", {"Fac": texture.outputs["Alpha"]})
        tree.links.new(clear.outputs[0], mix.inputs[1])
        tree.links.new(light.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], surface)
        return material

    def glass(self, color=(1.0, 1.0, 1.0), roughness=0.0, ior=1.45, kind="BsdfGlass"):
        """Return Glass or Refraction."""
        material, tree, surface = self._new("glass")
        given = {"Color": color, "Roughness": roughness, "IOR": ior}
        tree.links.new(self._node(tree, kind, given).outputs[0], surface)
        return material


class Stage:
    """An empty file with a camera, a backdrop and lamps before it.

    Parameters
    ----------
    bpy : module
    size : tuple of 2 int
        Pixels.
    lamps : float
        Radiance of the lamps; 0 for none.
    """

    def __init__(self, bpy, size, lamps):
        self.bpy = bpy
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = size
        scene.view_settings.view_transform = "Standard"
        scene.world = bpy.data.worlds.new("world")
        background = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
        background.inputs["Color"].default_value = (0.12, 0.15, 0.2, 1.0)
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.collection.objects.link(camera)
        scene.camera = camera
        camera.rotation_euler = (math.pi / 2, 0.0, 0.0)
        camera.data.lens = 50.0
        dof = camera.data.dof
        dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, FOCUS, 0.3
        self.make = Materials(bpy)
        self.card(self.make.pattern(1.4), (0.0, 8.0, 0.0), (9.0, 6.0))
        # Thin things in focus, so that transparency is also seen sharp.
        for x in (-0.8, 0.0, 0.8):
            self.card(self.make.glow((0.8, 0.8, 0.7)), (x, FOCUS, 0.0), (0.05, 1.6))
        if lamps:
            for number in range(6):
                place = (-1.9 + 0.75 * number, 7.0, 1.0 * math.sin(2.3 * number))
                color = (1.0, 0.6 + 0.08 * number, 1.0 - 0.12 * number)
                self.ball(self.make.glow(color, lamps), place, 0.05, 16)

    def _add(self, material, location, rotation):
        made = self.bpy.context.object
        made.location, made.rotation_euler = location, rotation
        made.data.materials.append(material)
        return made

    def card(self, material, location, size, turn=0.0):
        """Add a rectangle that faces the camera, turned about the vertical."""
        self.bpy.ops.mesh.primitive_plane_add(size=1.0)
        made = self._add(material, location, (math.pi / 2, 0.0, turn))
        made.scale = (*size, 1.0)
        return made

    def ball(self, material, location, radius, segments=48):
        """Add a smooth ball."""
        rings = segments // 2
        add = self.bpy.ops.mesh.primitive_uv_sphere_add
        add(radius=radius, segments=segments, ring_count=rings)
        made = self._add(material, location, (0.0, 0.0, 0.0))
        made.data.shade_smooth()
        return made


def half_panes(stage):
    """Add a pane of alpha 0.5 before the focus and one behind it."""
    for x, y in ((-0.35, 1.8), (0.7, 5.0)):
        stage.card(stage.make.pane((0.25, 0.3, 0.35), 0.5), (x, y, 0.1), (0.5 * y, 0.4 * y))


def coloured_panes(stage):
    """Add panes of coloured light that passes, before and behind, one over the other."""
    make = stage.make
    stage.card(make.filtering((0.9, 0.35, 0.1)), (-0.3, 1.8, 0.0), (0.8, 0.6))
    stage.card(make.filtering((0.2, 0.8, 0.9)), (0.4, 5.0, 0.3), (2.4, 1.6))
    stage.card(make.pane((0.1, 0.3, 0.1), 0.4, (0.3, 0.9, 0.4)), (0.4, 2.2, -0.3), (0.6, 0.5))


def leaves(stage):
    """Add cards with an image's alpha, before, in and behind the focus."""
    leaf = stage.make.leaf()
    for number, y in enumerate((1.5, 2.2, 3.0, 4.5, 6.0)):
        place = ((number - 2) * 0.28 * y**0.8, y, 0.1 * (-1) ** number * y)
        stage.card(leaf, place, (0.35 * y, 0.35 * y), 0.3 * number - 0.5)


def flames(stage):
    """Add crossed cards of emission and transparency, before, in and behind the focus."""
    for number, (x, y) in enumerate(((-0.35, 1.7), (0.25, 3.0), (1.3, 5.5))):
        flame = stage.make.flame((1.0, 0.45, 0.12), 1.6 + number)
        for turn in (-0.6, 0.6):
            stage.card(flame, (x, y, -0.05 * y), (0.3 * y, 0.4 * y), turn)


def flames_and_filters(stage):
    """Add a flame behind a coloured pane, and one before it."""
    make = stage.make
    stage.card(make.filtering((0.3, 0.9, 0.4)), (0.0, 2.4, 0.0), (1.1, 0.8))
    stage.card(make.flame((1.0, 0.5, 0.15), 2.0), (-0.2, 1.8, 0.0), (0.4, 0.4))
    stage.card(make.flame((1.0, 0.5, 0.15), 2.0), (0.4, 4.0, 0.1), (1.2, 1.2))
    stage.card(make.filtering((0.9, 0.4, 0.4)), (0.5, 5.5, 0.2), (1.8, 1.4))


def many_panes(stage):
    """Add overlapping panes in any order, and panes that cross one another."""
    make = stage.make
    colors = ((0.8, 0.3, 0.2), (0.2, 0.7, 0.3), (0.2, 0.3, 0.8), (0.7, 0.7, 0.2))
    for number in (2, 0, 3, 1):
        y = 1.6 + 0.9 * number
        place = (0.12 * y * (number - 1.5), y, 0.05 * y * (-1) ** number)
        stage.card(make.pane(colors[number], 0.35), place, (0.45 * y, 0.3 * y))
    for turn in (-0.7, 0.7):
        stage.card(
            make.pane((0.3, 0.3, 0.3), 0.6, (1.0, 0.6, 0.8)), (0.5, 2.6, -0.2), (1.0, 0.5), turn
        )


def lamps_among_panes(stage):
    """Add lamps between panes, before and behind the focus."""
    make = stage.make
    stage.card(make.pane((0.2, 0.25, 0.3), 0.5), (-0.3, 1.6, 0.0), (0.7, 0.6))
    stage.card(make.filtering((0.9, 0.4, 0.2)), (0.5, 4.2, 0.0), (1.6, 1.6))
    for x, y in ((-0.25, 1.3), (-0.4, 2.0), (0.6, 3.8), (0.7, 5.0)):
        stage.ball(make.glow((1.0, 0.8, 0.6), 60.0), (x, y, 0.15), 0.006 * y, 16)


def glass_ball(stage):
    """Add a glass ball behind the focus and one before it."""
    stage.ball(stage.make.glass(), (0.45, 3.4, 0.0), 0.5)
    stage.ball(stage.make.glass(), (-0.4, 1.9, 0.05), 0.2)


SCENES = {
    "half panes": half_panes,
    "coloured panes": coloured_panes,
    "leaves": leaves,
    "flames": flames,
    "flames and filters": flames_and_filters,
    "many panes": many_panes,
    "lamps among panes": lamps_among_panes,
    "glass balls": glass_ball,
}


def build(bpy, name, size=(160, 90), lamps=40.0):
    """Return a new file's scene.

    Parameters
    ----------
    bpy : module
    name : str
        Of `SCENES`.
    size : tuple of 2 int
        Pixels.
    lamps : float
        Radiance of the lamps before the backdrop; 0 for none.

    Returns
    -------
    bpy.types.Scene
    """
    stage = Stage(bpy, size, lamps)
    SCENES[name](stage)
    return stage.scene
