"""Fans of rays through a lens, field by field, and the sums of `disc_terms` that follow them."""

from copy import copy

import numpy as np

from ..tables.undistorted import undistorted
from .disc_terms import disc_orders, radial_terms

_MM = 1000.0
# Degree of the sums, and rays along a radius: usually, and where the rim's rays go far astray.
_DEGREE, _RADII = 12, 10
_FINE_DEGREE, _FINE_RADII = 16, 18
_ANGLES = 19
# Rays that land so many times as far off as the median ray's count less: by how much they do.
_FAR = 3.0
# Misses of the sum over those of the median ray, in most of the iris, from which on it strays.
_STRAY, _INSIDE = 0.2, 0.9
# Steps of the field past the last one, for the rays that land there with more blur.
_CHIEFS = 5
# Weight in the fit of rays that a rim stops: how fast it falls with how far outside they are, the
# least, and that of what the last field had.
_STEEP, _BLOCKED, _KEPT = 30.0, 1e-5, 1e-7
# The most weight of what is made up where rays are lost, and how fast a rim ends there.
_LOST, _LOST_RIM = 1e-3, 0.05
# Light of rays that counts: no ray inside the rims has more.
_MOST_LIGHT = 3.0
# Rims that can cut: those that some ray of the fit comes so near to.
_NEAR_RIM, _MOST_RIMS = 0.05, 8
# Light of an axial ray, over that through the middle, from which on the stop counts as one that
# turns rays back before its rim.
_FOLDED = 1.6
# Share of the rays of a field that may have more than that.
_WILD = 0.01


class RayFan:
    """The rays of all fields: each field's, at all vergences, over half of the iris.

    Parameters
    ----------
    aim : StopAim
    scale : float
        Of the picture, mm a tangent.
    radius_mm : float
        Of the paraxial pupil.
    focus : float
        Vergence of the focus, 1/mm.
    vergences : ndarray of shape (K,)
        1/mm.
    fine : bool
        With more terms, and more rays.
    """

    def __init__(self, aim, scale, radius_mm, focus, vergences, fine=False):
        self.aim, self.scale, self.focus = aim, scale, focus
        self.radius_mm = radius_mm
        # Whether the stop turns rays of axial points back before its rim.
        self.folded = False
        self.orders = disc_orders(_FINE_DEGREE if fine else _DEGREE)
        self.radii = count = _FINE_RADII if fine else _RADII
        self.slabs = np.append(vergences, focus)
        # Denser towards the rim, as polynomials want it; mirror symmetry: half of the disc.
        radius = np.sin(0.5 * np.pi * (np.arange(count) + 1.0) / count)
        angle = np.linspace(0.0, np.pi, _ANGLES)
        radius, angle = (each.ravel() for each in np.meshgrid(radius, angle))
        self.radius, self.angle = np.append(radius, 0.0), np.append(angle, 0.0)
        self.local = np.stack(
            [self.radius * np.cos(self.angle), self.radius * np.sin(self.angle)], axis=-1
        )
        terms = radial_terms(self.orders, self.radius)
        turn = self.angle[:, None] * self.orders[:, 1]
        self.cosines, self.sines = terms * np.cos(turn), terms * np.sin(turn)
        # Rays on the mirror line stand for themselves alone.
        self.weight = np.where((self.angle == 0.0) | (self.angle == np.pi), 1.0, 2.0)

    def at_wavelength(self, wavelength_nm):
        """Return the fan of another wavelength, in the frame of this one."""
        other = copy(self)
        other.aim = self.aim.at_wavelength(wavelength_nm)
        return other

    def follow(self, fields):
        """Return `StopRays` of each field with its light, up to the last that rays come from."""
        followed = self._follow(fields)
        if followed:
            rays, light = followed[0]
            self.folded = not (rays.found.all() and light.max() < _FOLDED)
            for rays, light in followed:
                rims = np.delete(rays.rims[:, -len(light) :], self.aim.stop, axis=0)
                clear = (rims.min(axis=0) > 0.0) & rays.found[-len(light) :]
                wild = clear & ~(light < _MOST_LIGHT)
                self.folded |= wild.sum() > _WILD * clear.sum()
        return followed

    def strays(self, followed):
        """Whether the sum of terms does not follow the rays of an axial point in focus.

        Parameters
        ----------
        followed : list
            Of `follow`, of the axis.
        """
        rays, _ = followed[0]
        count = len(self.local)
        known = rays.found[-count:]
        if not known.all():
            return False
        off = _turned(rays.landing[-count:])[:, 0]
        off = off - off[-1]
        weight = _nearness(np.stack([off, np.zeros_like(off)], axis=-1), np.ones(count))
        found = self._fit(None, self.cosines, off, self.weight * weight, {})
        inside = self.radius < _INSIDE
        miss = np.sqrt(np.square(self.cosines @ found - off)[inside].mean())
        return bool(miss > _STRAY * np.median(np.abs(off)))

    def most_light(self, followed):
        """Return the most light of any ray that gets through, of what `follow` returns."""
        most = 0.0
        for rays, light in followed:
            at = slice(-len(light), None)
            clear = rays.found[at] & (rays.rims[:, at].min(axis=0) >= 0.0) & (light < _MOST_LIGHT)
            most = max(most, float(light[clear].max(initial=0.0)))
        return most

    def is_dark(self, followed):
        """Whether the rims stop all rays in focus of a field, as `follow` returns it."""
        rays, _ = followed
        at = slice(-len(self.local), None)
        return not (rays.found[at] & (rays.rims[:, at].min(axis=0) >= 0.0)).any()

    def _follow(self, fields):
        count = len(self.local)
        radius = abs(self.aim.pupil_radius)
        seen = np.tile(_turned_back(self.local), (len(self.slabs), 1)) * radius
        # The stop may be seen upside down.
        targets = seen / self.aim.pupil_radius
        vergences = np.repeat(self.slabs, count)
        places = before = seen
        followed = []
        for field in fields:
            start = 2.0 * places - before
            rays = self.aim.rays(field, vergences, targets, start)
            focus = rays.found.reshape(-1, count)[-1]
            if not focus[-1] or focus.mean() < 0.5:
                break
            chief = rays.places.reshape(-1, count, 2)[:, -1:]
            guess = (chief + seen.reshape(-1, count, 2)).reshape(-1, 2)
            before, places = places, np.where(rays.found[:, None], rays.places, guess)
            at = slice(-count, None)
            light = self.aim.throughput(field, vergences[at], rays.places[at])
            followed.append((rays, light * (self.scale / radius) ** 2))
        return followed

    def chiefs(self, fields):
        """Return fields and landing places of rays through the middle of the iris, over m."""
        step = fields[1]
        pairs, places, before = [], np.zeros((1, 2)), np.zeros((1, 2))
        for field in np.append(fields, fields[-1] + step * np.arange(1, _CHIEFS)):
            rays = self.aim.rays(
                field, np.array([self.focus]), np.zeros((1, 2)), 2.0 * places - before
            )
            landing = rays.landing[0, 1] / self.scale
            if not rays.found[0] or (pairs and landing <= pairs[-1][1]):
                break
            before, places = places, rays.places
            pairs.append((field, landing))
        return np.array(pairs)

    def fitted(self, fields, followed, distorted):
        """Return aberrations, chief rays, light and rims, as `LensRays` has them.

        Parameters
        ----------
        fields : ndarray of shape (F,)
        followed : list
            Of `follow`.
        distorted : ndarray of shape (M, 2) or None
            Of `chiefs`: the distortion that is taken away.
        """
        count, slabs, radius = len(self.local), len(self.slabs), self.radius_mm
        aberrations, chiefs, lights, rims = [], [], [], []
        last = {}
        for rays, light in followed:
            known = rays.found.reshape(slabs, count)
            seen = _turned(rays.landing.reshape(slabs, count, 2)) / self.scale
            if distorted is not None:
                away = np.linalg.norm(seen, axis=-1)
                shown = undistorted(distorted, away.ravel()).reshape(away.shape)
                seen = seen * (shown / np.maximum(away, 1e-30))[..., None]
            clear = np.stack(
                [
                    self._clearances(*each)
                    for each in zip(
                        known, np.moveaxis(rays.rims.reshape(-1, slabs, count), 1, 0), strict=True
                    )
                ],
                1,
            )
            others = np.delete(clear, self.aim.stop, axis=0)
            weight = self.weight * np.exp(_STEEP * np.minimum(others.min(axis=0), 0.0))
            weight = np.maximum(np.where(known, weight, np.minimum(weight, _LOST)), _BLOCKED)
            here, chief = [], []
            for k in range(slabs - 1):
                defocus = self.local * (radius * (self.focus - self.slabs[k]))
                own = self._spread(known[k], (seen[k] - defocus) / radius)
                held = weight[k] * _nearness(own, weight[k])
                parts = [
                    self._fit((k, axis), basis, own[:, axis], held, last)
                    for axis, basis in enumerate((self.cosines, self.sines))
                ]
                here.append(parts)
                chief.append(self.cosines[-1] @ parts[0] * radius)
            aberrations.append(here)
            chiefs.append(chief)
            sure = known[-1] & (light < _MOST_LIGHT)
            light = self._spread(sure, light)
            held = np.where(sure, np.maximum(weight[-1], _LOST), _LOST)
            lights.append(self._fit("light", self.cosines, light, held, last))
            rims.append(
                [
                    self._fit(("rim", s), self.cosines, each[-1], weight[-1], last)
                    for s, each in enumerate(clear)
                ]
            )
        return (
            np.array(aberrations) * _MM,
            np.array(chiefs) - fields[:, None],
            np.array(lights),
            np.array(rims)[:, self._cutting(followed)],
        )

    def _spread(self, known, values):
        """Give rays that do not count what the outermost one before them has, angle by angle."""
        if known.all():
            return values
        index = self._last_known(known)[0]
        return values[index]

    def _clearances(self, known, rims):
        """Let clearances of rims go on as they went where rays are lost, and one of them end."""
        if known.all():
            return rims
        index, before, beyond = self._last_known(known)
        farther = beyond > 0.0
        rims = rims[:, index] + np.minimum(rims[:, index] - rims[:, before], 0.0) * beyond
        least = rims.argmin(axis=0), np.arange(rims.shape[1])
        rims[least] = np.where(farther, np.minimum(rims[least], -_LOST_RIM * beyond), rims[least])
        return rims

    def _last_known(self, known):
        """For each ray that counts itself, else the outermost before it on its angle that does.

        Also the ray before that, and how many rays farther out than it the ray is.
        """
        order = np.arange(len(known) - 1).reshape(_ANGLES, self.radii)
        middle = np.full((_ANGLES, 1), len(known) - 1)
        order = np.concatenate([middle, order], axis=1)
        row = np.arange(self.radii + 1)
        # Up to the first that does not count.
        reach = np.logical_and.accumulate(known[order], axis=1).sum(axis=1, keepdims=True) - 1
        reach = np.maximum(reach, 0)
        whole = np.where(known[order], row, reach)
        result = []
        for columns in (whole, np.maximum(whole - 1, 0)):
            flat = np.empty(len(known), int)
            flat[order] = np.take_along_axis(order, columns, axis=1)
            result.append(flat)
        beyond = np.zeros(len(known))
        beyond[order] = np.where(known[order], 0, row - reach)
        return *result, beyond

    def _cutting(self, followed):
        count = len(self.local)
        least = np.min(
            [
                np.where(rays.found[-count:], rays.rims[:, -count:], 1.0).min(axis=1)
                for rays, _ in followed
            ],
            axis=0,
        )
        # Places of the iris are those of the stop: its own rim cuts none of them.
        least[self.aim.stop] = 1.0
        order = np.argsort(least)[:_MOST_RIMS]
        return np.sort(order[least[order] < _NEAR_RIM])

    def _fit(self, key, basis, values, weight, last):
        """Least squares; what the rays leave open stays as it was at the last field."""
        used = np.abs(basis).max(axis=0) > 1e-9
        root = np.sqrt(weight)[:, None]
        matrix = basis[:, used] * root
        goal = np.where(weight > 0.0, values, 0.0) * root[:, 0]
        before = last.get(key, np.zeros(len(used)))[used]
        size = _KEPT * len(values)
        normal = matrix.T @ matrix + size * np.eye(used.sum())
        result = np.zeros(len(used))
        result[used] = np.linalg.solve(normal, matrix.T @ goal + size * before)
        last[key] = result
        return result


def _nearness(own, weight):
    """Return by how much rays count: those that land far off may be missed by more."""
    off = np.linalg.norm(own - own[-1], axis=-1)
    usual = np.median(off[weight >= 0.5 * weight.max()])
    return 1.0 / (1.0 + np.square(off / max(_FAR * usual, 1e-30)))


def _turned(places):
    """From the lens' x and y to the directions e1 (+y) and e2."""
    return np.stack([places[..., 1], -places[..., 0]], axis=-1)


def _turned_back(local):
    return np.stack([-local[..., 1], local[..., 0]], axis=-1)
