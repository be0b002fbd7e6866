"""`aplanat bench`: what a lens sample costs against a pinhole pass, and how good the picture is.

Times of one run on one machine make ratios; by themselves they mean little. Each scene is rendered
twice, without depth of field and with it, and each picture is compared with its reference.
"""

import math
from dataclasses import dataclass
from pathlib import Path

from ..device.context import ensure_context
from ..errors import InputError
from ..files.whole_file import check_writable, removed_on_signals
from . import statistics
from .json_file import write_json
from .picture_metrics import compare, read_picture
from .render import heard_render
from .scene_setup import check_camera, load_scene, use_engine
from .shared_scenes import is_shared_name, shared_references, shared_scene

_DEFAULT_SAMPLES = 512
# Small bright lights in strong blur need more.
_SAMPLES_OF = {"christmas_tree": 2048}
# Enough for the edges of a pinhole picture.
_PINHOLE_SAMPLES = 256
# Short renders of both kinds take turns, and the middle one of their ratios counts: other work of
# the machine then touches both alike.
_COST_ROUNDS = 5
_COST_SAMPLES = 32


@dataclass(frozen=True)
class _Case:
    name: str
    file: Path
    samples: int
    references: dict[str, Path]


def bench(arguments, console):
    """Carry out `aplanat bench`.

    Parameters
    ----------
    arguments : argparse.Namespace
    console : Console

    Returns
    -------
    dict
        What `--json` prints.

    Raises
    ------
    AplanatError
        If a scene cannot be rendered or compared.
    """
    with removed_on_signals():
        if arguments.output:
            check_writable(arguments.output)
        if arguments.pictures and not arguments.pictures.is_dir():
            raise InputError(f"--pictures: folder '{arguments.pictures}' does not exist")
        cases = [_case(word, arguments, console) for word in arguments.scene or ["toys"]]
        runs = [_run(case, arguments, console) for case in cases]
        answer = {"command": "bench", **statistics.machine(), "runs": runs}
        for run in runs:
            console.say(_line(run))
        if arguments.output:
            write_json(arguments.output, answer)
    return answer


def _case(word, arguments, console):
    samples = arguments.samples or _SAMPLES_OF.get(word, _DEFAULT_SAMPLES)
    if arguments.reference and len(arguments.scene) != 1:
        raise InputError("--reference belongs to one scene; give exactly one --scene with it")
    if arguments.reference and not arguments.reference.is_file():
        raise InputError(f"reference picture '{arguments.reference}' does not exist")
    if is_shared_name(word) and not Path(word).exists():
        file = shared_scene(word, arguments.look, console)
        references = shared_references(word, arguments.look)
    else:
        file, references = Path(word), {}
    if arguments.reference:
        references = {"lens": arguments.reference}
    return _Case(word, file, samples, references)


def _run(case, arguments, console):
    scene = load_scene(case.file)
    use_engine(scene)
    check_camera(scene)
    scene.render.resolution_x, scene.render.resolution_y = arguments.resolution
    scene.render.resolution_percentage = 100
    # What the references were rendered with.
    scene.aplanat.pixel_filter = "BOX"
    scene.render.filter_size = 1.0
    ensure_context()
    uses_lens = scene.camera.data.dof.use_dof
    measured = {}
    for kind, samples in (("pinhole", min(_PINHOLE_SAMPLES, case.samples)), ("lens", case.samples)):
        heard = _render(
            scene, uses_lens and kind == "lens", samples, f"{case.name}, {kind}", console
        )
        measured[kind] = _measure(case, kind, heard, arguments)
    settings = statistics.settings_in_force(scene)
    return {
        "scene": case.name,
        "settings": settings,
        "cost_of_sample_in_pinhole_passes": _cost_of_sample(scene, uses_lens, case, console),
        **measured,
    }


def _cost_of_sample(scene, uses_lens, case, console):
    ratios = []
    for number in range(_COST_ROUNDS):
        seconds = []
        for use_dof in (False, uses_lens):
            label = f"{case.name}, cost {number + 1}/{_COST_ROUNDS}"
            heard = _render(scene, use_dof, min(_COST_SAMPLES, case.samples), label, console)
            seconds.append(heard.statistics.seconds["draw"])
        ratios.append(seconds[1] / seconds[0])
    return sorted(ratios)[len(ratios) // 2]


def _render(scene, use_dof, samples, label, console):
    scene.camera.data.dof.use_dof = use_dof
    scene.aplanat.method = "REFERENCE"
    scene.aplanat.render_samples = samples
    return heard_render(
        keep_pictures=True, progress=lambda _, text: console.progress(f"{label}: {text}")
    )


def _measure(case, kind, heard, arguments):
    work = statistics.work(heard.statistics)
    drawing = work["seconds"].get("draw", 0.0)
    picture = heard.layers[0].passes["Combined"].pixels[::-1, :, :3]
    if arguments.pictures:
        _save(arguments.pictures / f"{Path(case.name).stem}_{kind}.exr", picture)
    reference = case.references.get(kind)
    return {
        "samples_per_second": work["lens_samples"] / drawing if drawing else math.inf,
        "seconds_per_sample": drawing / work["lens_samples"],
        **work,
        "reference": str(reference) if reference else None,
        "compared": compare(picture, read_picture(reference)) if reference else None,
    }


def _save(path, picture):
    import numpy as np
    import OpenEXR

    from ..files.whole_file import whole_file

    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    with whole_file(path) as place:
        OpenEXR.File(header, {"RGB": np.ascontiguousarray(picture)}).write(place)


def _line(run):
    lens, compared = run["lens"], run["lens"]["compared"]
    text = (
        f"{run['scene']}: {lens['lens_samples']} samples, {lens['samples_per_second']:.1f} a"
        f" second, a sample costs {run['cost_of_sample_in_pinhole_passes']:.3f} pinhole passes"
    )
    if compared:
        text += (
            f"; SSIM {compared['ssim_srgb']:.4f}, worst tile {compared['ssim_tile']:.4f}, energy"
            f" {compared['energy']:.4f}"
        )
        pinhole = run["pinhole"]["compared"]
        if pinhole:
            text += f"; pinhole SSIM {pinhole['ssim_srgb']:.4f}"
    return text
