"""`aplanat bench --bokeh lens`: lamps through real lenses against Cycles tracing the same lenses.

Small shining balls stand at five depths, two before the focus, one near it and two behind it, and
at three places of the field. Aplanat draws them with the lens as the camera's real lens. Cycles
sees them through an OSL camera (`osl_lens`) that traces the lens' surfaces from the sensor, with
the same sensor, focus and f-number, at the wavelength of the d line.

Aplanat's picture keeps the camera's field of view and blur and takes the lens' patterns. So the
camera's focal length is the one whose opening is that of the lens at this f-number, the traced
lens' sensor has the size that gives the same field of view, and it is moved aside for each lamp by
what the lens distorts: the ray through the middle of the stop of a point in focus, in the lamp's
direction, then lands where a pinhole camera has it.

Of each lamp a square is compared as `benchmarks.bokeh.lamp_pictures` does. Aplanat does not take
from a disc the light that vignetting takes, so the comparison is that of the same light.
"""

import math
import tempfile
from hashlib import md5
from pathlib import Path

import bpy
import numpy as np

from addon.device.context import ensure_context
from addon.errors import InputError

from ..referees.osl_guide import boxes
from ..referees.osl_lens import osl_lens, pinhole_offset, shader_source
from ..referees.picture_metrics import read_picture
from ..scenes.pictures import use_cycles, write_floats
from .frames import BokehScene
from .lamp_pictures import compare_lamp, save_sheets
from .lens_chart import CROP, RESOLUTION, chart_scene, lens_chart

# Over the focus distance; circles of confusion are -1, -0.6, 0.2, 0.6 and 0.9 of that of infinity.
# Nearer to the focus nothing is drawn as a disc.
DEPTHS = (0.5, 0.625, 1.25, 2.5, 10.0)
# Shares of half the picture's diagonal, and in which direction, degrees.
FIELDS = ((0.0, 0.0), (0.5, 160.0), (0.9, math.degrees(math.atan2(2.0, 3.0))))
LENSES = (
    "double-gauss-50mm-f2", "petzval-100mm-f2.2", "petzval-51mm-f1.4", "retrofocus-35mm-f1.4",
    "telephoto-180mm-f2.8",
)  # fmt: skip
# Of Cycles, twice with different seeds.
SAMPLES = 2048


def has_osl():
    """Whether this Blender's Cycles can trace an OSL camera.

    Returns
    -------
    bool
    """
    try:
        import _cycles
    except ImportError:
        return False
    return bool(getattr(_cycles, "with_osl", False)) and hasattr(_cycles, "osl_compile")


def lenses(study):
    """Carry out the measure.

    Parameters
    ----------
    study : object
        With ``arguments``, ``console`` and ``save`` as that of `bench_bokeh`.

    Returns
    -------
    dict
    """
    if not has_osl():
        return {"measure": "lens", "missing": "this Blender's Cycles comes without OSL"}
    found = []
    for name in LENSES:
        chart = lens_chart(name)
        samples = study.arguments.samples or SAMPLES
        lamps, pictures = compare_lens(chart, samples=samples, progress=study.console.progress)
        save_sheets(study, f"lens_{name}", pictures, ("ours", "cycles"))
        found.append(
            {
                "lens": name,
                "f_number": chart.f_number,
                "focal_length_mm": chart.focal_length,
                "sensor_width_mm": chart.sensor_width,
                "focus_m": chart.focus,
                "samples": 2 * samples,
                "least_psnr_db": min(lamp["psnr_db"] for lamp in lamps),
                "least_noise_db": min(lamp["noise_db"] for lamp in lamps),
                "lamps": lamps,
            }
        )
    return {"measure": "lens", "lamps": len(DEPTHS) * len(FIELDS), "lenses": found}


def compare_lens(chart, depths=DEPTHS, fields=FIELDS, samples=SAMPLES, iris=None, progress=None):
    """Draw and compare the lamps of a chart.

    Parameters
    ----------
    chart : LensChart
    depths : sequence of float
    fields : sequence of tuple of 2 float
    samples : int
        Of Cycles, for each of two renders.
    iris : BladedIris or None
        Straight blades of the camera; None: round.
    progress : callable, optional
        Called with what is being drawn.

    Returns
    -------
    found : list of dict
        One a lamp.
    pictures : list of tuple of 2 ndarray
        Ours and that of Cycles, (CROP, CROP), top row first.

    Raises
    ------
    InputError
        If Cycles comes without OSL.
    """
    if not has_osl():
        raise InputError("this Blender's Cycles comes without OSL, which the traced lens needs")
    ensure_context()
    progress = progress or (lambda what: None)
    lens = osl_lens(chart.prescription, None, chart.focus, chart.f_number, iris)
    found, pictures = [], []
    for depth in depths:
        progress(f"{chart.name}: depth {depth:.3g} of the focus")
        scene, lamps = chart_scene(chart, depth, fields, iris)
        drawn = _drawn(scene)
        for field, lamp in zip(fields, lamps, strict=True):
            x, y = chart.corner(field)
            ours = drawn[y : y + CROP, x : x + CROP][::-1]
            for other in lamps:
                other.hide_render = other is not lamp
            traced = _traced(scene, chart, lens, depth, field, samples)
            likeness, pair = compare_lamp(ours, traced)
            found.append({"depth": depth, "field": field[0], **likeness})
            pictures.append(pair)
    return found, pictures


def _drawn(scene):
    """Return Aplanat's picture, one channel, bottom row first."""
    bench = BokehScene(scene)
    try:
        # All depths then have the same tables of the lens.
        snapshot = bench.splatted(4, 0, overscan=0.0)
        bench.make_levels(snapshot)
        return bench.draw_passes(snapshot).picture[::-1, :, 1]
    finally:
        bench.close()


def _traced(scene, chart, lens, depth, field, samples):
    """Return two pictures of Cycles of a lamp, one channel, top row first."""
    import _cycles

    place, radius = chart.lamp(depth, field)
    x, y = chart.corner(field)
    sides = [np.arange(CROP + 1) + first for first in (x, y)]
    # Distortion is that of points in focus, in the same direction.
    in_focus = np.asarray(place) * (chart.focus / place[2])
    offset = pinhole_offset(lens, in_focus, chart.focal_length)
    step = chart.sensor_width / RESOLUTION[0]
    film = [
        (side - 0.5 * count) * step + shift
        for side, count, shift in zip(sides, RESOLUTION, offset, strict=True)
    ]
    table = boxes(lens, place, radius, film, chart.focal_length)
    region = (x / RESOLUTION[0], (x + CROP) / RESOLUTION[0],
              y / RESOLUTION[1], (y + CROP) / RESOLUTION[1])  # fmt: skip
    data, render = scene.camera.data, scene.render
    use_cycles(scene, samples)
    render.use_border = render.use_crop_to_border = True
    # Between the pixels' edges, so that rounding does not matter.
    share = 0.5 / np.array(RESOLUTION)
    render.border_min_x, render.border_max_x = region[0] + share[0], region[1] + share[0]
    render.border_min_y, render.border_max_y = region[2] + share[1], region[3] + share[1]
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        _save_table(folder / "boxes.exr", table)
        source = shader_source(
            lens, chart.sensor_size, chart.focal_length, offset,
            (folder / "boxes.exr").as_posix(), region,
        )  # fmt: skip
        (folder / "lens.osl").write_text(source)
        compiled = folder / "lens.oso"
        if not _cycles.osl_compile(str(folder / "lens.osl"), str(compiled)):
            raise InputError(f"the OSL camera of lens '{chart.name}' does not compile")
        data.type, data.custom_bytecode = "CUSTOM", compiled.read_text()
        data.custom_bytecode_hash = md5(source.encode(), usedforsecurity=False).hexdigest()
        pictures = []
        for seed in (0, 1):
            scene.cycles.seed = seed
            pictures.append(_render(scene, folder / f"{seed}.exr"))
        data.type = "PERSP"
    render.use_border = False
    return pictures


def _render(scene, path):
    write_floats(scene.render, path)
    bpy.ops.render.render(write_still=True)
    return read_picture(path)[..., 1]


def _save_table(path, table):
    """Write boxes as a picture; for Cycles the last row is at the bottom."""
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGBA": np.ascontiguousarray(table[::-1])}) as file:
        file.write(str(path))
