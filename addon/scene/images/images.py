"""Reads Blender's images into `ImageSnapshot`, each once as long as it does not change."""

import os
import threading
from dataclasses import dataclass
from functools import partial

import bpy
import numpy as np

from ...snapshot.content import ImageSnapshot, next_uid
from . import color_spaces
from .image_pixels import encode, load_file, read_pixels, reduced
from .tiles import load_tiles, tile_path

# Frames of these are chosen by the node that uses them.
ANIMATED = frozenset({"SEQUENCE", "MOVIE"})


@dataclass(frozen=True)
class ImageUse:
    """An image as a node uses it.

    Parameters
    ----------
    uid : int
        `ImageSnapshot.uid`.
    srgb : bool
        The texels are sRGB encoded.
    associated : bool
        Colour is multiplied by alpha, and some pixel's alpha is not 1.
    tiles : tuple of (int, int, float, float)
        UDIM tiles as `tiles.load_tiles` tells of them.
    """

    uid: int
    srgb: bool
    associated: bool
    tiles: tuple[tuple[float, ...], ...] = ()


@dataclass
class _Entry:
    signature: tuple
    use: ImageUse
    snapshot: ImageSnapshot
    notes: tuple


class ImageReader:
    """Reads images.

    Parameters
    ----------
    largest : int or None
        Texels along a side that the device can hold; larger images are averaged down.
    is_told : bool
        `note_change` is called when an image is painted on. If False, an unsaved image is read and
        compared in every round, because nothing reports its changes.
    still : bool
        Of an animated image one picture is read, whatever the frame: that of its file name, or the
        one that Blender holds of a movie.
    in_main_thread : callable or None
        Runs a function in the main thread and returns its result; for a reader that is used in
        another thread. Only the main thread can choose the frame of a movie, which all readers of
        the image share.

    Attributes
    ----------
    images : dict of int to ImageSnapshot
        Those read since `begin`.
    report : list of str
    is_told : bool
    """

    def __init__(self, largest=None, is_told=False, in_main_thread=None, still=False):
        self.images = {}
        self.report = []
        self._largest = largest
        self.is_told = is_told
        self._in_main_thread = in_main_thread
        self._still = still
        self._entries = {}
        self._seen = {}
        self._repaints = {}

    def begin(self):
        """Start a new round; images that the last round did not use are forgotten."""
        self._entries = {k: v for k, v in self._entries.items() if k in self._seen}
        self._seen = {}
        self.images = {}
        self.report = []

    def note_change(self, session_uid):
        """Note that an image's pixels have changed, as Blender reports of painted ones.

        Parameters
        ----------
        session_uid : int
        """
        self._repaints[session_uid] = self._repaints.get(session_uid, 0) + 1

    def read(self, image, image_user=None):
        """Return how to use an image, or None where it has no pixels.

        Parameters
        ----------
        image : bpy.types.Image
        image_user : bpy.types.ImageUser or None
            Chooses the frame of a sequence or movie.

        Returns
        -------
        ImageUse or None
        """
        image = image.original
        frame = image_user.frame_current if image_user and image.source in ANIMATED else 0
        key = (image.session_uid, frame)
        if key in self._seen:
            return self._seen[key]
        use = self._seen[key] = self._read(key, image, image_user, frame)
        if use is None:
            where = f" ({image.filepath})" if image.filepath else ""
            self.report.append(f"image '{image.name_full}'{where} cannot be read; drawn in magenta")
        else:
            entry = self._entries[key]
            self.images[use.uid] = entry.snapshot
            self.report += [f"image '{image.name_full}': {note}" for note in entry.notes]
        return use

    def computed(self, key, name, compute):
        """Return how to use an image that is computed, once as long as a reader uses it.

        Parameters
        ----------
        key : hashable
            All that the pixels depend on.
        name : str
        compute : callable
            Returns pixels of shape (height, width, 4), float32, scene linear.

        Returns
        -------
        ImageUse
        """
        if key not in self._seen:
            entry = self._entries.get(key)
            if entry is None:
                snapshot = ImageSnapshot(next_uid(), name, compute())
                use = ImageUse(snapshot.uid, srgb=False, associated=False)
                entry = self._entries[key] = _Entry(key, use, snapshot, ())
            self._seen[key] = entry.use
            self.images[entry.use.uid] = entry.snapshot
        return self._seen[key]

    def _read(self, key, image, image_user, frame):
        repaints = self._repaints.get(image.session_uid, 0)
        signature = (repaints, *_signature(image, image_user, frame))
        entry = self._entries.get(key)
        unchanged = entry and entry.signature == signature
        if unchanged and (self.is_told or not image.is_dirty):
            return entry.use
        places = ()
        if image.source == "TILED" and len(image.tiles) > 1:
            pixels, places = load_tiles(image)
        if places:
            as_stored, notes = True, []
        else:
            pixels, as_stored, notes = self._pixels(image, image_user, frame)
        if pixels is None:
            self._entries.pop(key, None)
            return None
        if image.source == "TILED" and len(image.tiles) > max(len(places), 1):
            read = len(places) or "only the first"
            notes.append(f"of its {len(image.tiles)} UDIM tiles {read} can be read")
        pixels, srgb, associated, more = encode(pixels, image, as_stored)
        notes += more
        pixels = self._fitting(pixels, notes)
        if (
            entry
            and entry.use.srgb == srgb
            and entry.use.associated == associated
            and entry.use.tiles == places
            and entry.snapshot.pixels.dtype == pixels.dtype
            and np.array_equal(entry.snapshot.pixels, pixels)
        ):
            entry.signature, entry.notes = signature, tuple(notes)
            return entry.use
        snapshot = ImageSnapshot(next_uid(), image.name, pixels, srgb)
        use = ImageUse(snapshot.uid, srgb, associated, places)
        self._entries[key] = _Entry(signature, use, snapshot, tuple(notes))
        return use

    def _pixels(self, image, image_user, frame):
        """Return pixels, whether they are as the file stores them, and notes."""
        if image.source == "SEQUENCE" and not image.packed_file and image_user is not None:
            return load_file(image.filepath_from_user(image_user=image_user)), True, []
        if self._still and image.source == "SEQUENCE" and not image.packed_file:
            return load_file(bpy.path.abspath(image.filepath, library=image.library)), True, []
        if self._still or image.source not in ANIMATED:
            return read_pixels(image), False, []
        if threading.current_thread() is threading.main_thread():
            return _read_frame(image, frame), False, []
        if self._in_main_thread is not None:
            return self._in_main_thread(partial(_read_frame, image, frame)), False, []
        return (
            read_pixels(image),
            False,
            ["the frame of a movie cannot be chosen here; the frame shown last is used"],
        )

    def _fitting(self, pixels, notes):
        """Return pixels that the device can hold."""
        height, width = pixels.shape[:2]
        if self._largest is None or max(height, width) <= self._largest:
            return pixels
        small = reduced(pixels, self._largest)
        notes.append(
            f"its {width} x {height} pixels are more than the graphics device holds"
            f" ({self._largest} a side); it is drawn in {small.shape[1]} x {small.shape[0]}"
        )
        return small


def _read_frame(image, frame):
    """Read a frame of a movie, in the main thread, so that nothing else changes the frame."""
    # The only way to choose the frame; it needs the thread that may draw.
    image.gl_load(frame=frame)
    return read_pixels(image)


def _file_state(path):
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return None
    return status.st_mtime_ns, status.st_size


def _signature(image, image_user, frame):
    stat = ()
    if image.source in {"FILE", "SEQUENCE", "TILED", "MOVIE"} and not image.packed_file:
        try:
            path = image.filepath_from_user(image_user=image_user)
            status = os.stat(path)
            stat = (status.st_mtime_ns, status.st_size)
        except (OSError, ValueError):
            stat = ("absent",)
    if image.source == "TILED" and not image.packed_files:
        stat += tuple(_file_state(tile_path(image, tile.number)) for tile in image.tiles)
    generated = ()
    if image.source == "GENERATED":
        generated = (image.generated_type, *image.generated_color, image.generated_width)
    return (
        frame,
        image.source,
        image.filepath,
        image.alpha_mode,
        image.colorspace_settings.name,
        color_spaces.working_space(),
        image.is_dirty,
        tuple(image.size) if image.source not in ANIMATED else (),
        image.packed_file.size if image.packed_file else 0,
        generated,
        stat,
    )
