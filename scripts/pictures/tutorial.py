"""Draws docs/images/tutorial/*.jpg: a figurine at night, from a sharp picture to a whole lens.

.venv/bin/python scripts/pictures/tutorial.py [STEP ...]

The scene is that of scripts/demo. Each step is a chapter of docs/guide/tutorial.md and changes
what the chapter says, by the same settings.
"""

import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPO), str(REPO / "scripts")]

import bpy  # noqa: E402  (after the path is set)
import demo_scene  # noqa: E402

FOLDER = REPO / "docs" / "images" / "tutorial"
WIDTH, SAMPLES, QUALITY = 480, 64, 88


def sharp(camera):
    """A camera as it comes: everything is sharp."""
    camera.dof.use_dof = False
    own = camera.aplanat
    own.lens, own.bokeh.use, own.chromatic.use = "", False, False


def blurred(camera):
    """Depth of field; lamps are sampled like all other light."""
    sharp(camera)
    camera.dof.use_dof, camera.dof.aperture_fstop = True, 1.4


def discs(camera):
    """Lamps become discs."""
    blurred(camera)
    camera.aplanat.bokeh.use = True


def lens(camera):
    """A real lens: its discs have bright rims, and become cat's eyes towards the corners."""
    discs(camera)
    camera.aplanat.lens = "planar-50mm-f1.4"


def fringes(camera):
    """Colours part at edges and in discs."""
    lens(camera)
    camera.aplanat.chromatic.use = True


def seven_blades(camera):
    """Stopped down: the blades of the iris show."""
    lens(camera)
    camera.dof.aperture_fstop = 2.8
    camera.dof.aperture_blades = 7


STEPS = {
    "1-sharp": sharp,
    "2-blurred": blurred,
    "3-discs": discs,
    "4-lens": lens,
    "5-fringes": fringes,
    "6-blades": seven_blades,
}


def main():
    """Draw the pictures."""
    demo_scene.build(WIDTH)
    scene = bpy.context.scene
    settings = scene.render.image_settings
    settings.file_format, settings.quality = "JPEG", QUALITY
    scene.aplanat.use_target_error, scene.aplanat.render_samples = False, SAMPLES
    scene.render.use_file_extension = False
    for name in sys.argv[1:] or STEPS:
        STEPS[name](scene.camera.data)
        scene.render.filepath = str(FOLDER / f"{name}.jpg")
        bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()
