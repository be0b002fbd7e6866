"""Pictures of a scene with many seeds, and how sure the difference of two methods is."""

import time
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

# Light below this, in a picture's mean, is black on every display and lost in single precision.
DARK = 1e-6
# Light of a channel, as a share of the brightest one's, to whose bar it is known at least.
_FAINT = 0.1


class Estimate:
    """Independent pictures of one scene by one method, with the seeds that follow the scene's.

    Parameters
    ----------
    scene : bpy.types.Scene
    render : callable
        See `agreement.compare`.
    prepare : callable
        From a scene and a seed to a context manager in which the scene is to be rendered.
    samples : int
        Of a picture of the reference method.
    made : int
        Pictures of this method that were made, and are not used any more.

    Attributes
    ----------
    pictures : dict of str to list of ndarray of shape (height, width, 4)
        By view layer.
    count : int
        Pictures of each.
    made : int
        Pictures that were rendered.
    """

    def __init__(self, scene, render, prepare, samples=0, made=0):
        self._scene = scene
        self._render = render
        self._prepare = prepare
        self._seed = scene.aplanat.seed
        self._taken = []
        self.pictures = {}
        self.count = 0
        self.samples, self.made = samples, made

    @property
    def seconds(self):
        """Processor time of a picture; what is made once for all is in the first one's."""
        return max(float(np.median(self._taken)) if self._taken else 0.0, 1e-3)

    def add(self, passes):
        """Take a picture in.

        Parameters
        ----------
        passes : dict of (str, str) to ndarray
            See `judge.render`.
        """
        for (layer, name), pixels in passes.items():
            if name == "Combined":
                self.pictures.setdefault(layer, []).append(pixels.astype(np.float64))
        self.count += 1

    def fill(self, count):
        """Render until there are so many pictures."""
        while self.count < count:
            begun = time.process_time()
            with self._prepare(self._scene, self._seed + self.count):
                self.add(self._render(self._scene))
            self.made += 1
            self._taken.append(time.process_time() - begun)


@dataclass(frozen=True)
class Spread:
    """Variances of the energy of single pictures, of the channel that is least sure.

    Parameters
    ----------
    own, reference, difference : float or ndarray of shape (C,)
        Of each method, and of the difference of two pictures of the same seed.
    """

    own: float
    reference: float
    difference: float

    @classmethod
    def of(cls, own, reference):
        """Return the largest of all view layers and channels, in terms of the bar."""
        found = []
        for layer in own.pictures:
            means = [energies(each.pictures[layer]) for each in (own, reference)]
            unit = units_of(means[1].mean(axis=0))
            spread = cls.between(*(each / unit for each in means))
            found += list(zip(spread.own, spread.reference, spread.difference, strict=True))
        at = (own.count, reference.count)
        return max((cls(*map(float, each)) for each in found), key=lambda s: s.variance(*at))

    @classmethod
    def between(cls, ours, theirs):
        """Return the spread of energies of shape (K, C) and (L, C); equal rows: equal seeds."""
        both = min(len(ours), len(theirs))
        pairs = (ours, theirs, ours[:both] - theirs[:both])
        return cls(*(each.var(axis=0, ddof=1) for each in pairs))

    def with_more_samples(self):
        """Guess the spread with twice as many samples of the reference method."""
        common = (self.own + self.reference - self.difference) / 2.0
        quieter = self.reference / 4.0
        difference = max(self.own + quieter - common, 0.0)
        return Spread(self.own, quieter, difference)

    def variance(self, ours, theirs):
        """Return the variance of the difference of the means of so many pictures each.

        Pictures of equal seeds count by their difference, the others by themselves.
        """
        alone = self.reference if theirs < ours else self.own
        few, many = sorted((ours, theirs))
        return self.difference / many + (1.0 / few - 1.0 / many) * alone

    def width(self, ours, theirs):
        """Return the squared half width of the interval of 95 %."""
        usual = student.ppf(0.975, min(ours, theirs) - 1)
        return self.variance(ours, theirs) * usual**2


def energies(pictures):
    """Return the light of pictures, shape (K, C)."""
    return np.stack([picture.mean(axis=(0, 1)) for picture in pictures])


def units_of(light):
    """Return the light of each channel of which 1 % is the bar for being sure, shape (4,)."""
    light = np.abs(light)
    faint = np.append(np.full(3, _FAINT * light[:3].max()), 0.0)
    return np.maximum(np.maximum(light, faint), DARK)
