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

# isort: split
# Modules of Blender are there once bpy is imported; it does not look beside a script it runs.
sys.path.insert(0, str(Path(__file__).resolve().parent))

from demo_objects import build_candle, build_cup, build_near_object, build_subject, build_table
from demo_shapes import add, emission, sphere
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
