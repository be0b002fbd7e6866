"""The File Output nodes of a scene's compositor, and the files that they write.

Blender writes them in place while it renders. Here each writes into a held folder instead
(`files.held_files`), which tells what it wrote and lets its files appear whole or not at all.
"""

import os
import re
from pathlib import Path

import bpy

from ...errors import OutputError
from ...files.whole_file import check_writable
from .pictures import uses_compositor

# Variables of a path that may begin it and stand for an absolute folder.
_LEADING_FOLDER = re.compile(r"\{blend_dir(_lib)?\}")


class FileOutputs:
    """The nodes of a scene that write files, redirected while a `with` block lasts.

    Parameters
    ----------
    scene : bpy.types.Scene
    held : HeldFiles
    """

    def __init__(self, scene, held):
        self._held = held
        self._nodes = []
        if uses_compositor(scene):
            self._nodes = list(_nodes(scene.compositing_node_group, set()))
        self._before = []
        # Reasons why the files of a node cannot be written, by the node's number.
        self._lost = {}

    def __enter__(self):
        """Redirect the nodes."""
        places = [_absolute(node) for node in self._nodes]
        for number, (folder, _) in enumerate(places):
            try:
                _check_folder(folder)
            except OutputError as error:
                self._lost[number] = str(error)
        self._before = [(node.directory, node.file_name) for node in self._nodes]
        for number, (node, (folder, name)) in enumerate(zip(self._nodes, places, strict=True)):
            node.directory = self._held.stand_in(_room(number), folder)
            node.file_name = name
        return self

    def __exit__(self, *_):
        """Restore the folders of the nodes."""
        for node, (folder, name) in zip(self._nodes, self._before, strict=True):
            node.directory, node.file_name = folder, name

    def __bool__(self):
        """Whether there is a node that writes."""
        return any(_writes(node) for node in self._nodes)

    def found(self):
        """Return what the nodes have written.

        Returns
        -------
        files : list of (Path, Path)
            Held file and destination of each.
        warnings : list of str
            One for each node that should have written and has not.
        """
        files, warnings = [], []
        for number, node in enumerate(self._nodes):
            if not _writes(node):
                continue
            written = self._held.found(_room(number))
            told = f"File Output node '{node.name}' of '{node.id_data.name}'"
            if number in self._lost:
                # Where the scene comes from, the folder may have been there: no reason to refuse
                # the rest of the picture.
                warnings.append(f"{told}: {self._lost[number]}; its files are left out")
            elif not written:
                warnings.append(
                    f"{told} wrote no file; check its folder and file name: a {{variable}} in them"
                    " may be unknown"
                )
            else:
                files += written
        return files, warnings


def _room(number):
    return f"node{number}"


def _nodes(tree, seen):
    """Yield the File Output nodes of a tree and of the groups in it, each tree once."""
    if tree is None or tree in seen:
        return
    seen.add(tree)
    for node in tree.nodes:
        if node.mute:
            continue
        if node.type == "OUTPUT_FILE":
            yield node
        elif node.type == "GROUP":
            yield from _nodes(node.node_tree, seen)


def _writes(node):
    return any(socket.is_linked for socket in node.inputs)


def _absolute(node):
    """Return a node's folder as an absolute path that ends with a slash, and its file name."""
    name = node.file_name
    folder = _LEADING_FOLDER.sub(_blend_folder, node.directory, count=1)
    if not _LEADING_FOLDER.match(node.directory):
        folder = bpy.path.abspath(folder) if folder else os.path.sep
    above, slash, last = name.replace("\\", "/").rpartition("/")
    if ".." in above.split("/"):
        # Would lead out of the stand-in.
        folder, name = f"{folder}/{above}", last
    # Blender takes a folder without // from where the process is.
    return os.path.join(os.path.abspath(folder), ""), name


def _blend_folder(_match):
    return os.path.dirname(bpy.data.filepath)


def _check_folder(folder):
    known = folder.partition("{")[0]
    existing = Path(known)
    # The root of a drive that is missing is its own parent.
    while not os.path.exists(existing) and existing != existing.parent:
        existing = existing.parent
    check_writable(existing / "frame")
