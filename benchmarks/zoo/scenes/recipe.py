"""Random scenes as data.

A recipe is made of plain values (what JSON can hold) and follows from its seed and number alone;
`script.build` makes the scene. Whatever may be missing of it may be left out: that is how
`shrink.shrink` makes small scenes of large ones.
"""

import random

from .random_nodes import NodeDrawer, draw_material, draw_world
from .random_objects import draw_backdrop, draw_camera, draw_light, draw_object
from .random_settings import draw_settings, even

# Sides of pictures, in pixels: tiny, because a check of a scene is worth more than one of a pixel.
_SIDES = (1, 2, 3, 5, 9, 16, 17, 24, 31, 32, 33, 48)
# Blender's own least resolution; fewer pixels are a share of it.
_SMALLEST_SIDE = 4

_LAYER_PASSES = (
    *("use_pass_z", "use_pass_normal", "use_pass_position", "use_pass_vector"),
    *("use_pass_cryptomatte_object", "use_pass_cryptomatte_material"),
)
# Passes of Blender that Aplanat does not have: switched on, they must do no harm.
_OTHER_PASSES = ("use_pass_mist", "use_pass_uv", "use_pass_shadow", "use_pass_diffuse_direct")


def make_recipe(bpy, seed, number):
    """Draw a scene.

    Parameters
    ----------
    bpy : module
        With Aplanat registered: nodes and settings are what Blender says they are. The scene that
        is open in it is emptied.
    seed, number : int
        Number of the scene among those of the seed. Every second scene has our default settings.

    Returns
    -------
    dict
        ``scene``, ``materials``, ``world``, ``collections``, ``objects``, ``lights``, ``camera``,
        ``layers`` and ``settings``: what `pieces` makes of them.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    rng = random.Random(f"{seed}:{number}")
    with NodeDrawer(rng, bpy) as nodes:
        names = [f"m{i}" for i in range(rng.randint(1, 4))]
        materials = {name: draw_material(nodes, rng) for name in names}
        film = _draw_film(rng)
        camera, view = draw_camera(rng, max(film["render.resolution_x"], 16))
        recipe = {"scene": film, "materials": materials}
        if rng.random() < 0.85:
            recipe["world"] = draw_world(nodes, rng)
        recipe["collections"] = ["A", "B"][: rng.choice([0, 0, 1, 2])]
        count = rng.choice([0, *range(1, 5), *range(3, 10), *range(3, 10)])
        recipe["objects"] = [draw_object(rng, names, view) for _ in range(count)]
        if count and rng.random() < 0.4:
            recipe["objects"].append(draw_backdrop(rng, names, view))
        for spec in recipe["objects"]:
            if recipe["collections"] and rng.random() < 0.6:
                spec["collection"] = rng.choice(recipe["collections"])
        count = rng.choice([0, 1, 1, 2, 3])
        recipe["lights"] = [draw_light(rng, nodes, view) for _ in range(count)]
    if recipe["objects"] and "dof.use_dof" in camera["set"] and rng.random() < 0.15:
        chosen = rng.randrange(len(recipe["objects"]))
        name = f"{recipe['objects'][chosen]['kind'].lower()} {chosen}"
        camera["set"]["dof.focus_object"] = {"of": "objects", "name": name}
    recipe["camera"] = camera
    recipe["layers"] = _draw_layers(rng, recipe["collections"], names)
    recipe["settings"] = {"render.engine": "APLANAT"}
    if number % 2:
        _draw_own_settings(bpy, rng, recipe)
    elif rng.random() < 0.2:
        _draw_lens(bpy, rng, recipe)
    return recipe


def _draw_film(rng):
    size = [rng.choice(_SIDES[-6:] if rng.random() < 0.8 else _SIDES) for _ in "xy"]
    settings = {
        "render.resolution_x": size[0],
        "render.resolution_y": size[1],
        # The factory's pictures are shown by AgX.
        "view_settings.view_transform": rng.choice(["Standard", "AgX", "Filmic"]),
    }
    if min(size) < _SMALLEST_SIDE:
        settings["render.resolution_x"] = 4 * size[0]
        settings["render.resolution_y"] = 4 * size[1]
        settings["render.resolution_percentage"] = 25
    if rng.random() < 0.2:
        left, bottom = even(rng, 0.0, 0.6), even(rng, 0.0, 0.6)
        settings |= {
            "render.use_border": True,
            "render.border_min_x": left,
            "render.border_min_y": bottom,
            "render.border_max_x": even(rng, left, 1.0),
            "render.border_max_y": even(rng, bottom, 1.0),
        }
        if rng.random() < 0.5:
            settings["render.use_crop_to_border"] = True
        _widen(settings, size)
    if rng.random() < 0.3:
        settings["render.film_transparent"] = True
    if rng.random() < 0.2:
        settings["render.filter_size"] = rng.choice([0.0, 0.5, 3.0])
    if rng.random() < 0.1:
        settings |= {"render.pixel_aspect_x": even(rng, 1.0, 3.0)}
    if rng.random() < 0.1:
        settings["view_settings.exposure"] = even(rng, -2.0, 2.0)
    if rng.random() < 0.1:
        settings["render.use_simplify"] = True
    return settings


def _widen(settings, size):
    """Make a border hold a pixel: one without is refused, rightly."""
    for axis, pixels in zip("xy", size, strict=True):
        low, high = (settings[f"render.border_{end}_{axis}"] for end in ("min", "max"))
        if int(high * pixels) <= int(low * pixels):
            settings[f"render.border_min_{axis}"] = 0.0
            settings[f"render.border_max_{axis}"] = 1.0


def _draw_layers(rng, collections, materials):
    layers = []
    for _ in range(rng.choice([1, 1, 1, 1, 2])):
        settings = {}
        for name in _LAYER_PASSES:
            if rng.random() < 0.25:
                settings[name] = True
        for name in _OTHER_PASSES:
            if rng.random() < 0.05:
                settings[name] = True
        if rng.random() < 0.2:
            settings["pass_cryptomatte_depth"] = rng.choice([2, 4, 8, 16])
        if rng.random() < 0.05:
            settings["material_override"] = {"of": "materials", "name": rng.choice(materials)}
        for name in ("use_sky", "use_solid", "use_strand"):
            if rng.random() < 0.05:
                settings[name] = False
        switches = {}
        for name in collections:
            chosen = rng.choice(["", "", "exclude", "holdout", "indirect_only"])
            if chosen:
                switches[name] = {chosen: True}
        layers.append({"set": settings, "collections": switches})
    return layers


def _draw_own_settings(bpy, rng, recipe):
    """Draw every setting that Aplanat adds to Blender's data-blocks."""
    recipe["settings"] |= draw_settings(rng, bpy.context.scene.aplanat, "aplanat.")
    trials = {
        "camera": (bpy.data.cameras, bpy.data.cameras.new("trial"), [recipe["camera"]]),
        "world": (bpy.data.worlds, bpy.data.worlds.new("trial"), [recipe.get("world")]),
        "material": (
            *(bpy.data.materials, bpy.data.materials.new("trial")),
            recipe["materials"].values(),
        ),
        "light": (bpy.data.lights, bpy.data.lights.new("trial", "POINT"), recipe["lights"]),
        "layer": (None, bpy.context.view_layer, recipe["layers"]),
    }
    for blocks, block, specs in trials.values():
        for spec in specs:
            if spec is not None:
                drawn = draw_settings(rng, block.aplanat, "aplanat.")
                spec["set"] = spec.get("set", {}) | drawn
        if blocks is not None:
            blocks.remove(block)


def _draw_lens(bpy, rng, recipe):
    """Give the camera a real lens; all else keeps its default."""
    camera = bpy.data.cameras.new("trial")
    lens = draw_settings(rng, camera.aplanat)["lens"]
    recipe["camera"]["set"]["aplanat.lens"] = lens
    bpy.data.cameras.remove(camera)
