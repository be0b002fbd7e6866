"""Reads Blender's lights into `Light`, in the units of Cycles.

A sun's strength is the irradiance of a surface that faces it. A point or spot light of power P has
the intensity P / 4 pi, an area light the radiance P / (pi area).
"""

import math

import numpy as np

from ...snapshot.content import Light
from ..nodes.node_tree import inlined, source_of
from ..nodes.tree_reader import constant, constant_number, numbers_of

# Most lights, a row each of the light table: every device has textures of this height.
MAX_LIGHTS = 8192
# Largest value in single precision, in which the device computes.
_LARGEST_NUMBER = float(np.finfo(np.float32).max)
# Width of the edge of a spot without blend, in cosines: far below a pixel.
_SHARPEST_EDGE = 1e-6


def read_light(light, matrix):
    """Read a light.

    Parameters
    ----------
    light : bpy.types.Light
    matrix : mathutils.Matrix
        Object to world.

    Returns
    -------
    Light or None
        None for a light without power.
    notes : list of str
        Warnings about settings that are not drawn.
    """
    notes = []
    # Without Cycles' add-on a light has no settings of Cycles.
    if light.type == "AREA" and getattr(getattr(light, "cycles", None), "is_portal", False):
        notes.append("a portal of Cycles gives no light of its own; it is left out")
        return None, notes
    matrix = np.array(matrix, np.float64)
    power = np.array(light.color[:], np.float64) * light.energy * 2.0**light.exposure
    if light.use_temperature:
        power *= light.temperature_color[:]
    if light.node_tree:
        power *= _emission(light, notes)
    if not power.any():
        return None, notes
    if light.type == "SUN":
        # It shines from everywhere: only its direction counts.
        matrix[:3, 3] = 0.0
    if light.use_custom_distance:
        notes.append("the custom distance of EEVEE does not end its light, as in Cycles")
    axes = _unit_axes(matrix)
    read = {"SUN": _sun, "POINT": _point, "SPOT": _spot, "AREA": _area}[light.type]
    values = read(light, matrix, axes, power, notes)
    numbers = (*values["radiance"], values.get("radius", 0.0), *values.get("half_size", ()))
    # As Cycles does.
    if not (np.abs(numbers) <= _LARGEST_NUMBER).all() or not np.isfinite(matrix).all():
        notes.append("its power, size or place is not finite; it does not shine")
        return None, notes
    return (
        Light(
            kind=light.type,
            position=_floats(matrix[:3, 3]),
            # Lights look along their negative z axis.
            direction=_floats(-axes[2]),
            diffuse_factor=light.diffuse_factor,
            specular_factor=light.specular_factor,
            highlights=light.aplanat.highlights != "NEVER",
            shadow=light.use_shadow,
            **values,
        ),
        notes,
    )


def _emission(light, notes):
    """Return the factor of a light's node tree: of one Emission with constant inputs."""
    # The nodes live as long as their tree: `_owner` is kept.
    output, _owner = inlined(light, "EEVEE")
    socket = output and source_of(output.inputs["Surface"], ())[0]
    if not socket or not socket.is_output:
        return np.zeros(3)
    node = socket.node
    if node.type == "EMISSION":
        sources = [source_of(node.inputs[name], ())[0] for name in ("Color", "Strength")]
        if all(not s.is_output or s.node.type in {"RGB", "VALUE"} for s in sources):
            if any(np.isnan(numbers_of(source)).any() for source in sources):
                notes.append("a number of its nodes is not a number; 0 is used")
            return np.array(constant(sources[0]).value) * constant_number(sources[1])
    notes.append("the nodes of a light are not read; its colour and power are used")
    return np.ones(3)


def _sun(light, matrix, axes, power, notes):
    # Not a number counts as no size.
    angle = 0.0 if math.isnan(light.angle) else min(light.angle, math.pi)
    sine = math.sin(angle / 2)
    if not light.normalize and sine > 0.0:
        power = power * (math.pi * sine**2)
    return {"radiance": _floats(power), "radius": sine}


def _intensity(light, power):
    factor = 1.0 / (4.0 * math.pi)
    if not light.normalize:
        # Power a square metre of the sphere; a point counts as one of radius 1 / sqrt(pi).
        radius = light.shadow_soft_size
        factor *= 4.0 * math.pi * radius**2 if radius > 0.0 else 4.0
    return power * factor


def _point(light, matrix, axes, power, notes):
    return {
        "radiance": _floats(_intensity(light, power)),
        "radius": light.shadow_soft_size,
        "soft_falloff": light.use_soft_falloff,
    }


def _spot(light, matrix, axes, power, notes):
    if light.use_square:
        notes.append("a square spot is drawn round")
    cosine = math.cos(light.spot_size / 2)
    edge = max(light.spot_blend * (1.0 - cosine), _SHARPEST_EDGE)
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    # The cone is as much wider across as the object is scaled there, compared with its length.
    rows = axes * np.array([1.0, 1.0, -1.0])[:, None] / np.maximum(scale, 1e-9)[:, None]
    return {
        "radiance": _floats(_intensity(light, power)),
        "radius": light.shadow_soft_size,
        "soft_falloff": light.use_soft_falloff,
        "cone": (cosine, 1.0 / edge),
        "axes": tuple(_floats(row) for row in rows),
    }


def _area(light, matrix, axes, power, notes):
    width = light.size
    height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    half = np.array([width * scale[0], height * scale[1]]) / 2
    half = np.maximum(half, 1e-6)
    if light.shape in {"DISK", "ELLIPSE"}:
        notes.append("a round area light is drawn as a rectangle of the same area")
        half = half * math.sqrt(math.pi) / 2
    area = 4.0 * half[0] * half[1]
    radiance = power / math.pi
    if light.normalize:
        radiance = radiance / area
    cone = (0.0, 0.0)
    if light.spread < math.pi:
        notes.append("the spread of an area light is taken at the light's middle")
        half_spread = max(light.spread / 2, math.radians(0.05))
        tangent = math.tan(half_spread)
        cone = (tangent, 1.0 / (tangent - half_spread))
    return {
        "radiance": _floats(radiance),
        "cone": cone,
        "axes": tuple(_floats(row) for row in axes * np.array([1.0, 1.0, -1.0])[:, None]),
        "half_size": _floats(half),
    }


def _unit_axes(matrix):
    """Rows: the object's axes in world space, of unit length."""
    axes = matrix[:3, :3].T
    sizes = np.linalg.norm(axes, axis=1, keepdims=True)
    return np.divide(axes, sizes, out=np.eye(3), where=sizes > 0.0)


def _floats(values):
    return tuple(float(v) for v in values)
