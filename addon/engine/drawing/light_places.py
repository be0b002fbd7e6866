"""Places on lights: which light how many light samples see the scene from, and from where on it."""

from dataclasses import dataclass

import numpy as np

from ...sampling.lights.light_samples import ball_points, disk_points, sequence, sky_places
from ...sampling.lights.light_turns import SKY_GROUP
from . import light_views

# Points in view at which lights are compared: of instances, and along each side of slices of depth.
_MOST_INSTANCES = 128
_ALONG = 4


@dataclass(frozen=True, eq=False)
class LightSample:
    """A place on a light, and what is seen from there.

    Parameters
    ----------
    light : int
        Of the content's; -1 for the sky.
    place : ndarray of shape (3,)
        In world space; of a sun the way light travels, of the sky the direction towards it.
    views : list of light_views.LightView
    light_of_sky : tuple of 3 float
        Radiance over the density of directions.
    group_of_sky : int
        Of the sky: which group of a lens sample's directions it is of, 0 or 1.
    """

    light: int
    place: np.ndarray
    views: list
    light_of_sky: tuple[float, float, float] = (0.0, 0.0, 0.0)
    group_of_sky: int = 0


def irradiances(light, points):
    """Return how strongly a light may light points, a surface that faces it, without shadows.

    Parameters
    ----------
    light : Light
    points : ndarray of shape (P, 3)

    Returns
    -------
    ndarray of shape (P,)
        Mean of the channels, W/m^2.
    """
    power = float(np.abs(light.radiance).mean())
    if light.kind == "SUN":
        return np.full(len(points), power)
    offset = points - np.array(light.position)
    distance2 = np.square(offset).sum(axis=1)
    ray = offset / np.sqrt(np.maximum(distance2, 1e-20))[:, None]
    if light.kind == "AREA":
        area = 4.0 * light.half_size[0] * light.half_size[1]
        facing = np.maximum(ray @ np.array(light.direction), 0.0)
        # At most all that is around a point is the light.
        return power * np.minimum(area * facing / np.maximum(distance2, 1e-20), np.pi)
    beam = np.ones(len(points))
    if light.kind == "SPOT":
        local = ray @ np.array(light.axes, np.float64).T
        z = local[:, 2] / np.maximum(np.linalg.norm(local, axis=1), 1e-12)
        beam = np.clip((z - light.cone[0]) * light.cone[1], 0.0, 1.0)
    return power * beam / np.maximum(distance2, max(light.radius**2, 1e-12))


def light_shares(lights, sky, receivers, spheres, seen):
    """Return the share that each light has of the light in view.

    Parameters
    ----------
    lights : sequence of Light
    sky : sampling.lights.sky_samples.Sky
    receivers : light_views.Receivers
    spheres : culling.BoundingSpheres
    seen : ndarray of shape (I,)
        bool.

    Returns
    -------
    ndarray of shape (L + 1,)
        Mean over places in view of a light's share of all light there; 0 of one without shadows.
        The last is the sky's.
    """
    low, high = receivers.box()
    rows = np.flatnonzero(seen)
    rows = rows[:: -(-len(rows) // _MOST_INSTANCES)]
    points = [np.clip(spheres.centers[rows], low, high)]
    share = (np.arange(_ALONG) + 0.5) / _ALONG
    for corners in receivers.slices:
        for z in (0, 4):
            for x in share:
                for y in share:
                    left = corners[z] * (1.0 - y) + corners[z + 2] * y
                    right = corners[z + 1] * (1.0 - y) + corners[z + 3] * y
                    points.append(np.clip(left * (1.0 - x) + right * x, low, high)[None])
    points = np.concatenate(points)
    of_sky = np.full(len(points), sky.irradiance)
    light = np.stack([*(irradiances(each, points) for each in lights), of_sky])
    total = light.sum(axis=0)
    shares = np.divide(light, total, out=np.zeros_like(light), where=total > 0.0).mean(axis=1)
    return np.where([*(each.shadow for each in lights), True], shares, 0.0)


def half_angles(lights, receivers):
    """Return the half angle under which each light is seen from where it is largest, radians.

    Parameters
    ----------
    lights : sequence of Light
    receivers : light_views.Receivers

    Returns
    -------
    ndarray of shape (L,)
    """
    low, high = receivers.box()
    found = np.zeros(len(lights))
    for number, light in enumerate(lights):
        place, size = np.array(light.position), light.radius
        if light.kind == "AREA":
            size = float(np.hypot(*light.half_size))
        distance = 1.0
        if light.kind != "SUN":
            distance = float(np.linalg.norm(np.clip(place, low, high) - place))
        found[number] = np.arctan2(size, distance)
    return found


def aim_sky_samples(sky, each, sets, generation, stream, seed, receivers, hiding):
    """Choose directions of the sky, those of a lens sample side by side, and their views.

    Half of each lens sample's directions follow the light; see
    `sampling.lights.light_samples.sky_places` for the numbers, and `aim_sample`.

    Returns
    -------
    list of LightSample
    """
    turns = np.random.default_rng([seed, 5, stream, generation]).random(each * sets)
    # A group after the other; of each, every other direction follows the light.
    groups = each // SKY_GROUP
    towards, light = np.empty((2, sets, groups, SKY_GROUP, 3))
    for follows in (False, True):
        u = sky_places(groups, sets, seed, stream + follows, generation)
        found = sky.directions(u.reshape(-1, 2), follows)
        for given, part in zip((towards, light), found, strict=True):
            given[:, :, follows::2] = part.reshape(sets, groups, -1, 3)
    group_of = np.broadcast_to(np.arange(groups)[:, None], (sets, groups, SKY_GROUP))
    return [
        LightSample(
            -1,
            place,
            light_views.parallel_views(receivers, *hiding, -place, turn),
            tuple(given),
            group,
        )
        for place, given, turn, group in zip(
            towards.reshape(-1, 3),
            light.reshape(-1, 3).tolist(),
            turns,
            group_of.ravel().tolist(),
            strict=True,
        )
    ]


def aim_sample(light, number_of_light, number, stream, seed, receivers, hiding):
    """Choose a place on a light and its views of the scene.

    Parameters
    ----------
    light : Light
    number_of_light : int
    number : int
        Of the place among those of this light.
    stream, seed : int
        Of the sequence of places.
    receivers : light_views.Receivers
    hiding : tuple of ndarray of shape (I, 3) and of shape (I,)
        Middles and radii of the bounding spheres of all that hides light.

    Returns
    -------
    LightSample
    """
    u = sequence([number], 3, seed, stream)
    turn = np.random.default_rng([seed, 5, stream, number]).random(3)
    direction = np.array(light.direction, np.float64)
    if light.kind == "SUN":
        right, up = light_views.turned(direction, 0.0)
        # The disk of a sun is flat, as in Cycles.
        tangent = light.radius / np.sqrt(max(1.0 - light.radius**2, 1e-6))
        x, y = disk_points(u[:, :2])[0] * tangent
        along = direction + x * right + y * up
        along /= np.linalg.norm(along)
        views = light_views.parallel_views(receivers, *hiding, along, turn[0])
        return LightSample(number_of_light, along, views)
    place = np.array(light.position, np.float64)
    cone = None
    axes = np.array(light.axes, np.float64)
    if light.kind == "AREA":
        x, y = (2.0 * u[0, :2] - 1.0) * light.half_size
        place = place + x * axes[0] + y * axes[1]
    else:
        place = place + light.radius * ball_points(u)[0]
        sizes = np.linalg.norm(axes, axis=1)
        if light.kind == "SPOT" and np.ptp(sizes) < 1e-3 * sizes.max() and light.cone[0] > 0.1:
            # A little wider: the beam begins at the lamp's middle, not at this place on it.
            cone = (direction, 1.05 * np.sqrt(1.0 / light.cone[0] ** 2 - 1.0))
            if light.radius > 0.0:
                cone = None
    views = light_views.lamp_views(receivers, place, turn, cone)
    return LightSample(number_of_light, place, views)
