"""`aplanat bench`: what a lens sample costs against a pinhole pass, and how good the picture is.

Times of one run on one machine make ratios; by themselves they mean little. Each scene is rendered
twice, without depth of field and with it, and each picture is compared with its reference.
"""

import math

from addon.cli.render import statistics
from addon.cli.render.render_command import heard_render
from addon.cli.words.json_file import write_json
from addon.device.context import ensure_context
from addon.files.whole_file import check_writable, removed_on_signals
from addon.scene.camera.camera import CameraSources

from ..referees.picture_metrics import compare, read_picture
from .scenes import check_folder, find_cases, open_scene, save_picture

_RESOLUTION = (480, 270)
_DEFAULT_SAMPLES = 512
# Small bright lights in strong blur need more.
_SAMPLES_OF = {"christmas_tree": 2048}
# Enough for the edges of a pinhole picture.
_PINHOLE_SAMPLES = 256
# Short renders of both kinds take turns, and the middle one of their ratios counts: other work of
# the machine then touches both alike.
_COST_ROUNDS = 5
_COST_SAMPLES = 32


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
        check_folder(arguments.pictures)
        cases = find_cases(arguments, console, _DEFAULT_SAMPLES, _SAMPLES_OF)
        runs = [_run(case, arguments, console) for case in cases]
        answer = {"command": "bench", **statistics.machine(), "runs": runs}
        for run in runs:
            console.say(_line(run))
        if arguments.output:
            write_json(arguments.output, answer)
    return answer


def _run(case, arguments, console):
    scene = open_scene(case, arguments.resolution or _RESOLUTION)
    ensure_context()
    uses_lens = scene.camera.data.dof.use_dof
    measured = {}
    for kind, samples in (("pinhole", min(_PINHOLE_SAMPLES, case.samples)), ("lens", case.samples)):
        heard = _render(
            scene, uses_lens and kind == "lens", samples, f"{case.name}, {kind}", console
        )
        measured[kind] = _measure(case, kind, heard, arguments)
    settings = statistics.settings_in_force(scene, CameraSources())
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
        save_picture(arguments.pictures / f"{case.stem}_{kind}.exr", picture)
    reference = case.references.get(kind)
    return {
        "samples_per_second": work["lens_samples"] / drawing if drawing else math.inf,
        "seconds_per_sample": drawing / work["lens_samples"],
        **work,
        "reference": str(reference) if reference else None,
        "compared": compare(picture, read_picture(reference)) if reference else None,
    }


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
