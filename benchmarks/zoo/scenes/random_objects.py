"""Random objects of every kind, lights and cameras."""

import math
from dataclasses import dataclass

from .random_nodes import ATTRIBUTES
from .random_settings import around, even, round_value

_KINDS = {
    "MESH": 22,
    "CURVE": 1,
    "TEXT": 1,
    "METABALL": 1,
    "SURFACE": 1,
    "HAIR": 1,
    "POINTCLOUD": 1,
    "VOLUME": 1,
    "PENCIL": 1,
    "OTHER": 1,
    "INSTANCE": 1,
}
_SHAPES = ("grid", "cube", "sphere", "ico", "ngon", "monkey", "soup", "edges", "flat", "nothing")


@dataclass(frozen=True)
class View:
    """Where a camera that looks along +y from the origin sees things, and how large.

    Parameters
    ----------
    near, far : float
        Between which objects are put, in m.
    half : callable
        Half the width of what is seen at a distance, in m.
    """

    near: float
    far: float
    half: object


# Around the middle of an empty, whose own scale makes all smaller.
_INSIDE = View(0.3, 1.0, lambda _distance: 1.0)


def draw_object(rng, materials, view, depth=1):
    """Draw the recipe of an object.

    Parameters
    ----------
    rng : random.Random
    materials : list of str
        Names.
    view : View
    depth : int
        How often objects may still hold others.

    Returns
    -------
    dict
        For `pieces.make_object`.
    """
    kinds = dict(_KINDS) if depth else {k: w for k, w in _KINDS.items() if k != "INSTANCE"}
    kind = rng.choices(list(kinds), list(kinds.values()))[0]
    spec = {"kind": kind, **globals()[f"_{kind.lower()}"](rng, materials, depth)}
    settings = {**_placed(rng, view), **_switches(rng)}
    spec["set"] = settings | spec.get("set", {})
    if rng.random() < 0.1:
        place = settings["location"]
        spec["keys"] = [[0, place], [2, [c + even(rng, -0.5, 0.5) for c in place]]]
    return spec


def draw_backdrop(rng, materials, view):
    """Draw the recipe of a wall behind all others, so that blurred edges have something behind."""
    distance = round_value(view.far * 1.2)
    size = round_value(3.0 * view.half(distance))
    spec = {"kind": "MESH", "shape": "grid", "count": rng.randint(1, 30)}
    spec["materials"] = [rng.choice([*materials, None])]
    spec["colors"] = [["Col", "FLOAT_COLOR", "POINT"]]
    return spec | {"set": {"location": [0.0, distance, 0.0], "scale": [size] * 3}}


def _placed(rng, view):
    distance = around(rng, view.near, view.far)
    half = view.half(distance)
    settings = {
        "location": [
            round_value(even(rng, -0.9, 0.9) * half),
            distance,
            round_value(even(rng, -0.7, 0.7) * half),
        ]
    }
    if rng.random() < 0.6:
        settings["rotation_euler"] = [even(rng, -3.2, 3.2) for _ in "xyz"]
    size = around(rng, 0.08, 1.5) * half
    if rng.random() < 0.06:
        # What scripts and drivers leave behind: mirrored, flat, far too large.
        factors = [rng.choice([-1.0, 0.0, 1.0, 20.0]) for _ in "xyz"]
    else:
        factors = [1.0] * 3
    settings["scale"] = [round_value(size * factor) for factor in factors]
    return settings


def _switches(rng):
    chances = {
        "is_holdout": (0.06, True),
        "visible_camera": (0.03, False),
        "hide_render": (0.03, True),
        "is_shadow_catcher": (0.03, True),
        "visible_shadow": (0.05, False),
    }
    return {name: value for name, (chance, value) in chances.items() if rng.random() < chance}


def _materials(rng, materials, most=3):
    names = [*materials, None]
    return [rng.choice(names) for _ in range(rng.choice([1, 1, 1, rng.randint(0, most)]))]


def _mesh(rng, materials, depth):
    shape = rng.choices(_SHAPES, [8, 6, 6, 6, 2, 2, 4, 1, 1, 1])[0]
    spec = {"shape": shape, "materials": _materials(rng, materials)}
    counts = {"grid": (1, 40), "sphere": (3, 40), "ico": (1, 5), "ngon": (3, 40), "soup": (1, 90)}
    if shape in counts:
        spec["count"] = rng.randint(*counts[shape])
    if shape == "edges":
        spec["count"] = rng.randint(3, 6)
    if len(spec["materials"]) > 1:
        spec["slots"] = len(spec["materials"])
    if rng.random() < 0.3:
        spec["uvs"] = [rng.choice(ATTRIBUTES[:2])]
    if rng.random() < 0.4:
        spec["colors"] = [
            [
                rng.choice(ATTRIBUTES[2:4]),
                rng.choice(["BYTE_COLOR", "FLOAT_COLOR"]),
                rng.choice(["POINT", "CORNER"]),
            ]
        ]
    if rng.random() < 0.4:
        spec["smooth"] = True
    if rng.random() < 0.3:
        spec["modifiers"] = [_modifier(rng) for _ in range(rng.randint(1, 2))]
    if depth and rng.random() < 0.1:
        spec["particles"] = _particles(rng, materials)
    elif rng.random() < 0.1:
        spec["points"] = {
            "radius": around(rng, 0.02, 0.5),
            "subdivisions": rng.randint(1, 2),
            "material": rng.choice([*materials, ""]),
        }
        if rng.random() < 0.3:
            spec["points"]["realize"] = True
    _lighten(spec)
    return spec


def _lighten(spec):
    """Keep what multiplies triangles from making more of them than the time of a check is for."""
    many = ("modifiers" in spec) + 2 * ("points" in spec)
    most = {"ico": (5, 4, 3, 2), "grid": (40, 25, 16, 12), "sphere": (40, 25, 16, 12)}
    if spec["shape"] in most:
        spec["count"] = min(spec["count"], most[spec["shape"]][many])
    if many == 3:
        spec["points"]["subdivisions"] = 1


def _modifier(rng):
    settings = {
        "SUBSURF": {"render_levels": rng.randint(0, 1)},
        "ARRAY": {"count": rng.randint(1, 6)},
        "BEVEL": {"width": 0.1},
        "SOLIDIFY": {"thickness": even(rng, -0.2, 0.2)},
        "MIRROR": {},
        "WIREFRAME": {"thickness": 0.05},
        "DECIMATE": {"ratio": even(rng, 0.0, 1.0)},
        "TRIANGULATE": {},
        "SCREW": {"render_steps": 3},
        "BUILD": {},
        "EDGE_SPLIT": {},
    }
    kind = rng.choice(list(settings))
    return {"type": kind, "set": settings[kind]}


def _particles(rng, materials):
    if rng.random() < 0.4:
        return {"set": {"type": "HAIR", "count": rng.randint(1, 20)}}
    return {
        "set": {
            "count": rng.randint(1, 40),
            "frame_start": -20.0,
            "frame_end": 1.0,
            "particle_size": around(rng, 0.02, 0.5),
            "render_type": rng.choice(["OBJECT", "OBJECT", "HALO", "NONE"]),
        },
        "shown": {
            "kind": "MESH",
            "shape": "ico",
            "count": 1,
            "materials": [rng.choice([*materials, None])],
        },
    }


def _curve(rng, materials, depth):
    kinds = [rng.choice(["BEZIER", "POLY", "NURBS"]) for _ in range(rng.randint(0, 2))]
    return {
        "splines": [
            [kind, [[even(rng, -0.6, 0.6) for _ in "xyz"] for _ in range(rng.randint(1, 6))]]
            for kind in kinds
        ],
        "data": {
            "bevel_depth": rng.choice([0.0, around(rng, 0.005, 0.2)]),
            "extrude": rng.choice([0.0, 0.1]),
        },
        "materials": _materials(rng, materials, 1),
    }


def _text(rng, materials, depth):
    return {
        "data": {
            "body": rng.choice(["", "A", "Aplanat", "\u00e4\u4e2d\n?"]),
            "extrude": rng.choice([0.0, 0.1]),
            "bevel_depth": rng.choice([0.0, 0.02]),
            "align_x": "CENTER",
        },
        "materials": _materials(rng, materials, 1),
    }


def _metaball(rng, materials, depth):
    return {
        "elements": [
            [[even(rng, -0.5, 0.5) for _ in "xyz"], even(rng, 0.1, 0.8)]
            for _ in range(rng.randint(0, 3))
        ],
        # In the ball's own units: the scale of the object is taken on top.
        "data": {"render_resolution": 0.2, "resolution": 0.3},
        "materials": _materials(rng, materials, 1),
    }


def _surface(rng, materials, depth):
    shapes = ("sphere", "torus", "cylinder", "surface", "circle", "curve")
    return {
        "primitive": f"primitive_nurbs_surface_{rng.choice(shapes)}_add",
        "materials": _materials(rng, materials, 1),
    }


def _hair(rng, materials, depth):
    return {"count": rng.choice([0, 5]), "materials": _materials(rng, materials, 1)}


_pointcloud = _hair


def _pencil(rng, materials, depth):
    return {"count": rng.choice([0, 3])}


def _volume(rng, materials, depth):
    return {"materials": _materials(rng, materials, 1)}


def _other(rng, materials, depth):
    kinds = ("", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE", "CAMERA")
    return {"type": rng.choice(kinds)}


def _instance(rng, materials, depth):
    count = rng.choice([0, 1, 2, 3])
    return {"objects": [draw_object(rng, materials, _INSIDE, depth - 1) for _ in range(count)]}


def draw_light(rng, nodes, view):
    """Draw the recipe of a light."""
    kind = rng.choice(["SUN", "POINT", "SPOT", "AREA"])
    settings = {"energy": around(rng, 0.1, 20.0) if kind == "SUN" else around(rng, 1.0, 1000.0)}
    if rng.random() < 0.5:
        settings["color"] = [even(rng, 0.0, 1.0) for _ in "rgb"]
    sizes = {
        "SUN": {"angle": even(rng, 0.0, 3.1)},
        "POINT": {"shadow_soft_size": rng.choice([0.0, around(rng, 0.01, 2.0)])},
        "SPOT": {"spot_size": even(rng, 0.02, 3.14), "spot_blend": even(rng, 0.0, 1.0)},
        "AREA": {
            "shape": rng.choice(["SQUARE", "RECTANGLE", "DISK", "ELLIPSE"]),
            "size": around(rng, 0.01, 10.0),
            "spread": even(rng, 0.02, 3.14),
        },
    }
    if rng.random() < 0.7:
        settings |= sizes[kind]
    if rng.random() < 0.15:
        settings |= {"use_temperature": True, "temperature": even(rng, 1000.0, 12000.0)}
    if rng.random() < 0.1:
        settings["normalize"] = False
    if rng.random() < 0.1:
        settings |= {"diffuse_factor": even(rng, 0.0, 1.0), "specular_factor": 0.0}
    spec = {"type": kind, "set": settings}
    if rng.random() < 0.1:
        spec["tree"] = {"Surface": nodes.node("ShaderNodeEmission", rng.randint(0, 1))}
    distance = around(rng, view.near, view.far)
    if kind != "SUN":
        # So that what lies at its distance is about as bright whatever the scene's size is.
        settings["energy"] = round_value(settings["energy"] * distance**2)
    spec["object"] = {
        "location": [
            round_value(even(rng, -1.0, 1.0) * distance),
            round_value(even(rng, -0.5, 1.5) * distance),
            round_value(even(rng, -0.3, 1.0) * distance),
        ],
        # Most shine away from the camera, on what it sees.
        "rotation_euler": [even(rng, -0.5, 2.0), even(rng, -0.5, 0.5), even(rng, -1.0, 1.0)],
    }
    if rng.random() < 0.1:
        spec["object"]["scale"] = [rng.choice([-1.0, 0.0, 3.0, 0.1]) for _ in "xyz"]
    return spec


def draw_camera(rng, width):
    """Draw the recipe of a camera, which mostly looks along +y from the origin.

    Parameters
    ----------
    rng : random.Random
    width : int
        Of the picture, in pixels.

    Returns
    -------
    camera : dict
        For `pieces.make_camera`.
    view : View
        Where objects are seen.
    """
    settings, placed = {}, {}
    focus = around(rng, 0.3, 30.0)
    near, far = round_value(focus * around(rng, 0.2, 1.0)), round_value(focus * around(rng, 1, 5.0))
    look = rng.random()
    if look < 0.02:
        placed["rotation_euler"] = [math.pi / 2, 0.0, math.pi]
    elif look < 0.06:
        # Among the objects, inside some of them.
        placed["location"] = [0.0, focus, 0.0]
    elif look < 0.1:
        placed["scale"] = [rng.choice([0.01, -1.0, 30.0])] * 3
    lens = settings["lens"] = rng.choice([50.0, 35.0, 85.0, around(rng, 8.0, 400.0)])
    if rng.random() < 0.2:
        seen = around(rng, 0.1, 10.0)
        settings |= {"type": "ORTHO", "ortho_scale": seen}
        focal_length, pixels = 1.0, width / seen
        view = View(near, far, lambda _distance: seen / 2.0)
    else:
        focal_length, pixels = lens / 1000.0, lens / 36.0 * width / focus
        view = View(near, far, lambda distance: distance * 18.0 / lens)
    if rng.random() < 0.2:
        settings |= {"shift_x": even(rng, -0.5, 0.5), "shift_y": even(rng, -0.3, 0.3)}
    if rng.random() < 0.2:
        settings["sensor_fit"] = rng.choice(["HORIZONTAL", "VERTICAL"])
    if rng.random() < 0.15:
        settings["clip_start"] = around(rng, 1e-4, near * 2.0)
    if rng.random() < 0.15:
        settings["clip_end"] = around(rng, focus, 1e5)
    if rng.random() < 0.9:
        # The aperture that blurs by so many pixels, in radius, at twice the focus distance.
        blur = around(rng, 0.2, 12.0)
        aperture = 2.0 * blur / pixels
        settings["dof.use_dof"] = True
        settings["dof.aperture_fstop"] = round_value(max(focal_length / (2.0 * aperture), 0.01))
        settings["dof.focus_distance"] = focus
        if rng.random() < 0.3:
            settings["dof.aperture_blades"] = rng.randint(3, 9)
            settings["dof.aperture_rotation"] = even(rng, -3.0, 3.0)
        if rng.random() < 0.2:
            settings["dof.aperture_ratio"] = around(rng, 0.3, 3.0)
    return {"object": placed, "set": settings}, view
