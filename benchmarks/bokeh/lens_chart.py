"""The chart of `bench --bokeh lens`: small shining balls before a lens, as numbers and a scene."""

import math
from dataclasses import dataclass

import bpy
import numpy as np

from addon.cli.render.scene_setup import use_engine
from addon.errors import InputError
from addon.lens_io.lens_shelf import LensShelf

from ..referees.osl_lens import osl_lens
from ..scenes.materials import emission

RESOLUTION = (1440, 960)
# Of a disc at infinity, px; the nearest focus over the focal length.
_LARGEST, _NEAREST_FOCUS = 20.0, 8.0
# Radius of a lamp in px, and its light: a disc of the largest size is then about white.
_LAMP, _LIGHT = 1.0, 400.0
# Side of what Cycles renders round a lamp, px.
CROP = 96
_FULL_FRAME = 36.0


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


def chart_scene(chart, depth, fields, iris, lamp=1.0, detail=4):
    """Make a scene with the lamps of a depth; the camera is at the origin and looks along y.

    `lamp`: factor of their radius; `detail`: subdivisions of their balls.
    """
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
    material = emission(bpy, "lamp", strength=_LIGHT)
    lamps = []
    for field in fields:
        (right, up, forwards), radius = chart.lamp(depth, field)
        bpy.ops.mesh.primitive_ico_sphere_add(
            subdivisions=detail, radius=lamp * radius, location=(right, forwards, up)
        )
        lamps.append(bpy.context.object)
        lamps[-1].data.materials.append(material)
    bpy.context.view_layer.update()
    return scene, lamps
