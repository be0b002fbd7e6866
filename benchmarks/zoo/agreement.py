"""Whether a scene's own method agrees with the reference method, whatever the noise.

Both are rendered again and again with other seeds, each of which gives an independent estimate of
the same picture, until noise does not decide any more: until the noise that the spread of these
pictures tells is small against the bar, or the difference is larger than the bar by more than it.

- *Energy*: the sum of each channel of the mean picture differs by 1 % at most. Not asked of the
  layered method: its layers are texels, so that edges are soft by a part of a pixel, and what it
  promises (`docs/layers.md`) is likeness.
- *Looks*: the mean difference of the two mean pictures as they are displayed (the scene's view
  transform, 8 bits) is 0.02 at most. Noise alone makes pictures differ; its share of the mean
  difference, which half the mean difference of two halves of the pictures shows for each of the
  two, is taken off.
"""

import tempfile
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from scipy.stats import t as student

from .trades import fit_to_compare, has_plain_look, kept

ENERGY_BAR = 0.01
LOOK_BAR = 0.02
# Noise decides no more where its standard error is this share of the bar: two of them, which one
# scene in twenty has by chance, are then half the bar.
_QUIET = 0.25
# A scene fails by more than chance brings one of ten thousand scenes, at four numbers each and as
# many looks at them as there are rounds.
_CHANCE = 1e-6
# Pictures of each method: three tell their spread within a factor of 4 (two: 13), and with a
# hundred the noise is a tenth of one picture's.
_FEWEST, MOST = 3, 96
# Processor time of a comparison, in seconds; see `compare`.
PATIENCE = 20.0
# Of a picture of the reference method: at first, at most. Its samples are spread evenly, so that
# twice as many quieten it more than two pictures do: about to a half.
_REFERENCE_SAMPLES = (64, 256)
# Light below this, in a picture's mean, is black on every display and lost in single precision.
_DARK = 1e-6


@dataclass
class Agreement:
    """How far two methods agree.

    Attributes
    ----------
    fault : str
        One line, or empty where they agree.
    measured : dict of str to float
        ``energy`` (largest relative difference of a channel), ``energy_noise`` (its standard
        error), ``look`` (mean difference as displayed, without noise), ``look_noise``, ``renders``
        (of its own method) and ``undecided`` (1 where noise still decides).
    """

    fault: str = ""
    measured: dict = field(default_factory=dict)


def compare(scene, render, first, most=MOST, patience=PATIENCE):
    """Compare the method that a scene asks for with the reference method.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its settings are put back.
    render : callable
        Renders a scene: see `judge.render`.
    first : dict of (str, str) to ndarray
        What the scene itself rendered to.
    most : int
        Pictures of each method; a scene that is undecided then is not failed, but told.
    patience : float
        Seconds of processor time that are not exceeded by choice; a scene that is undecided then is
        left so.

    Returns
    -------
    Agreement
    """
    end = time.process_time() + patience
    with fit_to_compare(scene) as changed:
        own = _Estimate(scene, render, _set_seed)
        if not changed:
            own.add(first)
        own.fill(_FEWEST)
        reference = _reference(scene, render, _REFERENCE_SAMPLES[0])
        while True:
            found = _judge(scene, own, reference)
            if found.fault or not found.measured["undecided"]:
                return found
            left = end - time.process_time()
            steps = [s for s in _steps(own, reference, most) if s.seconds <= left]
            if not steps:
                return found
            # Where noise is bought off cheapest: of the one method or of the other.
            step = max(steps, key=lambda s: s.gain / s.seconds)
            if step.samples:
                reference = _reference(scene, render, step.samples, reference.made)
            else:
                step.estimate.fill(2 * step.estimate.count)


@dataclass(frozen=True)
class _Step:
    """What can be done about the noise: how much it takes off a variance, in which time."""

    estimate: object
    gain: float
    seconds: float
    samples: int = 0


def _steps(own, reference, most):
    parts = [estimate.variance(reference) for estimate in (own, reference)]
    if max(parts) == 0.0:
        # Only looks are undecided.
        parts = [1.0, 1.0]
    steps = []
    if 2 * own.count <= most:
        steps.append(_Step(own, parts[0] / 2.0, own.count * own.seconds))
    if reference.samples < _REFERENCE_SAMPLES[1]:
        if reference.made + _FEWEST <= most:
            seconds = 2.0 * _FEWEST * reference.seconds
            steps.append(_Step(reference, parts[1] * 0.75, seconds, 2 * reference.samples))
    elif reference.made + reference.count <= most:
        steps.append(_Step(reference, parts[1] / 2.0, reference.count * reference.seconds))
    return steps


def _reference(scene, render, samples, made=0):
    estimate = _Estimate(scene, render, partial(_render_reference, samples=samples))
    estimate.samples, estimate.made = samples, made
    estimate.fill(_FEWEST)
    return estimate


class _Estimate:
    """Independent pictures of one scene by one method."""

    def __init__(self, scene, render, prepare):
        self._scene = scene
        self._render = render
        self._prepare = prepare
        self._seed = scene.aplanat.seed
        self._taken = []
        self.pictures = {}
        self.count = self.made = 0
        self.samples = 0

    @property
    def seconds(self):
        """Processor time of a picture; what is made once for all is in the first one's."""
        return max(float(np.median(self._taken)) if self._taken else 0.0, 1e-3)

    def add(self, passes):
        for (layer, name), pixels in passes.items():
            if name == "Combined":
                self.pictures.setdefault(layer, []).append(pixels.astype(np.float64))
        self.count += 1

    def fill(self, count):
        while self.count < count:
            begun = time.process_time()
            with self._prepare(self._scene, self._seed + self.count):
                self.add(self._render(self._scene))
            self.made += 1
            self._taken.append(time.process_time() - begun)

    def variance(self, reference):
        """Largest variance of the energy of a channel, relative to the reference's."""
        found = [0.0]
        for layer, pictures in self.pictures.items():
            scale = np.abs(np.mean(reference.pictures[layer], axis=(0, 1, 2)))
            means = np.stack([p.mean(axis=(0, 1)) for p in pictures])
            lit = scale > _DARK
            found += list(means.var(axis=0, ddof=1)[lit] / len(means) / scale[lit] ** 2)
        return float(max(found))


@contextmanager
def _set_seed(scene, seed):
    with kept(scene.aplanat, ("seed",)):
        scene.aplanat.seed = seed % 2**31
        yield


@contextmanager
def _as_reference(scene, samples):
    settings = scene.aplanat
    with kept(settings, ("method", "render_samples", "use_reference_bokeh")):
        own = settings.method == "REFERENCE"
        settings.method = "REFERENCE"
        settings.render_samples = samples
        # A scene of the reference method says itself whether samples or discs draw its highlights.
        wanted = settings.use_reference_bokeh or not own
        settings.use_reference_bokeh = wanted and not has_plain_look(scene.camera.data)
        yield


@contextmanager
def _render_reference(scene, seed, samples):
    # Far from the seeds of the scene's own method, so that no noise is shared.
    with _as_reference(scene, samples), _set_seed(scene, seed + 1_000_003):
        yield


def _judge(scene, own, reference):
    measured = {"energy": 0.0, "energy_noise": 0.0, "look": 0.0, "look_noise": 0.0}
    measured |= {"renders": own.count, "undecided": 0.0}
    faults = []
    for layer in own.pictures:
        ours, theirs = own.pictures[layer], reference.pictures[layer]
        found = [_judge_look(scene, ours, theirs, measured)]
        if scene.aplanat.method != "LAYERED":
            found.insert(0, _judge_energy(ours, theirs, measured))
        faults += [f"view layer '{layer}': {fault}" for fault in found if fault]
    return Agreement("; ".join(faults), measured)


def _judge_energy(ours, theirs, measured):
    means = [np.stack([p.mean(axis=(0, 1)) for p in pictures]) for pictures in (ours, theirs)]
    reference = means[1].mean(axis=0)
    lit = np.maximum(np.abs(reference), np.abs(means[0].mean(axis=0))) > _DARK
    if not lit.any():
        return ""
    scale = np.maximum(np.abs(reference), _DARK)
    difference = (means[0].mean(axis=0) - reference) / scale
    variances = [m.var(axis=0, ddof=1) / len(m) for m in means]
    noise = np.sqrt(sum(variances)) / scale
    # The two spreads rest on few pictures each (Welch and Satterthwaite).
    parts = sum(v**2 / (len(m) - 1) for v, m in zip(variances, means, strict=True))
    least = min(len(m) for m in means) - 1
    freedom = np.divide(
        sum(variances) ** 2, parts, out=np.full_like(parts, least), where=parts > 0.0
    )
    wide, usual = student.ppf(1.0 - _CHANCE, freedom), student.ppf(0.975, freedom) / 2.0
    worst = int(np.argmax(np.where(lit, np.abs(difference), 0.0)))
    if abs(difference[worst]) >= measured["energy"]:
        measured["energy"] = float(abs(difference[worst]))
        measured["energy_noise"] = float(noise[worst])
    beyond = lit & (np.abs(difference) - wide * noise > ENERGY_BAR)
    if beyond.any():
        channel = int(np.argmax(np.where(beyond, np.abs(difference), 0.0)))
        return (
            f"energy of {'RGBA'[channel]} is {1.0 + difference[channel]:.4f} times the reference's"
            f" (noise {noise[channel]:.4f})"
        )
    quiet = noise * usual < _QUIET * ENERGY_BAR
    within = np.abs(difference) + 2.0 * usual * noise < ENERGY_BAR
    if (lit & ~quiet & ~within).any() or (lit & quiet & (np.abs(difference) > ENERGY_BAR)).any():
        measured["undecided"] = 1.0
    return ""


def _judge_look(scene, ours, theirs, measured):
    shown = [[displayed(scene, p) for p in _halves(pictures)] for pictures in (ours, theirs)]
    noise = sum(float(np.abs(a - b).mean()) / 2.0 for a, b in shown)
    means = [displayed(scene, np.mean(pictures, axis=0)) for pictures in (ours, theirs)]
    difference = max(0.0, float(np.abs(means[0] - means[1]).mean()) - noise)
    measured["look"] = max(measured["look"], difference)
    measured["look_noise"] = max(measured["look_noise"], noise)
    if difference > LOOK_BAR and noise < LOOK_BAR:
        return f"looks differ by {difference:.4f} (noise {noise:.4f})"
    if difference > LOOK_BAR:
        measured["undecided"] = 1.0
    return ""


def _halves(pictures):
    half = len(pictures) // 2
    return np.mean(pictures[:half], axis=0), np.mean(pictures[half:], axis=0)


def displayed(scene, picture):
    """Return a picture as Blender displays it, on black.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its view transform, look, exposure and gamma.
    picture : ndarray of shape (height, width, 4)
        Scene linear, premultiplied by alpha.

    Returns
    -------
    ndarray of shape (height, width, 3)
        0 to 1, of 256 values: what is lost is a tenth of the bar at most.
    """
    import bpy
    import imageio.v3 as iio

    height, width = picture.shape[:2]
    image = bpy.data.images.new("displayed", width, height, float_buffer=True)
    settings = scene.render.image_settings
    try:
        opaque = np.concatenate([picture[..., :3], np.ones((height, width, 1))], axis=-1)
        image.pixels.foreach_set(np.ascontiguousarray(opaque, np.float32).ravel())
        settings.media_type = "IMAGE"
        settings.file_format = "PNG"
        settings.color_mode = "RGB"
        settings.color_depth = "8"
        settings.color_management = "FOLLOW_SCENE"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "displayed.png"
            image.save_render(str(path), scene=scene)
            return iio.imread(path)[::-1].astype(np.float64) / 255.0
    finally:
        bpy.data.images.remove(image)
