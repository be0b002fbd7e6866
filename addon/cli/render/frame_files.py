"""The files of each frame: names, placeholders, and publishing of what Blender has written.

Blender writes into a held folder (`files.held_files`). What it wrote is then published under the
names that `-o` or the scene gives, and with it what the compositor's File Output nodes wrote.
"""

import os
import shutil
from contextlib import ExitStack
from pathlib import Path

import bpy

from ...engine.views import views_of
from ...errors import InputError, OutputError, UnfinishedFileError
from ...files.claims import Claims
from ...files.frame_path import frame_path
from ...files.held_files import HeldFiles, publish
from ...files.whole_file import check_writable
from ...files.whole_picture import is_whole_picture
from . import pictures
from .file_outputs import FileOutputs

_ROOM = "picture"
_ENDINGS = (".exr", ".png")


class FrameFiles:
    """Manages the files of a render for the duration of a `with` block.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its output settings are changed, and its File Output nodes are redirected.
    patterns : list of Path
        File names of `-o`; empty: the scene's own output.
    keeps_back : bool
        No file is published before `publish_all`.

    Raises
    ------
    InputError
        If the scene's own output is no picture file, or cannot be written.
    """

    def __init__(self, scene, patterns, keeps_back=False):
        render = scene.render
        self._scene = scene
        self._patterns = patterns
        self._overwrites, self._claims_frames = render.use_overwrite, render.use_placeholder
        self._filepath = render.filepath
        self._views_format = render.image_settings.views_format
        self._held = HeldFiles()
        self._nodes = FileOutputs(scene, self._held)
        self._claims = Claims()
        self._keeps_back = keeps_back
        # Held files and their destinations; moved aside before the next frame.
        self._kept = []
        self._moved = {}
        # Of the frame in progress.
        self._first = 0
        self._saves = bool(patterns) or render.save_output
        if not self._saves and not self._nodes:
            raise InputError(
                f"scene '{scene.name}' saves no output and has no File Output node; name a file"
                " with -o"
            )
        if not patterns and self._saves:
            self._check_scene_output()

    def __enter__(self):
        """Redirect Blender's output to the held folder."""
        with ExitStack() as stack:
            for part in (self._held, self._claims, self._nodes):
                stack.enter_context(part)
            self._stack = stack.pop_all()
        render = self._scene.render
        # Existing files are looked for under their real names.
        render.use_overwrite, render.use_placeholder = True, False
        render.save_output = self._saves
        render.filepath = str(self._held.room(_ROOM) / "frame_####")
        return self

    def __exit__(self, *error):
        """Drop the files that were not published, and remove their placeholders."""
        self._stack.__exit__(*error)

    def begin(self, frame):
        """Claim a frame, as the scene's *Overwrite* and *Placeholders* ask.

        Parameters
        ----------
        frame : int

        Returns
        -------
        bool
            False: its files exist, or another process has claimed them.

        Raises
        ------
        OutputError
            If a placeholder cannot be made.
        """
        paths = []
        for patterns in self._renders():
            self._set_format(patterns)
            paths += [real for _, real in self._pairs(frame, patterns)]
        missing = [path for path in paths if not os.path.exists(path)]
        # As in Blender: of several files, one that exists is enough.
        if not self._overwrites and len(missing) < len(paths):
            return False
        if not self._claims_frames:
            return True
        return self._claims.take(missing) or self._overwrites

    def render(self, frame, run):
        """Render a frame, once for each kind of file that Blender cannot write beside another.

        Parameters
        ----------
        frame : int
        run : callable
            Renders the frame, as an animation of one.

        Returns
        -------
        list
            What `run` returned each time.

        Raises
        ------
        OutputError
            If Blender did not write a file.
        """
        answers = []
        for patterns in self._renders():
            self._set_format(patterns)
            answers.append(run())
            self._take_pictures(frame, patterns)
        return answers

    def end(self):
        """Publish the files of the frame that was rendered, unless they are kept back.

        Returns
        -------
        files : list of Path
            Where they are, or will be.
        warnings : list of str
            About files that should have been written and were not.
        """
        written, warnings = self._nodes.found()
        for held, real in written:
            self._keep(held, real)
        files = list(dict.fromkeys(real for _, real in self._kept[self._first :]))
        if not self._keeps_back:
            self.publish_all()
        self._first = len(self._kept)
        self._moved.clear()
        return files, warnings

    def publish_all(self):
        """Publish every file that is kept back.

        Raises
        ------
        OutputError
            If one cannot be written.
        """
        for held, real in self._kept:
            # As Blender does for the scene's own output and for nodes; those of -o are there.
            try:
                real.parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                reason = error.strerror or error
                raise OutputError(f"cannot make folder '{real.parent}': {reason}") from error
            publish(held, real)
            self._claims.settle(real)
        for held in {held for held, _ in self._kept}:
            held.unlink()
        self._kept.clear()
        self._first = 0

    def _check_scene_output(self):
        scene = self._scene
        if scene.render.is_movie_format:
            raise InputError(
                f"scene '{scene.name}' is set to write a movie; name picture files with -o, such"
                " as -o frame_####.png"
            )
        try:
            folder = self._names(scene.frame_current, self._filepath)[0].parent
        except (RuntimeError, ValueError) as error:
            reason = " ".join(str(error).split()).removeprefix("Error: ")
            raise InputError(
                f"output path '{self._filepath}' of scene '{scene.name}': {reason}; name a file"
                " with -o"
            ) from error
        try:
            # As Blender does for the scene's own output path.
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"output folder '{folder}' of scene '{scene.name}' cannot be made"
                f" ({error.strerror}); name a file with -o"
            ) from error
        check_writable(folder / "frame")

    def _renders(self):
        """Return the patterns of `-o` in groups that one render serves."""
        exr, png = ([p for p in self._patterns if p.suffix.lower() == end] for end in _ENDINGS)
        if exr and png and self._scene.render.use_multiview:
            # Blender gives only the first view of a finished render.
            return [exr, png]
        return [self._patterns]

    def _set_format(self, patterns):
        if any(pattern.suffix.lower() == ".exr" for pattern in patterns):
            pictures.set_exr(self._scene, self._views_format)
        elif patterns:
            pictures.set_png(self._scene, self._views_format)

    def _pairs(self, frame, patterns):
        """Return the held files of the pictures of a frame, and their destinations."""
        if not self._saves:
            return []
        held = self._names(frame, str(self._held.room(_ROOM) / "frame_####"))
        if not patterns:
            return list(zip(held, self._names(frame, self._filepath), strict=True))
        suffixes = [view.file_suffix if view else "" for view in self._views_apart()]
        main = patterns[0].suffix.lower()
        if any(pattern.suffix.lower() == ".exr" for pattern in patterns):
            main = ".exr"
        pairs = []
        for pattern in patterns:
            path = frame_path(pattern, frame)
            if pattern.suffix.lower() != main:
                pairs.append((self._held.room(_ROOM) / "shown.png", path))
                continue
            for place, suffix in zip(held, suffixes, strict=True):
                pairs.append((place, path.with_name(f"{path.stem}{suffix}{path.suffix}")))
        return pairs

    def _names(self, frame, filepath):
        """Return Blender's names of the files of a frame, one for each view with its own."""
        render = self._scene.render
        before = render.filepath
        render.filepath = filepath
        try:
            names = [
                render.frame_path(frame=frame, view=view.name if view else "")
                for view in self._views_apart()
            ]
        finally:
            render.filepath = before
        return [Path(bpy.path.abspath(name)).absolute() for name in names]

    def _views_apart(self):
        """Return the views that have a file each; [None] where one file is enough."""
        render = self._scene.render
        if render.image_settings.views_format != "INDIVIDUAL":
            return [None]
        return [view and view.blender for view in views_of(None, self._scene)]

    def _take_pictures(self, frame, patterns):
        pairs = self._pairs(frame, patterns)
        shown = [held for held, _ in pairs if held.name == "shown.png"]
        if shown:
            pictures.set_png(self._scene, self._views_format)
            pictures.save_render_result(shown[0], self._scene)
        for held, real in pairs:
            self._keep(held, real)

    def _keep(self, held, real):
        if held not in self._moved:
            if not is_whole_picture(held):
                raise UnfinishedFileError(
                    f"cannot write '{real}': Blender wrote no whole file into '{held.parent}'; is"
                    " the disk full? TMPDIR names another place"
                )
            kept = self._held.room("kept") / str(len(self._kept))
            shutil.move(held, kept)
            self._moved[held] = kept
        self._kept.append((self._moved[held], real))
