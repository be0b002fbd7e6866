"""Whether a scene's own method agrees with the reference method, whatever the noise.

Both are rendered again and again with other seeds, each of which gives an independent estimate of
the same picture, until noise does not decide any more: until the noise that the spread of these
pictures tells is small against the bar, or the difference is larger than the bar by more than it.
The two are rendered with the same seeds, and so with the same places on the lens: what they have
in common of the noise goes out of their difference, and how much that is shows in the spread of
the differences.

- *Energy*: the sum of each channel of the mean picture differs by 1 % at most. Not asked of the
  layered method: its layers are texels, so that edges are soft by a part of a pixel, and what it
  promises (`docs/layers.md`) is likeness. A channel that has less than a tenth of the light of the
  brightest one fails as any other where it surely differs by 1 %; but it is enough to know that it
  differs by no more than 1 % of that tenth.
- *Looks*: the mean difference of the two mean pictures as they are displayed (the scene's view
  transform, 8 bits) is 0.02 at most. Noise alone makes pictures differ; its share of the mean
  difference, which half the change of the difference from one half of the pictures to the other
  shows, is taken off.
"""

import tempfile
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from scipy.stats import chi2
from scipy.stats import t as student

from .estimates import DARK, Estimate, Spread, energies, units_of
from .trades import fit_to_compare, has_plain_look, kept

ENERGY_BAR = 0.01
LOOK_BAR = 0.02
# Noise decides no more where its standard error is this share of the bar: two of them, which one
# scene in twenty has by chance, are then half the bar.
_QUIET = 0.25
# How often noise may be underestimated where it is called quiet.
_LUCK = 0.1
# A scene fails by more than chance brings one of ten thousand scenes, at four numbers each and as
# many looks at them as there are rounds.
_CHANCE = 1e-6
# Pictures of each method: three tell their spread within a factor of 4 (two: 13), and with a
# hundred the noise is a tenth of one picture's.
_FEWEST, MOST = 3, 96
# Processor time of a comparison, in seconds; see `compare`.
PATIENCE = 20.0
# Of a picture of the reference method: at first, at most. Its samples are spread evenly, so that
# twice as many quieten it more than two pictures do: about to a half. They have less in common with
# those of the other method, if anything: about half.
_REFERENCE_SAMPLES = (64, 256)


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
    if _is_reference(scene):
        # Equal seeds give equal pictures: there is nothing to learn, and most of the cost to save.
        return Agreement("", {"energy": 0.0, "look": 0.0, "renders": 1, "undecided": 0.0})
    end = time.process_time() + patience
    with fit_to_compare(scene) as changed:
        own = Estimate(scene, render, _set_seed)
        if not changed:
            own.add(first)
        own.fill(_FEWEST)
        reference = _reference(scene, render, _first_samples(scene.aplanat))
        while True:
            found = _judge(scene, own, reference)
            if found.fault or not found.measured["undecided"]:
                return found
            left = end - time.process_time()
            steps = [s for s in _steps(own, reference, most) if s.seconds <= left]
            if not steps:
                return found
            # Where noise is bought off cheapest.
            step = max(steps, key=lambda s: s.gain / s.seconds)
            if step.samples:
                reference = _reference(scene, render, step.samples, reference.made)
            own.fill(step.own)
            reference.fill(step.reference)


def _is_reference(scene):
    """Tell whether a scene is drawn just as the reference method draws it here."""
    settings = scene.aplanat
    if settings.method != "REFERENCE":
        return False
    return not (settings.use_reference_bokeh and has_plain_look(scene.camera.data))


def _first_samples(settings):
    """Return the samples of the first pictures of the reference method.

    As many as the scene's own where that is its method: equal seeds then give equal pictures, but
    for what else is different.
    """
    if settings.method == "REFERENCE":
        return settings.render_samples
    return _REFERENCE_SAMPLES[0]


@dataclass(frozen=True)
class _Step:
    """What can be done about the noise: how many pictures of each there are then.

    Parameters
    ----------
    own, reference : int
        Pictures.
    samples : int
        Of a new picture of the reference method; 0: as before.
    gain : float
        By which the squared width of the difference's interval falls.
    seconds : float
    """

    own: int
    reference: int
    samples: int
    gain: float
    seconds: float


def _steps(own, reference, most):
    spread = Spread.of(own, reference)
    counts = own.count, reference.count
    before = spread.width(*counts)
    further = [(2 * counts[0], counts[1], 0), (counts[0], 2 * counts[1], 0)]
    further += [(2 * counts[0], 2 * counts[1], 0), (counts[0], _FEWEST, 2 * reference.samples)]
    steps = []
    for ours, theirs, samples in further:
        made = theirs - counts[1] if samples == 0 else theirs
        few = own.made + ours - counts[0] <= most and reference.made + made <= most
        if not few or samples > _REFERENCE_SAMPLES[1]:
            continue
        after = (spread.with_more_samples() if samples else spread).width(ours, theirs)
        seconds = (ours - counts[0]) * own.seconds
        seconds += made * reference.seconds * (2.0 if samples else 1.0)
        steps.append(_Step(ours, theirs, samples, before - after, seconds))
    # Where only looks are undecided, nothing is gained by these numbers: more of both.
    return [s for s in steps if s.gain > 0.0] or [s for s in steps if not s.samples][-1:]


def _reference(scene, render, samples, made=0):
    prepare = partial(_render_reference, samples=samples)
    estimate = Estimate(scene, render, prepare, samples, made)
    estimate.fill(_FEWEST)
    return estimate


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
    with _as_reference(scene, samples), _set_seed(scene, seed):
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
    ours, theirs = energies(ours), energies(theirs)
    reference = theirs.mean(axis=0)
    lit = np.maximum(np.abs(reference), np.abs(ours.mean(axis=0))) > DARK
    if not lit.any():
        return ""
    scale = np.maximum(np.abs(reference), DARK)
    difference = (ours.mean(axis=0) - reference) / scale
    spread = Spread.between(ours / scale, theirs / scale)
    noise = np.sqrt(spread.variance(len(ours), len(theirs)))
    # The spreads rest on few pictures, and on no fewer than these.
    freedom = min(len(ours), len(theirs)) - 1
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
    # What may well be a fault is looked at until it is one, however faint.
    suspect = np.abs(difference) - 2.0 * usual * noise > ENERGY_BAR
    share = scale / units_of(reference)
    difference, noise = np.abs(difference) * share, noise * share
    # By chance a few pictures may be more alike than others would be.
    wider = np.sqrt(freedom / chi2.ppf(_LUCK, freedom))
    quiet = noise * wider < _QUIET * ENERGY_BAR
    within = difference + 2.0 * usual * noise < ENERGY_BAR
    unsure = suspect | (~quiet & ~within) | (quiet & (difference > ENERGY_BAR))
    if (lit & unsure).any():
        measured["undecided"] = 1.0
    return ""


def _judge_look(scene, ours, theirs, measured):
    halves = [[displayed(scene, p) for p in _halves(pictures)] for pictures in (ours, theirs)]
    first, second = (one - other for one, other in zip(*halves, strict=True))
    noise = float(np.abs(first - second).mean()) / 2.0
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
