"""A camera shader in OSL that traces a lens: the referee of `aplanat bench --bokeh lens`.

The shader is written for one lens at one focus, opening and wavelength. A ray starts on the sensor,
goes through a place on a plane behind the last surface, is refracted by each surface from the last
to the first, and leaves for the scene; rims and the iris end it. A pixel shows

``E = (1 / norm) integral of L cos^4(a) / Z^2 dA``

over the plane, Z its distance from the sensor and a the ray's angle to the axis: a scene of one
brightness is that bright in the middle of the picture and darker where the lens vignettes.

Places are drawn from a box for each pixel that a table names (`osl_guide`), or from all of the
plane. Lengths are in mm from the vertex of surface 1, light travels towards +z as in
`optics.prescription`; the shader gives positions to Cycles in metres, z towards the scene, from the
centre of the entrance pupil.
"""

from dataclasses import dataclass

import numpy as np

from addon.lens_bokeh.openings.blades import BladedIris
from addon.optics.focus import focused
from addon.optics.glass import REFERENCE_WAVELENGTH_NM
from addon.optics.media import indices
from addon.optics.paraxial import first_order
from addon.optics.prescription import Configuration
from addon.optics.rays.trace import Rays, trace

# Rays through the plane that all light passes must reach its edge: wider than the last rim.
_WIDER = 1.15
_FIRST_GUESSES = 8
_NORM_RAYS = 512
# Tangent of the ray that tells the scale of the picture.
_PARAXIAL = 1e-4
_POWERS = 10


@dataclass(frozen=True)
class OslLens:
    """A lens in front of a sensor.

    Parameters
    ----------
    configuration : Configuration
        Focused, with the stop of the f-number.
    pupil : float
        z of the centre of the paraxial entrance pupil.
    pupil_radius : float
        Of it, wide open.
    scale : float
        Height on the sensor of a point whose distance from the axis is its depth; negative, because
        the picture is turned round.
    aim : float
        z of the plane that rays are sent through.
    aim_radius : float
        Half the side of the square of it that holds all light.
    norm : float
        Integral of cos^4 / Z^2 over what the middle of the sensor sees, without unit.
    iris : BladedIris
    """

    configuration: Configuration
    pupil: float
    pupil_radius: float
    scale: float
    aim: float
    aim_radius: float
    norm: float
    iris: BladedIris


def osl_lens(prescription, label, focus_distance, f_number, iris=None):
    """Make a lens ready.

    Parameters
    ----------
    prescription : Prescription
    label : str or None
        Of the zoom position.
    focus_distance : float
        From the centre of the entrance pupil, m.
    f_number : float
    iris : BladedIris or None
        As the camera sees it; None: round.

    Returns
    -------
    OslLens

    Raises
    ------
    PrescriptionError
        If the lens cannot be focused there.
    """
    wide = lens = prescription.configuration(label)
    for _ in range(_FIRST_GUESSES):
        distance = focus_distance * 1000.0 - first_order(lens).enp_z
        lens = focused(wide, distance, prescription.focus)
    order = first_order(lens)
    closed = lens.stopped_down(f_number)
    aim = lens.vertices[-1]
    aim_radius = _WIDER * lens.surfaces[-1].semi_diameter
    ray = Rays(np.array([[0.0, 0.0, order.enp_z]]), _unit([[0.0, _PARAXIAL, 1.0]]))
    landing = trace(lens, ray, REFERENCE_WAVELENGTH_NM).at_plane(lens.sensor)[0, 1]
    iris = iris or BladedIris()
    place = _cells(aim_radius, _NORM_RAYS)
    sensor = np.zeros((len(place), 2))
    rays = rays_from_sensor(sensor, place, lens.sensor, aim)
    found = trace(closed, rays, REFERENCE_WAVELENGTH_NM, backwards=True, record=True)
    stop = found.hits[len(lens.surfaces) - lens.stop, :, :2]
    radius = closed.surfaces[lens.stop - 1].semi_diameter
    open_ = found.passed & (iris.clearance(stop / radius) >= 0.0)
    share = (2.0 * aim_radius / _NORM_RAYS / (lens.sensor - aim)) ** 2
    norm = (rays.directions[:, 2] ** 4)[open_].sum() * share
    return OslLens(
        closed, order.enp_z, 0.5 * order.enp_diameter, -landing / _PARAXIAL, aim, aim_radius,
        float(norm), iris,
    )  # fmt: skip


def rays_from_sensor(sensor, place, sensor_z, aim_z):
    """Rays from places on the sensor through places on a plane in front of it.

    Parameters
    ----------
    sensor, place : ndarray of shape (N, 2)
        mm.
    sensor_z, aim_z : float

    Returns
    -------
    Rays
    """
    start = np.concatenate([sensor, np.full((len(sensor), 1), sensor_z)], axis=1)
    goal = np.concatenate([place, np.full((len(place), 1), aim_z)], axis=1)
    return Rays(start, _unit(goal - start))


def pinhole_offset(lens, point, focal_length):
    """Tell where the ray through the middle of the stop lands beside a pinhole's picture.

    Parameters
    ----------
    lens : OslLens
    point : sequence of 3 float
        In the camera's frame: right, up, towards the scene, m.
    focal_length : float
        Of the camera, mm.

    Returns
    -------
    ndarray of shape (2,)
        To be added to a place in the camera's picture, mm of its sensor, so that the point's
        chief ray lands where a pinhole in the entrance pupil has it.
    """
    x, y, depth = np.asarray(point, float) * 1000.0
    origin = np.array([x, y, lens.pupil - depth])
    # Newton's method over slopes: which ray crosses the axis in the stop?
    slopes = -np.array([x, y]) / depth
    last = lens.configuration.stop
    for _ in range(20):
        step = 1e-5
        tried = np.array([slopes, slopes + (step, 0.0), slopes + (0.0, step)])
        rays = Rays(np.tile(origin, (3, 1)), _unit(np.c_[tried, np.ones(3)]))
        found = trace(lens.configuration, rays, REFERENCE_WAVELENGTH_NM, clip=False, last=last)
        at = found.points[:, :2]
        slopes = slopes - np.linalg.solve((at[1:] - at[0]).T / step, at[0])
    rays = Rays(origin[None], _unit([[*slopes, 1.0]]))
    found = trace(lens.configuration, rays, REFERENCE_WAVELENGTH_NM, clip=False)
    landing = found.at_plane(lens.configuration.sensor)[0]
    return landing * (focal_length / lens.scale) - np.array([x, y]) / depth * focal_length


def shader_source(
    lens,
    sensor_size,
    focal_length,
    offset=(0.0, 0.0),
    table=None,
    region=None,
    wavelength_nm=REFERENCE_WAVELENGTH_NM,
):
    """Write the shader.

    Parameters
    ----------
    lens : OslLens
    sensor_size : tuple of 2 float
        What the whole picture takes of the camera's sensor, mm.
    focal_length : float
        Of the camera: a point as far from the axis as from the camera lies that far from the
        picture's middle, mm.
    offset : sequence of 2 float
        Added to the place in the picture, mm; see `pinhole_offset`.
    table : str or None
        Picture file of boxes for each place, RGBA: x0, x1, y0, y1 on the aim plane over
        `aim_radius`; None: rays go through all of it.
    region : tuple of 4 float
        x0, x1, y0, y1: what the table covers of the picture, 0 to 1.
    wavelength_nm : float
        Of the light; the lens is focused at the reference wavelength.

    Returns
    -------
    str
        In Open Shading Language.
    """
    configuration = lens.configuration
    surfaces = configuration.surfaces[::-1]
    media = indices(configuration, wavelength_nm)[::-1]
    powers = np.zeros((len(surfaces), _POWERS))
    for row, surface in zip(powers, surfaces, strict=True):
        for order, coefficient in surface.asphere:
            row[order // 2 - 1] += coefficient
    general = [
        int(s.conic != 0.0 or bool(s.asphere) or s.curved_along is not None) for s in surfaces
    ]
    box = "color box = color(-1.0, 1.0, -1.0); float top = 1.0;"
    if table is not None:
        x0, x1, y0, y1 = region
        box = _LOOK_UP % {
            "table": table, "x0": x0, "y0": y0, "over_x": 1.0 / (x1 - x0), "over_y": 1.0 / (y1 - y0)
        }  # fmt: skip
    iris = lens.iris
    return _SHADER % {
        "count": len(surfaces),
        "media": len(surfaces) + 1,
        "powers_count": powers.size,
        "orders": _POWERS,
        "curvature": _list(s.curvature for s in surfaces),
        "vertex": _list(configuration.vertices[::-1]),
        "rim": _list(s.semi_diameter for s in surfaces),
        "conic": _list(s.conic for s in surfaces),
        "bends_x": _list(float(s.curved_along != "y") for s in surfaces),
        "bends_y": _list(float(s.curved_along != "x") for s in surfaces),
        "general": ", ".join(map(str, general)),
        "powers": _list(powers.ravel()),
        "index": _list(media),
        "stop": len(surfaces) - configuration.stop,
        "sensor": configuration.sensor,
        "aim": lens.aim,
        "aim_radius": lens.aim_radius,
        "pupil": lens.pupil,
        "weight": (lens.aim_radius / (configuration.sensor - lens.aim)) ** 2 / lens.norm,
        "scale": lens.scale / focal_length,
        "width": sensor_size[0],
        "height": sensor_size[1],
        "offset_x": offset[0],
        "offset_y": offset[1],
        "box": box,
        "blades": 0 if iris.is_round else iris.blades,
        "blade_radius": iris.blade_radius,
        "blade_curvature": iris.curvature,
        "rotation": iris.rotation,
    }


def _list(values):
    return ", ".join(f"{float(value):.9g}" for value in values)


def _unit(vectors):
    vectors = np.asarray(vectors, float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _cells(radius, count):
    """Centres of count x count cells of a square, shape (count^2, 2)."""
    axis = ((np.arange(count) + 0.5) / count * 2.0 - 1.0) * radius
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


_LOOK_UP = """float top = 0.0;
  color box = texture("%(table)s", (raster[0] - %(x0).9g) * %(over_x).9g,
                      (raster[1] - %(y0).9g) * %(over_y).9g, 0.0, 0.0, 0.0, 0.0,
                      "interp", "closest", "wrap", "clamp", "alpha", top);"""

_SHADER = """
/* Signed clearance of curved blades over a round stop of unit radius. */
float iris_clearance(float x, float y)
{
  int blades = %(blades)d;
  float radius = sqrt(x * x + y * y);
  float stop = 1.0 - radius;
  if (blades == 0) {
    return stop;
  }
  radius /= %(blade_radius).9g;
  float k = %(blade_curvature).9g;
  float part = M_PI / blades;
  float angle = mod(atan2(y, x) - %(rotation).9g + part, 2.0 * part) - part;
  float q = radius * cos(angle) - cos(part);
  float t = radius * sin(angle);
  float w = sqrt(1.0 - k * k * sin(part) * sin(part));
  float upper = k * (sin(part) * sin(part) - q * q - t * t) - 2.0 * q * w;
  return min(stop, %(blade_radius).9g * upper / (1.0 + hypot(k * q + w, k * t)));
}

shader traced_lens(output point position = point(0.0),
                   output vector direction = vector(0.0, 0.0, 1.0),
                   output color throughput = color(0.0),
                   output vector dPdx = vector(0.0),
                   output vector dPdy = vector(0.0),
                   output vector dDdx = vector(0.0),
                   output vector dDdy = vector(0.0))
{
  float curvature[%(count)d] = {%(curvature)s};
  float vertex[%(count)d] = {%(vertex)s};
  float rim[%(count)d] = {%(rim)s};
  float conic[%(count)d] = {%(conic)s};
  float bends_x[%(count)d] = {%(bends_x)s};
  float bends_y[%(count)d] = {%(bends_y)s};
  int general[%(count)d] = {%(general)s};
  float powers[%(powers_count)d] = {%(powers)s};
  float index[%(media)d] = {%(index)s};

  point raster = camera_shader_raster_position();
  vector chance = camera_shader_random_sample();
  %(box)s
  float across = box[1] - box[0];
  float along = top - box[2];
  float film_x = (raster[0] - 0.5) * %(width).9g + %(offset_x).9g;
  float film_y = (raster[1] - 0.5) * %(height).9g + %(offset_y).9g;
  point p = point(film_x * %(scale).9g, film_y * %(scale).9g, %(sensor).9g);
  point goal = point((box[0] + across * chance[0]) * %(aim_radius).9g,
                     (box[2] + along * chance[1]) * %(aim_radius).9g,
                     %(aim).9g);
  vector d = normalize(goal - p);
  float cosine = d[2];
  p = goal;
  int open = across * along > 0.0;
  for (int i = 0; i < %(count)d && open; i++) {
    float c = curvature[i];
    p[2] -= vertex[i];
    p -= d * (p[2] / d[2]);
    vector facing = vector(0.0, 0.0, 1.0);
    if (general[i]) {
      float bx = bends_x[i];
      float by = bends_y[i];
      float stretch = (1.0 + conic[i]) * c * c;
      float slope = 0.0;
      float left = 1.0;
      for (int step = 0; step < 24 && abs(left) > 1e-6; step++) {
        float u = bx * p[0] * p[0] + by * p[1] * p[1];
        float under = 1.0 - stretch * u;
        if (under <= 0.0) {
          break;
        }
        float root = sqrt(under);
        float height = 0.0;
        slope = 0.0;
        for (int k = %(orders)d - 1; k >= 0; k--) {
          slope = slope * u + height;
          height = height * u + powers[i * %(orders)d + k];
        }
        slope = slope * u + height + 0.5 * c / root;
        height = height * u + c * u / (1.0 + root);
        float turn = bx * p[0] * d[0] + by * p[1] * d[1];
        left = (height - p[2]) / (d[2] - 2.0 * slope * turn);
        p += d * left;
      }
      open = abs(left) < 1e-4;
      facing = normalize(vector(-2.0 * slope * bx * p[0], -2.0 * slope * by * p[1], 1.0));
    }
    else if (c != 0.0) {
      float flat = c * (p[0] * p[0] + p[1] * p[1]);
      float across_d = c * (p[0] * d[0] + p[1] * d[1]) - d[2];
      float square = across_d * across_d - c * flat;
      open = square > 0.0;
      p += d * (-flat / (sqrt(max(square, 0.0)) + across_d));
      facing = vector(-c * p[0], -c * p[1], 1.0 - c * p[2]);
    }
    if (p[0] * p[0] + p[1] * p[1] > rim[i] * rim[i]) {
      open = 0;
    }
    if (i == %(stop)d && iris_clearance(p[0] / rim[i], p[1] / rim[i]) < 0.0) {
      open = 0;
    }
    float before = index[i];
    float behind = index[i + 1];
    if (before != behind && open) {
      float cosine_in = before * dot(d, facing);
      float square_out = behind * behind - before * before + cosine_in * cosine_in;
      open = square_out > 0.0;
      float cosine_out = (cosine_in < 0.0) ? -sqrt(max(square_out, 0.0)) :
                                             sqrt(max(square_out, 0.0));
      d = normalize(before * d + (cosine_out - cosine_in) * facing);
    }
    p[2] += vertex[i];
  }
  if (open) {
    position = point(p[0], p[1], %(pupil).9g - p[2]) * 0.001;
    direction = vector(d[0], d[1], -d[2]);
    throughput = color(%(weight).9g * cosine * cosine * cosine * cosine * across * along);
  }
}
"""
