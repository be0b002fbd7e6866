"""Reads Blender's world into `World`: one Background with a colour or an equirectangular image.

Where nodes tell rays of the camera from others, it is read twice: as the camera sees it, and as it
lights the scene.
"""

from dataclasses import replace

import numpy as np

from ...snapshot.content import World
from ...snapshot.surface_graph import LARGEST_RADIANCE, MISSING_IMAGE_COLOR, Constant, Link
from ..images import color_spaces
from ..nodes import input_nodes, value_nodes
from ..nodes.image_nodes import sky_use
from ..nodes.node_tree import inlined, source_of
from ..nodes.tree_reader import TreeReader, constant, constant_number, input_socket, numbers_of
from ..nodes.vector_nodes import euler_matrix, mapping_matrix

# How far a Mapping may be from a rotation.
_ROTATION_TOLERANCE = 1e-4


def read_world(world, images):
    """Read a world.

    Parameters
    ----------
    world : bpy.types.World or None
    images : ImageReader

    Returns
    -------
    World
    notes : list of str
        What is not drawn, and what is drawn instead.
    """
    notes = []
    if world is None:
        return World(), notes
    # The nodes live as long as their tree: `_owner` is kept.
    output, _owner = inlined(world, "EEVEE")
    if output is None:
        return World(), notes
    reader = _WorldReader(world.name_full, images, notes)
    volume = next((s for s in output.inputs if s.identifier == "Volume"), None)
    if volume is not None and source_of(volume, ())[0].is_output:
        reader.note("volume is not drawn")
    return reader.read(output, world.aplanat.amplification), notes


# What a Light Path node gives, as the camera sees the world and as a diffuse surface does.
_CAMERA = {"Is Camera Ray": 1.0}
_LIGHTING = {
    **{"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0},
    **{"Ray Depth": 1.0, "Diffuse Depth": 1.0},
}
# Operations of Math nodes, each with how many inputs it has.
_OPERATIONS = {
    "ADD": (2, lambda a, b: a + b),
    "SUBTRACT": (2, lambda a, b: a - b),
    "MULTIPLY": (2, lambda a, b: a * b),
    "DIVIDE": (2, lambda a, b: a / b if b else 0.0),
    "MULTIPLY_ADD": (3, lambda a, b, c: a * b + c),
    "MAXIMUM": (2, max),
    "MINIMUM": (2, min),
    "GREATER_THAN": (2, lambda a, b: float(a > b)),
    "LESS_THAN": (2, lambda a, b: float(a < b)),
}


class _WorldReader:
    def __init__(self, name, images, notes):
        self._ray, self._tells_rays = _CAMERA, False
        self._name = name
        self._images = images
        self._notes = notes

    def note(self, text):
        self._notes.append(f"world '{self._name}': {text}")

    def read(self, output, amplification):
        shown = self._read(output, amplification)
        if not self._tells_rays:
            return shown
        self._ray = _LIGHTING
        lighting = self._read(output, amplification)
        return shown if lighting == shown else replace(shown, lighting=lighting)

    def _read(self, output, amplification):
        surface = next(s for s in output.inputs if s.identifier == "Surface")
        socket, groups = self._chosen(*source_of(surface, ()))
        if not socket.is_output:
            return World()
        node = socket.node
        if node.type not in {"BACKGROUND", "EMISSION"}:
            self.note(f"node '{node.bl_label}' is not read; the first Background under it is used")
            node, groups = _first_background(node, groups)
            if node is None:
                return World()
        color, image, rotation, graph = self._color(node, groups)
        strength = self._number(node.inputs["Strength"], groups)
        light = tuple(c * strength for c in color)
        # Cycles drops such channels, too.
        if not all(abs(c) <= LARGEST_RADIANCE for c in light):
            self.note("its light is stronger than a picture can hold; it is left out")
            light = tuple(c if abs(c) <= LARGEST_RADIANCE else 0.0 for c in light)
        # Amplify Whites refers to the image's white, whatever the strength of the Background.
        amplification = amplification if image else 0.0
        luminance = color_spaces.luminance_weights()
        return World(light, image, rotation, amplification, luminance, graph)

    def _chosen(self, socket, groups):
        """Follow mixes whose factor is 0 or 1 for this kind of ray."""
        names = {"MIX_SHADER": ("Fac", "Shader", "Shader_001")}
        names["MIX"] = ("Factor_Float", "A_Color", "B_Color")
        while socket.is_output and socket.node.type in names:
            inputs = {s.identifier: s for s in socket.node.inputs}
            factor, first, second = (inputs[name] for name in names[socket.node.type])
            if socket.type not in {"SHADER", "RGBA"}:
                break
            if socket.type == "RGBA" and socket.node.blend_type != "MIX":
                break
            share = self._for_ray(factor, groups)
            if share is None or 0.0 < share < 1.0:
                break
            socket, groups = source_of(first if share <= 0.0 else second, groups)
        return socket, groups

    def _for_ray(self, socket, groups):
        """Return the number that nodes compute for this kind of ray, or None."""
        source, inner = source_of(socket, groups)
        node = source.node
        if not source.is_output or node.type == "VALUE":
            return constant_number(source)
        if node.type == "LIGHT_PATH":
            self._tells_rays = True
            return self._ray.get(source.identifier, 0.0)
        if node.type == "MATH" and node.operation in _OPERATIONS:
            count, operation = _OPERATIONS[node.operation]
            values = [self._for_ray(s, inner) for s in node.inputs[:count]]
            if None not in values:
                value = operation(*values)
                return min(max(value, 0.0), 1.0) if node.use_clamp else value
        if node.type == "MIX" and node.data_type == "FLOAT":
            inputs = {s.identifier: s for s in node.inputs}
            names = ("Factor_Float", "A_Float", "B_Float")
            share, first, second = (self._for_ray(inputs[name], inner) for name in names)
            if None not in (share, first, second):
                share = min(max(share, 0.0), 1.0) if node.clamp_factor else share
                return first + (second - first) * share
        return None

    def _number(self, socket, groups):
        source, _ = source_of(socket, groups)
        if source.is_output:
            if source.node.type in {"VALUE", "RGB"}:
                return self._constant_number(source)
            number = self._for_ray(socket, groups)
            if number is not None:
                return number
            self.note(f"node '{source.node.bl_label}' is not read; its socket's value is used")
            source = socket
        return self._constant_number(source)

    def _constant_number(self, socket):
        self._note_nan(socket)
        return constant_number(socket)

    def _note_nan(self, socket):
        if np.isnan(numbers_of(socket)).any():
            self.note(
                f"'{socket.name}' of node '{socket.node.bl_label}' is not a number; 0 is used"
            )

    def _color(self, node, groups):
        socket = node.inputs["Color"]
        source, inner = self._chosen(*source_of(socket, groups))
        nothing = World()
        if not source.is_output:
            self._note_nan(source)
            return constant(source).value, 0, nothing.rotation, None
        kind = source.node.type
        if kind in {"RGB", "VALUE"}:
            self._note_nan(source)
            values = constant(source).value
            return values * 3 if len(values) == 1 else values, 0, nothing.rotation, None
        if kind == "TEX_ENVIRONMENT":
            return (*self._environment(source.node, inner), None)
        if kind == "TEX_SKY":
            use = sky_use(TreeReader("", self._images, {}), source.node)
            return (1.0, 1.0, 1.0), use.uid, self._rotation(source.node, inner), None
        if kind in value_nodes.READERS:
            computed = self._computed(node, groups)
            if computed is not None:
                return computed
        self.note(f"node '{source.node.bl_label}' is not read; its socket's value is used")
        return constant(socket).value, 0, nothing.rotation, None

    def _computed(self, node, groups):
        """Return the world that nodes compute from images; None without a readable image."""
        readers = {
            **{kind: input_nodes.READERS[kind] for kind in ("RGB", "VALUE")},
            **value_nodes.READERS,
            "TEX_ENVIRONMENT": self._read_environment,
            "TEX_SKY": self._read_sky,
            "LIGHT_PATH": self._read_light_path,
        }
        reader = TreeReader(f"world '{self._name}'", self._images, readers)
        color = reader.value(node, "Color", groups)
        images = [found.image for found in reader.nodes if found.image]
        if not images:
            return None
        self._notes += reader.report
        glow = reader.add("emission", [("Color", color), ("Strength", Constant((1.0,)))])
        graph = reader.graph(Link(glow, "Emission"))
        return (1.0, 1.0, 1.0), images[0], World().rotation, graph

    def _read_environment(self, reader, node, groups):
        use = reader.use_image(node) if node.image else None
        if use is None:
            return {"Color": Constant(MISSING_IMAGE_COLOR)}
        self._note_environment(node, use)
        rows = zip("XYZ", self._rotation(node, groups), strict=True)
        inputs = [(axis, Constant(row)) for axis, row in rows]
        settings = (("encoding", "srgb" if use.srgb else ""),)
        return reader.add("environment_texture", inputs, settings, use.uid)

    def _read_sky(self, reader, node, groups):
        use = sky_use(reader, node)
        if use is None:
            return {"Color": Constant(MISSING_IMAGE_COLOR)}
        rows = zip("XYZ", self._rotation(node, groups), strict=True)
        inputs = [(axis, Constant(row)) for axis, row in rows]
        return reader.add("environment_texture", inputs, (), use.uid)

    def _read_light_path(self, reader, node, groups):
        self._tells_rays = True
        names = [socket.identifier for socket in node.outputs]
        return {name: Constant((self._ray.get(name, 0.0),)) for name in names}

    def _environment(self, node, groups):
        rotation = World().rotation
        if node.image is None:
            return MISSING_IMAGE_COLOR, 0, rotation
        use = self._images.read(node.image, node.image_user)
        if use is None:
            return MISSING_IMAGE_COLOR, 0, rotation
        self._note_environment(node, use)
        return (1.0, 1.0, 1.0), use.uid, self._rotation(node, groups)

    def _note_environment(self, node, use):
        if node.projection != "EQUIRECTANGULAR":
            self.note("a mirror ball is drawn as an equirectangular image")
        if use.associated:
            self.note("the alpha of an environment image is not read")

    def _rotation(self, node, groups):
        identity = World().rotation
        vector = input_socket(node, "Vector")
        source, inner = source_of(vector, groups)
        if not vector.enabled or not source.is_output:
            return identity
        matrix = np.eye(3)
        while source.is_output and source.node.type == "MAPPING":
            matrix = matrix @ self._mapping(source.node, inner)
            source, inner = source_of(source.node.inputs["Vector"], inner)
        if source.is_output and (source.node.type, source.identifier) not in {
            ("TEX_COORD", "Generated"),
            ("TEX_COORD", "Normal"),
            ("NEW_GEOMETRY", "Position"),
            ("NEW_GEOMETRY", "Normal"),
        }:
            self.note(
                f"'{source.identifier}' of node '{source.node.bl_label}' is not read;"
                " the direction of view is used"
            )
        return tuple(tuple(float(v) for v in row) for row in matrix)

    def _mapping(self, node, groups):
        values = {}
        for name in ("Location", "Rotation", "Scale"):
            socket = next((s for s in node.inputs if s.identifier == name), None)
            if socket is None or not socket.enabled:
                continue
            source, _ = source_of(socket, groups)
            if source.is_output:
                self.note(f"'{name}' of node 'Mapping' is not read; its socket's value is used")
                source = socket
            values[name] = constant(source).value
        if node.vector_type == "NORMAL":
            matrix, offset = mapping_matrix("VECTOR", {**values, "Scale": (1.0,) * 3})
        else:
            matrix, offset = mapping_matrix(node.vector_type, values)
        scale = np.linalg.norm(matrix, axis=0)
        uniform = scale.min() > 0.0 and np.ptp(scale / scale.max()) < _ROTATION_TOLERANCE
        if not uniform or np.abs(offset).max() > _ROTATION_TOLERANCE:
            self.note("of node 'Mapping' only the rotation is drawn")
            rotation = euler_matrix(values["Rotation"])
            return rotation.T if node.vector_type == "TEXTURE" else rotation
        return matrix / scale.max()


def _first_background(node, groups, depth=0):
    for socket in node.inputs:
        if socket.type != "SHADER" or depth > 32:
            continue
        source, inner = source_of(socket, groups)
        if not source.is_output:
            continue
        if source.node.type in {"BACKGROUND", "EMISSION"}:
            return source.node, inner
        found = _first_background(source.node, inner, depth + 1)
        if found[0] is not None:
            return found
    return None, groups
