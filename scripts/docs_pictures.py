"""Takes the pictures of README's first steps in a real Blender window, of the demo scene.

Usage: scripts/docs_pictures.py [-o FOLDER] [STEP ...]

Run it with the checkout's Python (.venv/bin/python) after scripts/demo. It installs the extension
into a user folder of its own, opens Blender on a virtual screen, carries out each step as a
newcomer would, and writes docs/images/step-*.jpg and lens-panel.jpg.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import imageio.v3 as iio

REPO = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPO))

from benchmarks.tools.real_blender import Blender, stop  # noqa: E402

SCREEN = (1280, 800)
QUALITY = 88

# Runs in Blender: areas by their type, and the right side of the default screen.
STAGE = """
def window():
    return bpy.context.window_manager.windows[0]

def area(kind):
    return next(a for a in window().screen.areas if a.type == kind)

def over(kind, space_kind=None):
    a = area(kind)
    region = [r for r in a.regions if r.type == "WINDOW"][-1]
    return bpy.context.temp_override(window=window(), area=a, region=region)

def box(kind):
    a = widest(kind)
    return [a.x, window().height - a.y - a.height, a.width, a.height]

def widest(kind):
    return max((a for a in window().screen.areas if a.type == kind), key=lambda a: a.width)

def split():
    a = area("VIEW_3D")
    with bpy.context.temp_override(window=window(), area=a, region=a.regions[-1]):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.6)
    right = max((b for b in window().screen.areas if b.type == "VIEW_3D"), key=lambda b: b.x)
    right.type = "PROPERTIES"

def join():
    a = widest("PROPERTIES")
    with bpy.context.temp_override(window=window(), area=a, region=a.regions[-1]):
        bpy.ops.screen.area_close()

def show(context):
    widest("PROPERTIES").spaces.active.context = context
    widest("PROPERTIES").tag_redraw()

def rendered():
    space = area("VIEW_3D").spaces.active
    space.shading.type = "RENDERED"
    space.region_3d.view_perspective = "CAMERA"
    space.overlay.show_overlays = False
    space.show_gizmo = False
    with over("VIEW_3D"):
        bpy.ops.view3d.view_center_camera()

def busy():
    import importlib
    background = importlib.import_module("bl_ext.user_default.aplanat.addon.ui.jobs.background")
    return background.progress() is not None

def converged():
    import gc, importlib
    kind = importlib.import_module("bl_ext.user_default.aplanat.addon.engine.viewport").Viewport
    found = [v for v in gc.get_objects() if isinstance(v, kind) and v._renderer is not None]
    return bool(found) and all(v._renderer.finished() for v in found)
"""


class Steps:
    """Carries out the steps in one Blender window."""

    def __init__(self, window, out, demo):
        self.window = window
        self.out = out
        self.demo = demo
        window.run(STAGE)

    def picture(self, name, kind=None, more=(0, 0)):
        """Save a screenshot of the window, or of one of its areas and some pixels beyond it."""
        shot = self.window.screenshot(self.out / f"{name}.png")
        pixels = iio.imread(shot)[..., :3]
        shot.unlink()
        if kind is not None:
            x, y, width, height = self.window.run(f"result = box({kind!r})")
            pixels = pixels[y : y + height + more[1], x : x + width + more[0]]
        path = self.out / f"{name}.jpg"
        iio.imwrite(path, pixels, quality=QUALITY)
        print(path)

    def pause(self, seconds):
        """Let Blender draw."""
        time.sleep(seconds)
        self.window.run("for a in window().screen.areas: a.tag_redraw()")
        time.sleep(seconds)

    def install(self):
        """Show where an extension is installed from disk."""
        self.window.run(
            """
            area("VIEW_3D").type = "PREFERENCES"
            bpy.context.preferences.active_section = "EXTENSIONS"
            bpy.context.window_manager.extension_search = "Aplanat"
            """
        )
        self.pause(0.5)
        # The menu at the top right.
        x, y, width, _ = self.window.run("result = box('PREFERENCES')")
        self.window.xdotool("mousemove", x + width - 19, y + 46, "click", 1)
        self.pause(1.0)
        _, _, _, height = self.window.run("result = box('PREFERENCES')")
        self.picture("step-install", "PREFERENCES", (180, 340 - height))
        self.window.xdotool("key", "Escape")
        self.window.run('area("PREFERENCES").type = "VIEW_3D"')

    def engine(self):
        """Show the choice of the engine and the Sampling panel."""
        self.window.run(f"bpy.ops.wm.open_mainfile(filepath={str(self.demo)!r}, load_ui=False)")
        self.window.run(STAGE)
        self.window.run("split()")
        self.window.run('show("RENDER")')
        self.pause(0.5)
        self.picture("step-engine", "PROPERTIES")
        self.window.run("join()")

    def camera(self):
        """Show the camera's panels: depth of field and the real lens."""
        self.window.run(
            """
            camera = bpy.context.scene.camera
            bpy.context.view_layer.objects.active = camera
            camera.select_set(True)
            """
        )
        self.pause(0.5)
        self.window.run("split()")
        self.window.run('show("DATA")')
        # The lens' pictures are made in the background.
        self.pause(1.0)
        self.window.wait_for("not busy()", timeout=600)
        self.pause(1.0)
        self.picture("step-camera", "PROPERTIES")
        self.window.run("join()")

    def lenses(self):
        """Show the popup with all lenses, over the panel that it belongs to."""
        self.window.run(f"bpy.ops.wm.open_mainfile(filepath={str(self.demo)!r}, load_ui=False)")
        self.window.run(STAGE)
        self.window.run(
            """
            camera = bpy.context.scene.camera
            bpy.context.view_layer.objects.active = camera
            camera.select_set(True)

            def browse():
                with over("PROPERTIES"):
                    bpy.ops.camera.aplanat_browse_lenses("INVOKE_DEFAULT")
            """
        )
        self.pause(0.5)
        self.window.run("split()")
        self.window.run('show("DATA")')
        self.pause(1.0)
        x, y, width, _ = self.window.run("result = box('PROPERTIES')")
        # Where no tooltip comes: over the 3D view.
        self.window.xdotool("mousemove", x + width + 100, y + 400)
        self.window.run("bpy.app.timers.register(browse, first_interval=0.1)")
        self.pause(1.0)
        self.window.wait_for("not busy()", timeout=600)
        # The popup shows what has come when the mouse moves over it.
        for step in (300, 400, 100):
            self.window.xdotool("mousemove", SCREEN[0] - step, SCREEN[1] - 80)
            time.sleep(0.5)
        self.picture("lens-panel")
        self.window.xdotool("key", "Escape")
        self.window.run("join()")

    def viewport(self):
        """Show the Rendered viewport through the camera."""
        self.window.run("rendered()")
        self.window.wait_for(
            "converged()",
            timeout=900,
        )
        self.picture("step-viewport")


def main():
    """Take the pictures."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-o", "--folder", type=Path, default=REPO / "docs/images")
    parser.add_argument("--demo", type=Path, default=REPO / "build/demo/demo.blend")
    parser.add_argument(
        "steps", nargs="*", default=["install", "engine", "camera", "lenses", "viewport"]
    )
    options = parser.parse_args()
    if not options.demo.is_file():
        parser.error(f"{options.demo} is not there; run scripts/demo first")
    found = subprocess.run(
        ["bash", "-c", 'source "$1/scripts/environment.sh" && find_blender', "-", REPO],
        capture_output=True,
        text=True,
        check=False,
    )
    if found.returncode:
        parser.error("no real Blender 5.2; scripts/get-blender makes one")
    with tempfile.TemporaryDirectory() as folder:
        blender = Blender(found.stdout.strip(), Path(folder) / "user")
        blender.resources.mkdir()
        built = subprocess.run(
            [REPO / "scripts/build", "--current", "-o", folder],
            capture_output=True,
            text=True,
            check=True,
        )
        package = built.stdout.split()[-1]
        blender.run(
            "--command", "extension", "install-file", "-r", "user_default", "--enable", package
        )
        server = subprocess.Popen(
            blender.tool(
                *("Xvfb", "-displayfd", "1", "-screen", "0", "{}x{}x24".format(*SCREEN)),
                *("+extension", "GLX"),
            ),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        try:
            display = f":{server.stdout.readline().strip()}"
            with blender.window(display, folder=Path(folder) / "window") as window:
                steps = Steps(window, options.folder, options.demo)
                for name in options.steps:
                    getattr(steps, name)()
        finally:
            server.stdout.close()
            stop(server)


if __name__ == "__main__":
    main()
