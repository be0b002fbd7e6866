"""Runs inside Blender's window: a scene, 3D views, and looks into the engine.

The tests execute this file in Blender once, then call what it defines.
"""

import importlib
import math
import re
import sys
import weakref

import bmesh
import bpy
import numpy as np

ADDON = "bl_ext.user_default.aplanat"
COLORS = ((0.9, 0.1, 0.1), (0.1, 0.8, 0.1), (0.8, 0.6, 0.3), (0.2, 0.3, 0.9), (0.7, 0.2, 0.8))

events = []
stirred = {"ticks": 0, "on": False}
viewports = weakref.WeakSet()


def module(name):
    return importlib.import_module(f"{ADDON}.addon.{name}")


def shared():
    """What the sessions of this process share."""
    return module("engine.shared_resources").resources()


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
    # What no test looks at in every pixel need not be drawn in every one.
    scene.render.preview_pixel_size = "4"
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
    # Behind it stands the error that was reached, where one was asked for.
    counts = [re.sub(r" \| Error [0-9.]+ of [0-9.]+", "", text) for text in texts()]
    done = [count.removeprefix("Sample ").split("/") for count in counts]
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


def build_crowd():
    """Blurred things with levels of detail, lamps, a picture for an iris, and a dancer.

    The dancer is shown by the viewport only, and is another mesh at every tick: the viewport always
    asks for levels of detail that the final render knows nothing of.
    """
    build()
    scene = bpy.context.scene
    scene.render.preview_pixel_size = "2"
    image = bpy.data.images.new("checks", 64, 64)
    y, x = np.mgrid[0:64, 0:64]
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[..., :3] = ((x // 8 + y // 8) % 2)[..., None] * np.float32([0.9, 0.6, 0.2])
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    for i, name in ((0, "thing0"), (4, "thing4")):
        thing = bpy.data.objects[name]
        thing.modifiers.new("smooth", "SUBSURF")
        thing.modifiers["smooth"].levels = thing.modifiers["smooth"].render_levels = 5
        cast = thing.modifiers.new("cast", "CAST")
        cast.factor = 0.5 + 0.1 * i
    tree = bpy.data.materials["material4"].node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["UV"], node.inputs["Vector"])
    emission = next(n for n in tree.nodes if n.type == "EMISSION")
    tree.links.new(node.outputs["Color"], emission.inputs["Color"])
    lamp = emissive("lamp", (1.0, 0.9, 0.7))
    emission = next(n for n in lamp.node_tree.nodes if n.type == "EMISSION")
    emission.inputs["Strength"].default_value = 30.0
    for i in range(3):
        mesh = bpy.data.meshes.new("lamp")
        shape = bmesh.new()
        bmesh.ops.create_icosphere(shape, subdivisions=1, radius=0.4)
        shape.to_mesh(mesh)
        shape.free()
        mesh.materials.append(lamp)
        thing = bpy.data.objects.new(f"lamp{i}", mesh)
        thing.location = (6.0 * (i - 1), 60.0, 8.0)
        scene.collection.objects.link(thing)
    iris = bpy.data.images.new("iris", 32, 32)
    y, x = np.mgrid[0:32, 0:32] - 15.5
    pixels = np.ones((32, 32, 4), np.float32)
    pixels[..., :3] = (np.hypot(x, y) < 15.0)[..., None] * (0.5 + (np.hypot(x, y) > 9.0)[..., None])
    iris.pixels.foreach_set(pixels.ravel())
    iris.pack()
    bokeh = scene.camera.data.aplanat.bokeh
    bokeh.use, bokeh.iris_image = True, iris
    mesh = bpy.data.meshes.new("dancer")
    shape = bmesh.new()
    bmesh.ops.create_uvsphere(shape, u_segments=96, v_segments=48, radius=0.8)
    shape.to_mesh(mesh)
    shape.free()
    mesh.materials.append(bpy.data.materials["material1"])
    dancer = bpy.data.objects.new("dancer", mesh)
    dancer.location, dancer.hide_render = (-1.0, -4.0, 1.2), True
    scene.collection.objects.link(dancer)
    settings = scene.aplanat
    settings.method, settings.use_target_error = "ADAPTIVE", False
    settings.render_samples = settings.preview_samples = 12
    settings.least_triangles, settings.subsamples = 64, 2
    scene.render.preview_pixel_size = "4"
    # The window stays as it is, and the 3D view in it.
    bpy.context.preferences.view.render_display_type = "NONE"


def stir():
    """Change what the viewport shows, and nothing of what is rendered; a timer."""
    if stirred["on"]:
        stirred["ticks"] += 1
        tick = stirred["ticks"]
        space = area().spaces.active
        space.region_3d.view_camera_zoom = 10.0 + (tick % 7)
        dancer = bpy.data.objects["dancer"]
        mesh = dancer.data
        positions = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", positions)
        positions = positions.reshape(-1, 3)
        positions *= 0.8 / np.linalg.norm(positions, axis=1, keepdims=True)
        positions *= 1.0 + 0.1 * np.sin(5.0 * positions[:, 2:] + tick)
        mesh.vertices.foreach_set("co", positions.ravel())
        mesh.update()
        dancer.location.x = -1.0 + 0.1 * (tick % 5)
        area().tag_redraw()
    return 0.1


def look():
    """What is told of the shared state, and what this process takes."""
    store = shared().levels
    return {
        "megabytes": rss(),
        "handles": len(store._clients),
        "progress": store.progress,
        "busy": store.busy,
        "simplified": store.work.decimations,
        "ticks": stirred["ticks"],
        "waiting": module("engine.gpu_thread")._jobs.qsize(),
        "listeners": shared().renders.listeners,
    }


def enabled():
    return ADDON in bpy.context.preferences.addons and ADDON in sys.modules


watch_viewports()
watch_renders()
bpy.app.timers.register(stir, persistent=True)
