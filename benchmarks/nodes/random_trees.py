"""Random trees of shader nodes, each glowing on a card of its own.

A tree has some nodes of any kind that gives numbers, vectors or colours, with random settings and
values; inputs are fed by earlier nodes or coordinates. The same seed gives the same tree.
"""

import math
import random

import numpy as np

# Pixels along a side of a card.
CARD_PX = 64
# Kinds of nodes, by Blender's type without ``ShaderNode``. Of others a tree tells nothing: what
# rays find (Raycast, Bevel, Ambient Occlusion), files of lamps, scripts, light from other engines;
# White Noise makes of the last bit of what feeds it another number.
KINDS = (
    *("Math", "VectorMath", "Mix", "MapRange", "Clamp", "CombineXYZ", "SeparateXYZ"),
    *("CombineColor", "SeparateColor", "HueSaturation", "Gamma", "BrightContrast", "Invert"),
    *("RGBToBW", "ValToRGB", "RGBCurve", "VectorCurve", "FloatCurve", "Blackbody", "Wavelength"),
    *("Mapping", "VectorRotate", "VectorTransform", "Normal", "NormalMap", "Bump"),
    *("TexNoise", "TexVoronoi", "TexWave", "TexMagic", "TexChecker", "TexBrick", "TexGradient"),
    *("TexGabor", "TexImage", "TexEnvironment", "TexSky", "RadialTiling"),
    *("TexCoord", "NewGeometry", "ObjectInfo", "CameraData", "LightPath", "Fresnel"),
    *("LayerWeight", "Tangent", "UVMap", "Attribute", "VertexColor", "RGB", "Value"),
    *("HairInfo", "ParticleInfo", "LightFalloff", "Wireframe"),
)
# Settings that say nothing of what a node computes, or name things that are not there.
_LEFT_ALONE = frozenset({"use_auto_update", "is_active_output", "from_instancer", "attribute_type"})
# Larger numbers of some inputs show nothing but noise of single pixels.
_RANGES = {"Scale": (0.5, 4.0), "Detail": (0.0, 4.0), "Sides": (2.0, 8.0), "Distance": (0.1, 1.0)}
_RANGES |= {"Lacunarity": (1.2, 3.0), "Frequency": (1.0, 4.0)}
_RANGES |= {"Temperature": (1000.0, 9000.0), "Wavelength": (380.0, 780.0), "IOR": (1.05, 2.0)}


# Fed with what varies, these turn rounding into noise of single pixels, or have no meaning.
_UNFED = frozenset({"Scale", "Detail Scale", "Lacunarity", "Detail", "Sides", "Frequency"})


def fill(bpy, tree, seed, image):
    """Fill a material's node tree by a random one that glows.

    Parameters
    ----------
    bpy : module
    tree : bpy.types.ShaderNodeTree
    seed : int
    image : bpy.types.Image
        Of image nodes.

    Returns
    -------
    list of str
        The kinds of its nodes, in the order of their making.
    """
    rng = random.Random(seed)
    tree.nodes.clear()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    outputs = [coordinates.outputs[name] for name in ("UV", "Object", "Generated")]
    kinds = []
    for _ in range(rng.randint(2, 7)):
        kind = rng.choice(KINDS)
        node = tree.nodes.new(f"ShaderNode{kind}")
        kinds.append(kind)
        _choose_settings(node, rng, image)
        _feed(tree, node, rng, outputs)
        outputs += [s for s in node.outputs if s.enabled and s.type in {"VALUE", "VECTOR", "RGBA"}]
    emission = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    last = [s for s in node.outputs if s.enabled and s.type in {"VALUE", "VECTOR", "RGBA"}]
    tree.links.new(rng.choice(last), emission.inputs["Color"])
    return kinds


def _choose_settings(node, rng, image):
    base = {p.identifier for p in type(node).__mro__[1].bl_rna.properties}
    for setting in type(node).bl_rna.properties:
        name = setting.identifier
        if name in base or name in _LEFT_ALONE or setting.is_readonly:
            continue
        if setting.type == "ENUM" and not setting.is_enum_flag:
            choices = [item.identifier for item in setting.enum_items]
            if choices:
                _set(node, name, rng.choice(choices))
        elif setting.type == "BOOLEAN":
            _set(node, name, rng.random() < 0.5)
    if hasattr(node, "image"):
        node.image = image
    if node.type == "TEX_SKY":
        node.sun_disc = False
        node.sun_elevation, node.sun_rotation = rng.uniform(-0.1, 1.5), rng.uniform(0.0, 6.0)
    if node.type == "ATTRIBUTE":
        node.attribute_name = rng.choice(("Col", "UVMap"))
    if node.type == "VALTORGB":
        node.color_ramp.elements.new(rng.random())
        for element in node.color_ramp.elements:
            element.color = [rng.random() for _ in range(4)]
    if hasattr(node, "mapping") and hasattr(node.mapping, "curves"):
        for curve in node.mapping.curves:
            curve.points.new(rng.uniform(0.2, 0.8), rng.random())
        node.mapping.update()
    if node.type in {"RGB", "VALUE"}:
        _randomize(node.outputs[0], rng)


def _set(node, name, value):
    try:
        setattr(node, name, value)
    except TypeError:
        # A choice that this kind of node has not, as Mix of strings.
        return


def _feed(tree, node, rng, outputs):
    for socket in node.inputs:
        if not socket.enabled or socket.type not in {"VALUE", "VECTOR", "RGBA", "INT", "BOOLEAN"}:
            continue
        if socket.name == "Normal" and rng.random() < 0.8:
            continue
        # Vectors without a link are the same all over the card.
        share = 0.9 if socket.type == "VECTOR" else 0.4
        if socket.name not in _UNFED and rng.random() < share:
            tree.links.new(rng.choice(outputs[-6:]), socket)
        else:
            _randomize(socket, rng)


def _randomize(socket, rng):
    low, high = _RANGES.get(socket.name, (0.0, 1.0))
    value = socket.default_value
    if isinstance(value, bool):
        socket.default_value = rng.random() < 0.5
    elif isinstance(value, int):
        socket.default_value = rng.randint(0, 4)
    elif isinstance(value, float):
        socket.default_value = rng.uniform(low, high)
    elif socket.type in {"VECTOR", "RGBA", "ROTATION"}:
        for i in range(len(value)):
            value[i] = rng.uniform(low, high)


def build(bpy, seeds, card_px=CARD_PX):
    """Replace the open file by a scene with a card for each seed.

    Parameters
    ----------
    bpy : module
    seeds : sequence of int
    card_px : int

    Returns
    -------
    scene : bpy.types.Scene
    kinds : list of list of str
    """
    from .sheet import card, picture

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    columns = math.ceil(math.sqrt(len(seeds)))
    scene.render.resolution_x = scene.render.resolution_y = columns * card_px
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.0 * columns
    camera.location.z = 10.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    image = picture(bpy)
    kinds = []
    for number, seed in enumerate(seeds):
        row, column = divmod(number, columns)
        mesh = card(bpy)
        thing = bpy.data.objects.new(f"tree {seed}", mesh)
        thing.location = (2.0 * column - columns + 1.0, 2.0 * row - columns + 1.0, 0.0)
        scene.collection.objects.link(thing)
        material = bpy.data.materials.new(f"tree {seed}")
        mesh.materials.append(material)
        kinds.append(fill(bpy, material.node_tree, seed, image))
    return scene, kinds


def agreement(seeds, ours, cycles, card_px=CARD_PX):
    """Return the share of each tree's pixels that agree within 4/255 as displayed.

    Parameters
    ----------
    seeds : sequence of int
    ours, cycles : ndarray of shape (height, width, 4)
        Scene linear, top row first.
    card_px : int

    Returns
    -------
    list of float
    """
    from .sheet import encoded

    columns = math.ceil(math.sqrt(len(seeds)))
    found = []
    for number in range(len(seeds)):
        row, column = divmod(number, columns)
        inner = tuple(slice(i * card_px + 1, (i + 1) * card_px - 1) for i in (row, column))
        a, b = (encoded(p[::-1][inner][..., :3]) for p in (ours, cycles))
        found.append(float((np.abs(a - b).max(axis=2) <= 4.0).mean()))
    return found
