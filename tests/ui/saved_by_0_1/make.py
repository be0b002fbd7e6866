"""Saves the files that `test_old_files` opens; run with the code of Aplanat 0.1.

    PYTHONPATH=CHECKOUT_OF_0.1 python make.py

Every stored setting has a value that is not its default; of an enumeration each item is in use
somewhere. What was set is written as JSON beside the files.
"""

import json
from pathlib import Path

import bpy

FOLDER = Path(__file__).resolve().parent
# Computed from others, or Blender's own.
COMPUTED = {"lens_choice", "zoom", "spectrum", "rna_type", "name"}
# Two lenses with settings of their own, and one that the library does not have.
LENSES = ("tessar-50mm-f2.8", "planar-50mm-f1.4", "not-in-the-library")


def settings_of(group, path=""):
    """Yield the group, description and path of each setting, also of groups inside."""
    for name, kind in group.bl_rna.properties.items():
        if name in COMPUTED:
            continue
        value = getattr(group, name) if kind.type == "POINTER" else None
        if isinstance(value, bpy.types.PropertyGroup):
            yield from settings_of(value, f"{path}{name}.")
        else:
            yield group, kind, path + name


def values_of(owner):
    """Return all settings of a data-block by path, fit for JSON."""
    found = {}
    for group, kind, path in settings_of(owner.aplanat):
        value = getattr(group, kind.identifier)
        found[path] = value.name if kind.type == "POINTER" and value is not None else value
    return found


def change(owner, variant):
    """Give every number and switch another value than its default, every choice its n-th item."""
    for group, kind, _ in list(settings_of(owner.aplanat)):
        name = kind.identifier
        if kind.type == "BOOLEAN":
            setattr(group, name, not kind.default)
        elif kind.type == "ENUM":
            items = kind.enum_items.keys()
            setattr(group, name, items[variant % len(items)])
        elif kind.type == "INT":
            setattr(group, name, min(kind.default + 1 + variant, kind.soft_max))
        elif kind.type == "FLOAT":
            end = kind.soft_min if kind.default != kind.soft_min else kind.soft_max
            setattr(group, name, kind.default + 0.25 * (end - kind.default))
        elif name == "glass":
            group.glass = ("F2", "N-SF11")[variant % 2]


def make_camera(variant):
    """Make a camera of a variant; the first one has drawn curves, keys, and a memory of lenses."""
    camera = bpy.data.cameras.new(f"camera {variant}")
    camera.use_fake_user = True
    change(camera, variant)
    if variant == 0:
        own = camera.aplanat
        own.lens = LENSES[0]
        own.bokeh.onion, own.chromatic.axial = 0.5, 2.5
        own.lens = LENSES[1]
        own.bokeh.onion, own.chromatic.axial = 0.25, 3.5
        own.zoom_label = "50 mm"
        own.chromatic.axial_first = own.chromatic.lateral_then = "CURVE"
        own.bokeh.iris_image = bpy.data.images.new("iris", 4, 4)
        own.bokeh.iris_image.pack()
        for name, frame, value in (
            ("model", 1, "POINT"),
            ("model", 2, "CLUSTERED"),
            ("threshold", 1, 2.0),
            ("threshold", 2, 4.0),
        ):
            setattr(own.bokeh, name, value)
            own.bokeh.keyframe_insert(name, frame=frame)
    elif variant == 1:
        camera.aplanat.lens = LENSES[2]


def make_others(variant):
    """Make light, material and world of a variant."""
    for owner in (
        bpy.data.lights.new(f"light {variant}", "POINT"),
        bpy.data.materials.new(f"material {variant}"),
        bpy.data.worlds.new(f"world {variant}"),
    ):
        owner.use_fake_user = True
        change(owner, variant)


def all_values():
    """Return the settings of everything in the open file."""
    found = {
        kind: {
            block.name: values_of(block) for block in getattr(bpy.data, kind) if not block.library
        }
        for kind in ("scenes", "cameras", "lights", "materials", "worlds")
    }
    found["view_layers"] = {
        scene.name: values_of(scene.view_layers[0]) for scene in bpy.data.scenes
    }
    return found


def save(name):
    """Save the open file."""
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / name), compress=True, check_existing=False)


def main():
    """Save the library, then the file that links and overrides its camera."""
    import addon

    addon.register()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    owner = bpy.data.cameras.new("linked")
    owner.use_fake_user = True
    change(owner, 1)
    save("library.blend")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    # As many as the longest list of choices has items; only cameras have more than two.
    for variant in range(10):
        make_camera(variant)
    for variant in range(2):
        scene = bpy.context.scene if variant == 0 else bpy.data.scenes.new("another")
        scene.name = f"scene {variant}"
        scene.render.engine = "APLANAT"
        change(scene, variant)
        change(scene.view_layers[0], variant)
        make_others(variant)
    with bpy.data.libraries.load(str(FOLDER / "library.blend"), link=True, relative=True) as (
        _,
        to,
    ):
        to.cameras = ["linked"]
    changed = bpy.data.cameras["linked"].override_create()
    changed.name = "overridden"
    changed.use_fake_user = True
    changed.aplanat.bokeh.model = "CLUSTERED"
    changed.aplanat.chromatic.lateral = 7.0
    scene = bpy.data.scenes["scene 0"]
    for camera in (bpy.data.cameras["camera 0"], changed):
        scene.collection.objects.link(bpy.data.objects.new(camera.name, camera))
    scene.camera = bpy.data.objects["camera 0"]
    scene.frame_set(1)
    save("settings.blend")
    # What Blender reads of what it wrote: numbers have 32 bits.
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "settings.blend"))
    text = json.dumps(all_values(), indent=1, sort_keys=True)
    (FOLDER / "settings.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
