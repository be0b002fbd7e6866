"""Upper bounds of the radiance of surfaces, and which are mirrors: from their node graphs alone.

Highlights are searched only on surfaces whose bound exceeds the highlight threshold, and from
several places on the lens only on surfaces whose reflections depend on the place.
"""

import numpy as np

from .surface_graph import Constant

# Largest reflectance of a white surface: the tables of GGX lobes are not exact.
_REFLECTANCE = 1.1
# Blend modes whose result is never above both colours and their product.
_BOUNDED_BLENDS = frozenset({"MIX", "DARKEN", "LIGHTEN", "MULTIPLY", "HUE", "COLOR", "VALUE"})
_SORTING_KINDS = frozenset({"luminance", "separate", "combine"})
# How much more than Lambert's a rough diffuse surface may reflect at an angle.
_ROUGH = 2.0
# Closures that mirror.
_MIRRORS = frozenset({"glossy", "metallic", "glass"})
# All surfaces that reflect.
_REFLECTORS = _MIRRORS | {"diffuse", "translucent", "principled", "sheen", "toon", "hair"}
# Roughness that stands for what a texture gives.
_TYPICAL_ROUGHNESS = 0.5
# Largest gain of a glossy surface with a colour above 1 by multiple scattering.
_REPEATED = 2.0


def brightest(content):
    """Bound the radiance of every group's surfaces.

    Parameters
    ----------
    content : SceneContent

    Returns
    -------
    list of tuple of float
        For each group, one bound for each slot of its mesh that has triangles: radiance of the
        largest channel, without lamps whose *Highlights* is *Never*; inf where the graph gives no
        bound.
    """
    known = {}
    reflected = _brightest_reflection(content)
    return [
        tuple(
            _bound(content, known, reflected, group, slot)
            for slot, _, _ in content.meshes[group.mesh].slots
        )
        for group in content.groups
    ]


def mirrors(graph):
    """Whether a surface only reflects, and its reflections depend on the place on the lens.

    Parameters
    ----------
    graph : SurfaceGraph

    Returns
    -------
    bool
        False for surfaces that also emit: their emission outshines their reflections.
    """
    return not emits(graph) and any(_mirrors(node) for node in graph.nodes)


def reflects(graph):
    """Whether a surface has no light of its own: what it shows depends on the side that is seen.

    Parameters
    ----------
    graph : SurfaceGraph

    Returns
    -------
    bool
    """
    return not emits(graph) and any(node.kind in _REFLECTORS for node in graph.nodes)


def sharpest_gloss(graph):
    """Return the least roughness of the reflections of a surface that mirrors.

    Parameters
    ----------
    graph : SurfaceGraph

    Returns
    -------
    float
        0 to 1; 0.5 where a texture gives it.
    """
    sources = [dict(node.inputs).get("Roughness") for node in graph.nodes if _mirrors(node)]
    return min(
        (s.value[0] if isinstance(s, Constant) else _TYPICAL_ROUGHNESS for s in sources),
        default=1.0,
    )


def _mirrors(node):
    return node.kind in _MIRRORS or (node.kind == "principled" and not _is_matt(node))


def emits(graph):
    """Whether a surface may emit light.

    Parameters
    ----------
    graph : SurfaceGraph

    Returns
    -------
    bool
    """
    names = {
        "emission": ("Color", "Strength"),
        "principled": ("Emission Color", "Emission Strength"),
    }
    return any(
        not any(_is_zero(node.input(name)) for name in names[node.kind])
        for node in graph.nodes
        if node.kind in names
    )


def _is_matt(principled):
    return all(_is_zero(principled.input(name)) for name in ("Metallic", "Specular IOR Level"))


def _is_zero(source):
    return isinstance(source, Constant) and not any(source.value)


def _brightest_reflection(content):
    """Return the largest radiance that a white surface may reflect of lights and world."""
    world = content.world.lighting or content.world
    if world.image or any(light.highlights for light in content.lights):
        return np.inf
    return _REFLECTANCE * max(map(abs, world.color))


def _bound(content, known, reflected, group, slot):
    if group.holdout:
        return 0.0
    key = (group.materials[slot], group.mesh)
    if key not in known:
        graph = content.materials[key[0]].graph
        mesh = content.meshes[group.mesh]
        known[key] = _graph_bound(graph, mesh, content.images, reflected)
    return known[key]


def _graph_bound(graph, mesh, images, reflected):
    if graph.surface is None:
        return 0.0
    bounds = []

    def of(source):
        if isinstance(source, Constant):
            return max(map(abs, source.value))
        return bounds[source.node]

    for node in graph.nodes:
        inputs = dict(node.inputs)
        if node.kind in {"none", "transparent", "holdout"}:
            bound = 0.0
        elif node.kind == "emission":
            color, strength = of(inputs["Color"]), of(inputs["Strength"])
            bound = _product(color, strength)
        elif node.kind in {"diffuse", "glossy", "translucent", "metallic", "glass"}:
            color = of(inputs["Color"])
            # Edges of metals are white; thin glass mirrors with two faces.
            if node.kind in {"metallic", "glass"}:
                color = max(color, 1.0) * (2.0 if node.kind == "glass" else 1.0)
            if node.kind == "diffuse" and "Roughness" in inputs:
                color *= _ROUGH
            bound = _product(color, reflected)
            if node.kind == "glossy" and color > 1.0:
                bound *= _REPEATED
        elif node.kind == "principled":
            # A metal, or the coat of the diffuse part, is never brighter than white.
            color, strength = of(inputs["Emission Color"]), of(inputs["Emission Strength"])
            reflectance = max(of(inputs["Base Color"]), 1.0)
            reflectance += ("Coat Weight" in inputs) + ("Sheen Weight" in inputs)
            if "Diffuse Roughness" in inputs:
                reflectance *= _ROUGH
            bound = _product(reflectance, reflected) + _product(color, strength)
        elif node.kind == "mix_shader":
            bound = max(of(inputs["Shader"]), of(inputs["Shader_001"]))
        elif node.kind == "add_shader":
            bound = of(inputs["Shader"]) + of(inputs["Shader_001"])
        elif node.kind == "generated":
            bound = mesh.peaks.get("generated", 0.0)
        elif node.kind in {"color_attribute", "attribute"}:
            bound = _attribute_bound(mesh, node.setting("name"))
        elif node.kind == "image_texture" and not node.setting("associated"):
            # One that is missing is drawn in a colour of 1; where alpha multiplies the colour, the
            # code may divide by it.
            bound = images[node.image].peak if node.image in images else 1.0
        else:
            bound = _value_bound(node, of)
        bounds.append(float(bound))
    return bounds[graph.surface.node]


def _value_bound(node, of):
    """Bound the value that a node computes from numbers and colours; inf where it has no bound."""
    if node.setting("clamp") and node.kind == "math" or node.setting("clamp_result"):
        return 1.0
    if node.kind in {"mix_color", "mix_value"}:
        a, b = of(node.input("a")), of(node.input("b"))
        # Beyond its ends a mix has no bound.
        if node.setting("clamp_factor") and node.setting("blend", "MIX") in _BOUNDED_BLENDS:
            return max(a, b, _product(a, b))
    elif node.kind == "ramp":
        return max(abs(value) for row in node.table for value in row)
    elif node.kind == "hue_saturation":
        color = of(node.input("Color"))
        return max(color, _product(color, of(node.input("Value"))))
    elif node.kind == "invert" and of(node.input("Fac")) <= 1.0:
        return of(node.input("Color")) + 1.0
    elif node.kind in _SORTING_KINDS and node.setting("model", "RGB") in {"RGB", "XYZ"}:
        return max(of(source) for _, source in node.inputs)
    return np.inf


def _product(a, b):
    return a * b if a and b else 0.0


def _attribute_bound(mesh, name):
    peaks = [peak for key, peak in mesh.peaks.items() if key.partition(":")[2] == name]
    # Alpha may be 1 where there is no such colour.
    return max([1.0, *peaks])
