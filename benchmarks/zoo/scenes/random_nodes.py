"""Random shader node trees: every kind of node that Blender has, those we draw most often.

Nodes are tried out in a tree of their own, because which inputs one has depends on its settings.
"""

from .random_settings import around, draw_image, draw_value, even, round_value

# Where trees end, and what needs a file or an addon.
_LEFT_OUT = {
    "ShaderNode",
    "ShaderNodeTree",
    "ShaderNodeCustomGroup",
    "ShaderNodeGroup",
    "ShaderNodeScript",
    "ShaderNodeTexIES",
}
# What the engine draws, weighted by how often people use it.
_SHADERS = {
    "ShaderNodeEmission": 5,
    "ShaderNodeBsdfPrincipled": 5,
    "ShaderNodeMixShader": 4,
    "ShaderNodeBsdfDiffuse": 3,
    "ShaderNodeBsdfTransparent": 3,
    "ShaderNodeBsdfGlossy": 2,
    "ShaderNodeAddShader": 2,
    "ShaderNodeHoldout": 1,
    "GROUP": 1,
    "ANY": 2,
}
_VALUES = {
    "ShaderNodeTexImage": 5,
    "ShaderNodeMath": 3,
    "ShaderNodeMix": 3,
    "ShaderNodeValToRGB": 3,
    "ShaderNodeVertexColor": 2,
    "ShaderNodeAttribute": 1,
    "ShaderNodeRGB": 1,
    "ShaderNodeValue": 1,
    "ShaderNodeUVMap": 1,
    "ShaderNodeTexCoord": 1,
    "ShaderNodeMapping": 2,
    "ShaderNodeFresnel": 1,
    "ShaderNodeLayerWeight": 1,
    "ShaderNodeTexNoise": 1,
    "ShaderNodeMapRange": 1,
    "ShaderNodeVectorMath": 1,
    "GROUP": 1,
    "ANY": 4,
}
_CLOSURES = {"SHADER"}
# Attributes that some of the meshes have.
ATTRIBUTES = ("UVMap", "Second", "Col", "Other", "")


class NodeDrawer:
    """Draws node trees.

    Parameters
    ----------
    rng : random.Random
    bpy : module
    largest_image : int
        Longest side, in pixels.

    Use as a context manager: the tree in which nodes are tried out goes at its end.
    """

    def __init__(self, rng, bpy, largest_image=40):
        self._rng = rng
        self._bpy = bpy
        self._largest = largest_image
        self._tree = None
        self._kinds = {}

    def __enter__(self):
        """Make the tree."""
        self._tree = self._bpy.data.node_groups.new("trial", "ShaderNodeTree")
        for name in sorted(dir(self._bpy.types)):
            if not name.startswith("ShaderNode") or name in _LEFT_OUT or "Output" in name:
                continue
            node = self._tree.nodes.new(name)
            outputs = [s for s in node.outputs if s.enabled]
            if outputs:
                self._kinds[name] = outputs[0].type in _CLOSURES
        return self

    def __exit__(self, *_exception):
        """Remove the tree."""
        self._bpy.data.node_groups.remove(self._tree)

    def shader(self, depth=3, kinds=_SHADERS):
        """Draw the recipe of a tree that gives a shader."""
        kind = self._choose(kinds)
        if kind == "GROUP":
            if depth == 0:
                return self.node("ShaderNodeEmission", 0)
            return self._group("NodeSocketShader", self.shader(depth - 1), depth)
        if depth == 0 and kind in {"ShaderNodeMixShader", "ShaderNodeAddShader"}:
            kind = "ShaderNodeEmission"
        if kind == "ANY":
            kind = self._rng.choice([k for k, is_shader in self._kinds.items() if is_shader])
        return self.node(kind, depth)

    def value(self, depth=2):
        """Draw the recipe of a tree that gives a colour, number or vector."""
        kind = self._choose(_VALUES)
        if kind == "GROUP":
            return self._group("NodeSocketColor", self.value(max(depth - 1, 0)), depth)
        if kind == "ANY":
            kind = self._rng.choice([k for k, is_shader in self._kinds.items() if not is_shader])
        return self.node(kind, depth)

    def node(self, kind, depth):
        """Draw the settings and inputs of a node.

        Parameters
        ----------
        kind : str
            Blender's name of the node's class.
        depth : int
            How many nodes may still follow one another.

        Returns
        -------
        dict
            For `pieces.grow`.
        """
        rng = self._rng
        node = self._tree.nodes.new(kind)
        spec = {"node": kind}
        settings = {} if rng.random() < 0.5 else self._settings(node)
        if "image" in node.bl_rna.properties and rng.random() < 0.9:
            settings["image"] = draw_image(rng, self._largest)
        for name, value in settings.items():
            if name != "image":
                setattr(node, name, value)
        if settings:
            spec["set"] = settings
        if kind == "ShaderNodeValToRGB":
            spec["ramp"] = [
                [even(rng, 0.0, 1.0), self._color() + [even(rng, 0.0, 1.0)]]
                for _ in range(rng.randint(0, 3))
            ]
        inputs = {}
        # A node with dozens of inputs keeps most of them.
        scarce = min(1.0, 6.0 / max(len(node.inputs), 1))
        for socket in node.inputs:
            if socket.enabled and not socket.is_unavailable:
                value = self._input(socket, depth, scarce)
                if value is not None:
                    inputs[socket.identifier] = value
        if inputs:
            spec["inputs"] = inputs
        outputs = [i for i, s in enumerate(node.outputs) if s.enabled]
        if len(outputs) > 1 and rng.random() < 0.4:
            spec["output"] = rng.choice(outputs)
        self._tree.nodes.remove(node)
        return spec

    def _choose(self, weights):
        return self._rng.choices(list(weights), list(weights.values()))[0]

    def _group(self, socket, inner, depth):
        spec = {"node": "ShaderNodeGroup", "inner": inner, "socket": socket}
        if self._rng.random() < 0.5:
            self._put_group_input(inner)
            given = self.value(depth - 1) if depth > 0 and self._rng.random() < 0.5 else None
            spec["inputs"] = {"Socket_0": given or [*self._color(), 1.0]}
        return spec

    def _put_group_input(self, spec):
        """Let the group's own input feed an input of the group's outermost node."""
        for identifier, value in spec.get("inputs", {}).items():
            if not identifier.startswith("Shader") and not (
                isinstance(value, dict) and "inner" in value
            ):
                spec["inputs"][identifier] = {"group_input": True}
                return

    def _settings(self, node):
        base = self._bpy.types.ShaderNode.bl_rna.properties.keys()
        values = {}
        for prop in node.bl_rna.properties:
            name = prop.identifier
            if name in base or prop.is_readonly or prop.is_hidden or self._rng.random() < 0.5:
                continue
            if prop.type == "STRING":
                if name in {"layer_name", "attribute_name", "uv_map"}:
                    values[name] = self._rng.choice(ATTRIBUTES)
            elif prop.type in {"BOOLEAN", "ENUM"}:
                value = draw_value(self._rng, prop)
                if value is not None:
                    values[name] = value
        return {name: value for name, value in values.items() if self._is_taken(node, name, value)}

    def _is_taken(self, node, name, value):
        """Whether a node takes a value: menus may offer what a kind of node does not have."""
        try:
            setattr(node, name, value)
        except TypeError:
            return False
        return True

    def _input(self, socket, depth, chance):
        """Draw an input: a tree that feeds it, a value, or None to keep its own."""
        rng = self._rng
        if socket.type == "SHADER":
            return self.shader(depth - 1) if depth > 0 and rng.random() < 0.9 else None
        if rng.random() > chance or socket.type not in {
            "VALUE",
            "RGBA",
            "VECTOR",
            "INT",
            "BOOLEAN",
        }:
            return None
        if depth > 0 and rng.random() < 0.25 and socket.type != "BOOLEAN":
            return self.value(depth - 1)
        if rng.random() < 0.5 or "default_value" not in socket.bl_rna.properties:
            return None
        if socket.type == "RGBA":
            return [*self._color(), 1.0]
        prop = socket.bl_rna.properties["default_value"]
        if socket.type == "BOOLEAN":
            return rng.random() < 0.5
        if socket.type == "VECTOR":
            return [self._number(socket, prop) for _ in range(prop.array_length)]
        value = self._number(socket, prop)
        return int(value) if socket.type == "INT" else value

    def _number(self, socket, prop):
        rng = self._rng
        if "Strength" in socket.name:
            # Mostly what is about as bright as the picture; now and then a lamp.
            usual = even(rng, 0.0, 3.0), around(rng, 0.1, 30.0)
            return around(rng, 10.0, 3e3) if rng.random() < 0.1 else rng.choice([1.0, *usual])
        low, high = max(prop.soft_min, -3.0), min(prop.soft_max, 5.0)
        if low >= high:
            low, high = prop.soft_min, prop.soft_max
        return rng.choice([round_value(low), round_value(high), even(rng, low, high)])

    def _color(self):
        rng = self._rng
        most = 1.0 if rng.random() < 0.9 else 5.0
        return [rng.choice([0.0, 1.0, *(even(rng, 0.0, most) for _ in range(4))]) for _ in "rgb"]


def draw_material(nodes, rng):
    """Draw the recipe of a material."""
    spec = {"tree": {}}
    if rng.random() < 0.97:
        # Many scenes have a plain material or two.
        spec["tree"]["Surface"] = nodes.shader(rng.choice([0, 1, 2, 3]))
    if rng.random() < 0.03:
        spec["tree"]["Volume"] = {"node": "ShaderNodeVolumePrincipled"}
    if rng.random() < 0.03:
        spec["tree"]["Displacement"] = {"node": "ShaderNodeDisplacement"}
    if rng.random() < 0.1:
        spec["set"] = {"use_backface_culling": True}
    return spec


def draw_world(nodes, rng):
    """Draw the recipe of a world: a colour, an image, a sky, a mixture, or anything."""
    kind = rng.choice(["color", "color", "color", "image", "sky", "mix", "any"])
    background = {"node": "ShaderNodeBackground", "inputs": {}}
    if kind == "color":
        background["inputs"]["Color"] = [*nodes._color(), 1.0]
        background["inputs"]["Strength"] = rng.choice([0.2, 0.5, 1.0])
    elif kind == "image":
        image = nodes.node("ShaderNodeTexEnvironment", rng.randint(0, 1))
        background["inputs"]["Color"] = image
    elif kind == "sky":
        background["inputs"] = {"Color": {"node": "ShaderNodeTexSky"}, "Strength": 0.1}
    elif kind == "mix":
        background = nodes.node("ShaderNodeMixShader", 0)
        background.setdefault("inputs", {})
        for socket in ("Shader", "Shader_001"):
            background["inputs"][socket] = nodes.node("ShaderNodeBackground", 1)
    else:
        background = nodes.shader(2)
    return {"tree": {"Surface": background}}
