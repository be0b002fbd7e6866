"""Runs inside Blender's window: a scene, 3D views, and looks into the engine.

The tests execute this file in Blender once, then call what it defines.
"""

import importlib
import math
import sys
import weakref

import bmesh
import bpy

ADDON = "bl_ext.user_default.aplanat"
COLORS = ((0.9, 0.1, 0.1), (0.1, 0.8, 0.1), (0.8, 0.6, 0.3), (0.2, 0.3, 0.9), (0.7, 0.2, 0.8))

events = []
viewports = weakref.WeakSet()


def module(name):
    return importlib.import_module(f"{ADDON}.addon.{name}")


def emissive(name, color):
    material = bpy.data.materials.new(name)
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (*color, 1.0)
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def build():
    """A row of things from near to far, the middle one in focus."""
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    for i, color in enumerate(COLORS):
        mesh = bpy.data.meshes.new(f"mesh{i}")
        shape = bmesh.new()
        (bmesh.ops.create_monkey if i == 2 else bmesh.ops.create_cube)(shape)
        shape.to_mesh(mesh)
        shape.free()
        mesh.materials.append(emissive(f"material{i}", color))
        thing = bpy.data.objects.new(f"thing{i}", mesh)
        thing.location = (1.2 * (i - 2), 2.0 * (i - 2), 0.0)
        thing.rotation_euler.z = 0.3 * i
        thing.scale = (0.7, 0.7, 0.7)
        scene.collection.objects.link(thing)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler.x = (0.0, -10.0, 1.5), math.radians(82)
    camera.data.lens = 40
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance, camera.data.dof.aperture_fstop = 10.0, 0.08
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "APLANAT"
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    scene.render.resolution_percentage = 100
    scene.aplanat.method = "REFERENCE"
    scene.aplanat.preview_samples = scene.aplanat.render_samples = 16
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"


def window():
    return bpy.context.window_manager.windows[0]


def area():
    return next(a for a in window().screen.areas if a.type == "VIEW_3D")


def region():
    return [r for r in area().regions if r.type == "WINDOW"][-1]


def view(perspective="CAMERA", bare=False):
    """Switch the 3D view to Rendered; `bare` leaves nothing but the picture in it."""
    space = area().spaces.active
    space.shading.type = "RENDERED"
    space.region_3d.view_perspective = perspective
    for name in ("header", "toolbar", "tool_header", "ui", "hud"):
        if hasattr(space, f"show_region_{name}"):
            setattr(space, f"show_region_{name}", not bare and name in {"header", "toolbar"})
    space.overlay.show_overlays = not bare
    space.show_gizmo = not bare
    return space


def override(**more):
    return bpy.context.temp_override(window=window(), area=area(), region=region(), **more)


def watch_viewports():
    """Remember every viewport that draws."""
    viewport_class = module("engine.viewport").Viewport
    if not hasattr(viewport_class, "unwatched_draw"):
        viewport_class.unwatched_draw = viewport_class.draw

        def draw(self, *arguments):
            viewports.add(self)
            return self.unwatched_draw(*arguments)

        viewport_class.draw = draw


def texts():
    return sorted({viewport.text for viewport in viewports})


def converged():
    """Whether every viewport that is watched shows its last sample; keeps them drawing."""
    if window().screen is not None:
        area().tag_redraw()
    done = [text.removeprefix("Sample ").split("/") for text in texts()]
    return bool(done) and all(len(pair) == 2 and pair[0] == pair[1] for pair in done)


def watch_renders():
    for name in ("render_pre", "render_complete", "render_cancel"):
        handlers = getattr(bpy.app.handlers, name)
        handlers.append(lambda *_, name=name: events.append(name))


def start_render(**options):
    events.clear()
    with bpy.context.temp_override(window=window()):
        bpy.ops.render.render("INVOKE_DEFAULT", **options)


def rss():
    """Memory of this process, in MB."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096 / 1e6


def redraw(times, move=None):
    """Draw the 3D view at once, so many times, moving the camera before each."""
    for i in range(times):
        if move is not None:
            move(i)
            bpy.context.view_layer.update()
        with override():
            bpy.ops.wm.redraw_timer(type="DRAW", iterations=1)


def enabled():
    return ADDON in bpy.context.preferences.addons and ADDON in sys.modules


watch_viewports()
watch_renders()
