"""`aplanat bench --bokeh lens`: lamps through real lenses against Cycles tracing the same lenses.

Small shining balls stand at five depths, two before the focus, one near it and two behind it, and
at three places of the field. Aplanat draws them with the lens as the camera's real lens. Cycles
sees them through an OSL camera (`osl_lens`) that traces the lens' surfaces from the sensor, with
the same sensor, focus and f-number, at the wavelength of the d line.

Aplanat's picture keeps the camera's field of view and blur and takes the lens' patterns. So the
camera's focal length is the one whose opening is that of the lens at this f-number, the traced
lens' sensor has the size that gives the same field of view, and it is moved aside for each lamp by
what the lens distorts: the ray through the middle of the stop then lands where a pinhole camera
has the lamp.

Of each lamp a square is compared, just large enough for all that is brighter than a hundredth of
the reference's maximum in either picture, and two pixels more on each side. The peak of the PSNR is
the reference's maximum. Aplanat does not take from a disc the light that vignetting takes, so both
squares are brought to the same light first; ``psnr_raw_db`` leaves that out, and ``energy`` tells
Aplanat's light over that of the traced lens.
"""

import math
import tempfile
from dataclasses import dataclass
from hashlib import md5
from pathlib import Path

import bpy
import numpy as np

from addon.cli.render.scene_setup import use_engine
from addon.device.context import ensure_context
from addon.errors import InputError
from addon.lens_io.lens_shelf import LensShelf

from ..referees.osl_guide import boxes
from ..referees.osl_lens import osl_lens, pinhole_offset, shader_source
from ..referees.picture_metrics import read_picture
from .frames import BokehScene

# Over the focus distance; circles of confusion are -1, -0.6, 0.2, 0.6 and 0.9 of that of infinity.
# Nearer to the focus nothing is drawn as a disc.
DEPTHS = (0.5, 0.625, 1.25, 2.5, 10.0)
# Shares of half the picture's diagonal, and in which direction, degrees.
FIELDS = ((0.0, 0.0), (0.5, 160.0), (0.9, math.degrees(math.atan2(2.0, 3.0))))
LENSES = (
    "double-gauss-50mm-f2", "petzval-100mm-f2.2", "petzval-51mm-f1.4", "retrofocus-35mm-f1.4",
    "telephoto-180mm-f2.8",
)  # fmt: skip
RESOLUTION = (1440, 960)
# Of a disc at infinity, px; the nearest focus over the focal length.
_LARGEST, _NEAREST_FOCUS = 20.0, 8.0
# Radius of a lamp in px, and its light: a disc of the largest size is then about white.
_LAMP, _LIGHT = 1.0, 400.0
# Side of what Cycles renders round a lamp, px, and its samples, twice with different seeds.
CROP, SAMPLES = 96, 2048
_FULL_FRAME = 36.0
_LEAST, _BORDER = 0.01, 2


@dataclass(frozen=True)
class LensChart:
    """What is set up for a lens.

    Parameters
    ----------
    name : str
        In the library.
    prescription : Prescription
    f_number : float
    focal_length, sensor_width : float
        Of the camera, mm.
    focus : float
        m.
    """

    name: str
    prescription: object
    f_number: float
    focal_length: float
    sensor_width: float
    focus: float

    @property
    def sensor_size(self):
        """Width and height, mm."""
        return self.sensor_width, self.sensor_width * RESOLUTION[1] / RESOLUTION[0]

    @property
    def pixel(self):
        """Tangent of the field angle for a pixel in the middle."""
        return self.sensor_width / RESOLUTION[0] / self.focal_length

    def lamp(self, depth, field):
        """Return the middle of a lamp (right, up, forwards) and its radius, m."""
        share, direction = field
        tangent = share * math.hypot(*self.sensor_size) / 2.0 / self.focal_length
        distance = depth * self.focus
        angle = math.radians(direction)
        place = np.array([tangent * math.cos(angle), tangent * math.sin(angle), 1.0]) * distance
        return place, _LAMP * self.pixel * distance

    def corner(self, field):
        """Return the left and lower pixel of the square round a lamp."""
        place, _ = self.lamp(1.0, field)
        middle = place[:2] / place[2] / self.pixel + np.array(RESOLUTION) / 2.0
        return np.floor(middle).astype(int) - CROP // 2


def lens_chart(name, f_number=None):
    """Choose camera and focus for a lens of the library.

    Parameters
    ----------
    name : str
    f_number : float or None
        None: wide open.

    Returns
    -------
    LensChart
    """
    found = LensShelf([]).find(name)
    if found is None or found.lens is None:
        raise InputError(f"lens '{name}' is not in the library; `aplanat lens list` has them all")
    prescription = found.lens.prescription
    configuration = prescription.configuration(None)
    wide = osl_lens(prescription, None, 100.0 * configuration.focal_length / 1000.0, 0.1)
    focal_length = 2.0 * configuration.f_number * wide.pupil_radius
    f_number = max(f_number or 0.0, configuration.f_number)
    # What the lens is made for, up to full frame.
    diagonal = 2.0 * focal_length * math.tan(math.radians(configuration.half_field_deg))
    sensor = min(diagonal * 3.0 / math.sqrt(13.0), _FULL_FRAME)
    radius = focal_length / (2.0 * f_number)
    focus = radius * focal_length * RESOLUTION[0] / sensor / _LARGEST
    focus = max(focus, _NEAREST_FOCUS * focal_length)
    return LensChart(name, prescription, f_number, focal_length, sensor, focus / 1000.0)


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
        for which, number in (("ours", 0), ("cycles", 1)):
            study.save(f"lens_{name}_{which}", sheet(pictures, number))
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


def sheet(pictures, number, columns=3):
    """Lay out the pictures of `compare_lens`, each with the light of the traced one.

    Parameters
    ----------
    pictures : list of tuple of 2 ndarray
    number : int
        0: ours, 1: those of Cycles.
    columns : int

    Returns
    -------
    ndarray of float32, shape (rows * CROP, columns * CROP, 3)
        The brightest pixel of each traced picture is 1; top row first.
    """
    shown = [
        pair[number] * (pair[1].sum() / pair[number].sum() / pair[1].max()) for pair in pictures
    ]
    rows = [np.hstack(shown[i : i + columns]) for i in range(0, len(shown), columns)]
    return np.repeat(np.vstack(rows)[..., None], 3, axis=-1).astype(np.float32)


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
        scene, lamps = _scene(chart, depth, fields, iris)
        drawn = _drawn(scene)
        for field, lamp in zip(fields, lamps, strict=True):
            x, y = chart.corner(field)
            ours = drawn[y : y + CROP, x : x + CROP][::-1]
            for other in lamps:
                other.hide_render = other is not lamp
            traced = _traced(scene, chart, lens, depth, field, samples)
            theirs = sum(traced) / len(traced)
            found.append(
                {
                    "depth": depth,
                    "field": field[0],
                    **compare_discs(ours, theirs),
                    # Of the mean of the two; their difference has twice its noise.
                    "noise_db": compare_discs(*traced)["psnr_raw_db"] + 20.0 * math.log10(2.0),
                }
            )
            pictures.append((ours, theirs))
    return found, pictures


def compare_discs(ours, theirs):
    """Compare two pictures of a disc; see the module.

    Parameters
    ----------
    ours, theirs : ndarray of shape (n, n)

    Returns
    -------
    dict of str to float
    """
    peak = theirs.max()
    seen = np.maximum(ours, theirs) > _LEAST * peak
    rows, columns = (np.flatnonzero(seen.any(axis=axis)) for axis in (1, 0))
    window = tuple(
        slice(max(part[0] - _BORDER, 0), part[-1] + _BORDER + 1) for part in (rows, columns)
    )
    ours, theirs = ours[window].astype(float), theirs[window].astype(float)
    energy = ours.sum() / theirs.sum()

    def psnr(test):
        return float(-10.0 * np.log10(np.mean(((test - theirs) / peak) ** 2) + 1e-30))

    return {
        "psnr_db": psnr(ours / energy),
        "psnr_raw_db": psnr(ours),
        "energy": float(energy),
        "window": [theirs.shape[1], theirs.shape[0]],
    }


def _scene(chart, depth, fields, iris):
    """Make a scene with the lamps of a depth; the camera is at the origin and looks along y."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    use_engine(scene)
    data = bpy.data.cameras.new("camera")
    data.lens, data.sensor_width, data.sensor_fit = (
        chart.focal_length, chart.sensor_width, "HORIZONTAL",
    )  # fmt: skip
    data.clip_start, data.clip_end = 0.01 * chart.focus, 100.0 * chart.focus
    data.dof.use_dof, data.dof.focus_distance = True, chart.focus
    data.dof.aperture_fstop = chart.f_number
    if iris is not None:
        data.dof.aperture_blades, data.dof.aperture_rotation = iris.blades, iris.rotation
        data.aplanat.bokeh.blade_curvature = iris.curvature
    data.aplanat.lens = chart.name
    camera = bpy.data.objects.new("camera", data)
    camera.rotation_euler = (math.pi / 2.0, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render = scene.render
    render.resolution_x, render.resolution_y = RESOLUTION
    render.resolution_percentage = 100
    scene.aplanat.pixel_filter, render.filter_size = "BOX", 1.0
    material = bpy.data.materials.new("lamp")
    tree = material.node_tree
    tree.nodes.clear()
    glow = tree.nodes.new("ShaderNodeEmission")
    glow.inputs["Strength"].default_value = _LIGHT
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(glow.outputs["Emission"], output.inputs["Surface"])
    lamps = []
    for field in fields:
        (right, up, forwards), radius = chart.lamp(depth, field)
        bpy.ops.mesh.primitive_ico_sphere_add(
            subdivisions=4, radius=radius, location=(right, forwards, up)
        )
        lamps.append(bpy.context.object)
        lamps[-1].data.materials.append(material)
    bpy.context.view_layer.update()
    return scene, lamps


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
    offset = pinhole_offset(lens, place, chart.focal_length)
    step = chart.sensor_width / RESOLUTION[0]
    film = [
        (side - 0.5 * count) * step + shift
        for side, count, shift in zip(sides, RESOLUTION, offset, strict=True)
    ]
    table = boxes(lens, place, radius, film, chart.focal_length)
    region = (x / RESOLUTION[0], (x + CROP) / RESOLUTION[0],
              y / RESOLUTION[1], (y + CROP) / RESOLUTION[1])  # fmt: skip
    data, render = scene.camera.data, scene.render
    _use_cycles(scene, samples)
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


def _use_cycles(scene, samples):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = 0


def _render(scene, path):
    settings = scene.render.image_settings
    settings.media_type, settings.file_format = "IMAGE", "OPEN_EXR"
    settings.color_mode, settings.color_depth = "RGBA", "32"
    scene.render.filepath, scene.render.use_file_extension = str(path), False
    bpy.ops.render.render(write_still=True)
    return read_picture(path)[..., 1]


def _save_table(path, table):
    """Write boxes as a picture; for Cycles the last row is at the bottom."""
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGBA": np.ascontiguousarray(table[::-1])}) as file:
        file.write(str(path))
