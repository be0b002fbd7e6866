"""Which places on lights each lens sample sees the scene from (**ours**).

Every lens sample sees each of the main lights from places of its own on it: what it asks is how
much of a light arrives, not which light, so that a light that nothing hides has no noise and one
that is hidden everywhere gives nothing. Weak lights have their turns, and shine by as much more
then. Places come again after a generation of lens samples; then others follow.
"""

from dataclasses import dataclass

import numpy as np

from .light_samples import schedule, turns_of

# Lens samples after which new places are taken: with so many steps shadows are smooth.
GENERATION = 64
# From this share of the light on, a lamp is a main one; and how many of those there may be.
_MAIN_SHARE = 1.0 / 32.0
_MOST_MAIN = 6
# Places of a generation on a lamp: a small one needs only as many as hide the texels of its maps,
# a large one one for each lens sample.
_LEAST_OF_LAMP, _MOST_OF_LAMP = 8, 64
# Half angle, in radians, from which a lamp has all of them; and from which an area light sends so
# different light from its places that a lens sample sees several of them.
_LARGE, _UNEVEN = 0.12, 0.3
_EACH_OF_UNEVEN = 4
# Places of a lens sample on the sky, and on one with this share of the light; and how many lens
# samples of a generation have others.
_EACH_OF_SKY, _BRIGHT_SKY = (4, 8), 0.25
_SETS_OF_SKY = 32
# Directions of the sky that come together, two opposite ones of each kind. With two such groups a
# lens sample has each corrected by what is hidden of the other.
SKY_GROUP = 4
# When sets come again the second group is that of the set so many on: other groups meet, without
# more maps.
_SETS_ON = 11
# Places on weak lights: of a generation, and of a lens sample.
_MOST_WEAK, _EACH_WEAK = 128, 2
# Most places of one drawing: of all main lamps, of the sky, of weak lights.
_MOST_LISTED = (56, 56, 16)
MOST_LISTED = sum(_MOST_LISTED)
# Of those that all drawings agree on: of a lamp, of the sky.
_STEADY_OF_LAMP, _STEADY_OF_SKY = 4, 8


@dataclass(frozen=True, eq=False)
class LightList:
    """What one drawing is lit from.

    Parameters
    ----------
    places : ndarray of shape (P,)
        int; places of the generation, those on one light side by side.
    firsts, counts : ndarray of shape (L + 1,)
        int; which of them are on each light, the sky last. Where there are none, nothing hides it.
    weights : ndarray of shape (L + 1,)
        How much more than its own light each stands for.
    """

    places: np.ndarray
    firsts: np.ndarray
    counts: np.ndarray
    weights: np.ndarray


class LightTurns:
    """The places of a frame on its lights.

    Parameters
    ----------
    shares : ndarray of shape (L + 1,)
        Of each light of all the light in view, the sky last; 0 of one that throws no shadow.
    angles : ndarray of shape (L + 1,)
        Half angle under which each is seen, radians.
    uneven : ndarray of shape (L + 1,)
        bool; area lights.
    samples : int or None
        Lens samples that there will be, if it is known.
    seed : int

    Attributes
    ----------
    counts : ndarray of shape (L + 1,)
        int; places on each light in a generation.
    each : ndarray of shape (L + 1,)
        int; places from which a lens sample sees a main lamp or the sky; 0 of others.
    """

    def __init__(self, shares, angles, uneven, samples=None, seed=0):
        shares = np.asarray(shares, np.float64)
        self._sky = len(shares) - 1
        lamps = np.argsort(-shares[:-1], kind="stable")
        largest = lamps[shares[lamps] >= _MAIN_SHARE * shares.sum()]
        self._main = np.sort(largest[shares[largest] > 0.0][:_MOST_MAIN])
        self.each = np.zeros(len(shares), np.int64)
        self.counts = np.zeros(len(shares), np.int64)
        of_sky = shares[-1] / shares.sum() if shares.sum() > 0.0 else 0.0
        if of_sky > 0.0:
            self.each[-1] = _EACH_OF_SKY[int(of_sky >= _BRIGHT_SKY)]
            self.counts[-1] = self.each[-1] * _SETS_OF_SKY
        for light in self._main:
            wide = min(angles[light] / _LARGE, 1.0)
            self.each[light] = 1
            if uneven[light] and angles[light] > _UNEVEN:
                self.each[light] = _EACH_OF_UNEVEN
            # Powers of two: in a generation all have equal turns.
            steps = np.log2(_LEAST_OF_LAMP) + wide * np.log2(_MOST_OF_LAMP / _LEAST_OF_LAMP)
            self.counts[light] = 2 ** int(np.ceil(steps - 1e-9))
        if samples is not None:
            self.counts = np.minimum(self.counts, samples * self.each)
        weak = shares.copy()
        weak[self._main] = weak[-1] = 0.0
        most = _MOST_WEAK if samples is None else min(_MOST_WEAK, samples * _EACH_WEAK)
        self._weak_turns = turns_of(weak, most)
        self._weak_lights, self._weak_numbers = schedule(self._weak_turns, seed)
        self.counts += self._weak_turns
        self._starts = np.cumsum(self.counts) - self.counts

    def lights_and_numbers(self):
        """Return the light of each place of a generation, and which of the light's it is."""
        lights = np.repeat(np.arange(len(self.counts)), self.counts)
        return lights, np.arange(len(lights)) - self._starts[lights]

    def of_samples(self, samples):
        """Return what a drawing is lit from.

        Parameters
        ----------
        samples : sequence of int
            The lens samples that share it.

        Returns
        -------
        LightList
        """
        samples = np.unique(np.asarray(samples, np.int64))
        found, weights = {}, np.ones(len(self.counts))
        most_of_lamp = _MOST_LISTED[0] // max(len(self._main), 1)
        for light in (*self._main.tolist(), self._sky):
            each, count = self.each[light], self.counts[light]
            if count:
                if light == self._sky:
                    own, most = self._of_sky(samples), _MOST_LISTED[1]
                else:
                    own = (samples[:, None] * each + np.arange(each)).ravel() % count
                    most = most_of_lamp
                found[light] = _thinned(np.unique(own), most)
        if turns := len(self._weak_lights):
            slots = (samples[:, None] * _EACH_WEAK + np.arange(_EACH_WEAK)).ravel()
            slots = _thinned(slots, _MOST_LISTED[2]) % turns
            lights, numbers = self._weak_lights[slots], self._weak_numbers[slots]
            there = self._weak_turns > 0
            times = np.bincount(lights, minlength=len(self.counts))
            weights[there] = (times * (turns / len(slots)))[there] / self._weak_turns[there]
            for light in np.unique(lights).tolist():
                found[light] = numbers[lights == light]
        return self._list(found, weights)

    def _of_sky(self, samples):
        """Return which directions of the sky lens samples see."""
        each = self.each[-1]
        sets = self.counts[-1] // each
        groups = np.arange(each // SKY_GROUP)
        again = samples // sets * _SETS_ON
        whose = (samples[:, None] + again[:, None] * groups) % sets
        firsts = whose * each + groups * SKY_GROUP
        return np.add.outer(firsts, np.arange(SKY_GROUP)).ravel()

    def steady(self):
        """Return what all drawings are lit from that must agree; weak lights are not hidden."""
        found = {light: np.arange(_STEADY_OF_LAMP) for light in self._main.tolist()}
        found[self._sky] = np.arange(_STEADY_OF_SKY)
        found = {light: own[own < self.counts[light]] for light, own in found.items()}
        return self._list(found, np.ones(len(self.counts)))

    def _list(self, found, weights):
        counts = np.zeros(len(self.counts), np.int64)
        places = [np.zeros(0, np.int64)]
        for light in sorted(found):
            counts[light] = len(found[light])
            places.append(self._starts[light] + found[light])
        firsts = np.cumsum(counts) - counts
        return LightList(np.concatenate(places), firsts, counts, weights)


def unhidden(lights):
    """Return the list of a drawing in which nothing hides any of so many lights, or the sky."""
    none = np.zeros(lights + 1, np.int64)
    return LightList(none[:0], none, none, np.ones(lights + 1))


def _thinned(numbers, most):
    """Return at most so many of some numbers, evenly chosen."""
    if len(numbers) <= most:
        return numbers
    return numbers[np.arange(most) * len(numbers) // most]
