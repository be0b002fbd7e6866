"""The scenes that `aplanat bench` measures, ready to be rendered as their references were."""

from dataclasses import dataclass
from pathlib import Path

from addon.cli.render.scene_setup import check_camera, load_scene, use_engine
from addon.errors import InputError, UnfinishedFileError
from addon.files.whole_file import check_writable, whole_file

from ..referees.shared_scenes import is_shared_name, shared_references, shared_scene


@dataclass(frozen=True)
class Case:
    """A scene to measure.

    Parameters
    ----------
    name : str
        As it was asked for.
    file : Path
    samples : int
        Lens samples of the reference method.
    references : dict of str to Path
        Pictures to compare with, by kind: ``lens``, ``pinhole``.
    """

    name: str
    file: Path
    samples: int
    references: dict[str, Path]

    @property
    def stem(self):
        """The name in names of files."""
        return Path(self.name).stem


def find_cases(arguments, console, default_samples, samples_of=()):
    """Return the scenes that were asked for.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of `bench`.
    console : Console
    default_samples : int
        Where none were asked for.
    samples_of : dict of str to int
        The same for certain shared scenes.

    Returns
    -------
    list of Case

    Raises
    ------
    InputError
        If there is no such scene or reference.
    """
    words = arguments.scene or ["toys"]
    defaults = {word: dict(samples_of).get(word, default_samples) for word in words}
    return [_case(word, arguments, console, defaults[word]) for word in words]


def _case(word, arguments, console, default_samples):
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
    return Case(word, file, arguments.samples or default_samples, references)


def check_folder(path):
    """Refuse a folder for pictures that is not there, or that takes none."""
    if path:
        check_writable(path / "picture.exr")


def open_scene(case, resolution):
    """Load a scene and set it up as its references were rendered.

    Parameters
    ----------
    case : Case
    resolution : tuple of 2 int

    Returns
    -------
    bpy.types.Scene
    """
    scene = load_scene(case.file)
    use_engine(scene)
    check_camera(scene)
    scene.render.resolution_x, scene.render.resolution_y = resolution
    scene.render.resolution_percentage = 100
    scene.aplanat.pixel_filter = "BOX"
    scene.render.filter_size = 1.0
    return scene


def save_picture(path, picture):
    """Write a picture as EXR.

    Parameters
    ----------
    path : Path
    picture : ndarray of shape (height, width, 3)
        Scene linear, top row first.
    """
    import numpy as np
    import OpenEXR

    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    with whole_file(path) as place:
        try:
            OpenEXR.File(header, {"RGB": np.ascontiguousarray(picture, np.float32)}).write(place)
        except RuntimeError as error:
            raise UnfinishedFileError(f"cannot write '{path}': {error}") from error
