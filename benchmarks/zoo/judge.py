"""What is asked of every scene of the zoo, in the order in which it is asked.

It renders through Blender's own operator, as F12 does, and writes its file; no pixel of any pass is
NaN or infinite; every pass that is switched on is there, in the engine's hands and in the file;
built and rendered again it has the same bits, unless Blender makes another scene of it
(`blenders_part`); and the method that it asks for agrees with the reference method (`agreement`).
"""

import math
import tempfile
import time
import traceback
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from addon.engine.shared_resources import listen
from addon.errors import AplanatError
from addon.settings.scene_settings import PASSES
from addon.settings.setting import settings_of

from . import agreement
from .blenders_part import digests_of_scenes
from .scenes.script import build

# Blender's switch of each pass, and the pass.
LAYER_PASSES = {
    "use_pass_z": "Depth",
    "use_pass_normal": "Normal",
    "use_pass_position": "Position",
    "use_pass_vector": "Vector",
}
OWN_PASSES = {name: setting.field for name, setting in settings_of(PASSES).items()}
CRYPTOMATTES = {
    "use_pass_cryptomatte_object": "CryptoObject",
    "use_pass_cryptomatte_material": "CryptoMaterial",
}


class Fault(Exception):
    """What is wrong with a scene.

    Parameters
    ----------
    kind : str
        One of `KINDS`; scenes that fail with another kind fail differently.
    text : str
        One line.
    detail : str
        More lines: a traceback.
    """

    KINDS = ("traceback", "refused", "not finite", "no pass", "not repeatable", "disagrees")

    def __init__(self, kind, text, detail=""):
        super().__init__(f"{kind}: {text}")
        self.kind, self.text, self.detail = kind, text, detail


@dataclass
class Verdict:
    """What became of a scene.

    Attributes
    ----------
    kind : str
        ``"ok"``, or a kind of `Fault`, or ``"time"`` or ``"crash"``, which only the process around
        can tell.
    text, detail : str
        As of `Fault`.
    measured : dict of str to float
        See `agreement.Agreement`.
    seconds : float
        Of processor time: what else the machine does is not counted.
    """

    kind: str = "ok"
    text: str = ""
    detail: str = ""
    measured: dict = field(default_factory=dict)
    seconds: float = 0.0


def judge(recipe, ask=Fault.KINDS, most=agreement.MOST, patience=agreement.PATIENCE):
    """Build a scene, render it and say what is wrong with it.

    Parameters
    ----------
    recipe : dict
        See `recipe.make_recipe`.
    ask : sequence of str
        Kinds of faults that are looked for; shrinking a scene asks only for its own.
    most, patience : int, float
        See `agreement.compare`.

    Returns
    -------
    Verdict
    """
    start = time.process_time()
    verdict = Verdict()
    try:
        _judge(recipe, ask, verdict, most, patience)
    except Fault as fault:
        verdict.kind, verdict.text, verdict.detail = fault.kind, fault.text, fault.detail
    verdict.seconds = time.process_time() - start
    return verdict


def _judge(recipe, ask, verdict, most, patience):
    scene = build(recipe)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.exr"
        with digests_of_scenes() as given:
            pictures = render(scene, path)
        written = channels_of(path)
    _check_passes(scene, pictures, written)
    _check_finite(pictures)
    slow = False
    if "not repeatable" in ask:
        scene = build(recipe)
        begun = time.process_time()
        with digests_of_scenes() as given_again:
            again = render(scene)
        slow = time.process_time() - begun > patience / 2.0
        # With a limit of time the clock decides how many samples there are.
        by_the_clock = scene.aplanat.render_time_limit > 0.0
        if given == given_again and not by_the_clock:
            _check_repeat(pictures, again)
        if slow and "disagrees" in ask:
            # The two more pictures that a comparison takes at least are more than it may take.
            verdict.measured = {"renders": 1, "undecided": 1.0}
            return
    if "disagrees" in ask:
        found = agreement.compare(scene, render, pictures, most, patience)
        verdict.measured = found.measured
        if found.fault:
            raise Fault("disagrees", found.fault)


def render(scene, path=None):
    """Render a scene as F12 does.

    Parameters
    ----------
    scene : bpy.types.Scene
    path : Path or None
        Where Blender writes a multilayer EXR of it.

    Returns
    -------
    dict of (str, str) to ndarray of shape (height, width, channels)
        By view layer and pass.

    Raises
    ------
    Fault
        If there is no picture.
    """
    import bpy

    if path is not None:
        settings = scene.render.image_settings
        settings.media_type = "MULTI_LAYER_IMAGE"
        settings.file_format = "OPEN_EXR_MULTILAYER"
        settings.color_depth = "32"
        scene.render.filepath = str(path)
        scene.render.use_file_extension = False
    with listen(keep_pictures=True) as heard:
        try:
            bpy.ops.render.render(write_still=path is not None, scene=scene.name)
        except RuntimeError as error:
            if heard.error is None:
                raise Fault("refused", f"by Blender: {error}") from error
    if heard.error is not None:
        kind = "refused" if isinstance(heard.error, AplanatError) else "traceback"
        detail = "".join(traceback.format_exception(heard.error))
        text = " ".join(f"{type(heard.error).__name__}: {heard.error}".split())
        raise Fault(kind, text, detail)
    return {
        (layer.layer, name): made.pixels
        for layer in heard.layers
        for name, made in layer.passes.items()
    }


def channels_of(path):
    """Return the names of all channels of an EXR file."""
    import OpenEXR

    if not path.is_file():
        raise Fault("no pass", "Blender wrote no file")
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return [name for part in file.parts for name in part.channels]


def expected_passes(layer):
    """Return the passes that the switches of a view layer ask for."""
    names = ["Combined"]
    names += [name for switch, name in LAYER_PASSES.items() if getattr(layer, switch)]
    names += [name for switch, name in OWN_PASSES.items() if getattr(layer.aplanat, switch)]
    for switch, name in CRYPTOMATTES.items():
        if getattr(layer, switch):
            count = math.ceil(layer.pass_cryptomatte_depth / 2)
            names += [f"{name}{i:02d}" for i in range(count)]
    return names


def _check_passes(scene, pictures, written):
    for layer in scene.view_layers:
        for name in expected_passes(layer):
            if (layer.name, name) not in pictures:
                raise Fault("no pass", f"'{name}' of view layer '{layer.name}' is not rendered")
            start = f"{layer.name}.{name}."
            if not any(channel.startswith(start) for channel in written):
                raise Fault("no pass", f"'{name}' of view layer '{layer.name}' is not in the file")


def _check_finite(pictures):
    for (layer, name), pixels in pictures.items():
        wrong = int((~np.isfinite(pixels)).any(axis=-1).sum())
        if wrong:
            raise Fault("not finite", f"{wrong} pixels of '{name}' of view layer '{layer}'")


def _check_repeat(first, second):
    if first.keys() != second.keys():
        raise Fault("not repeatable", "another render has other passes")
    for (layer, name), pixels in first.items():
        other = second[layer, name]
        if pixels.shape != other.shape or pixels.tobytes() != other.tobytes():
            largest = float(np.abs(pixels.astype(np.float64) - other).max())
            raise Fault(
                "not repeatable", f"'{name}' of view layer '{layer}' differs by up to {largest:.3g}"
            )
