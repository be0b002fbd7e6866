"""Blender's images to `ImageSnapshot`.

Pixels are kept as Cycles keeps them, so that interpolation gives the same values: 8-bit pixels stay
8-bit and in their own encoding, and colour is multiplied by alpha in that encoding.
"""

import os
import threading
from dataclasses import dataclass

import numpy as np

from . import color_spaces
from .snapshot import ImageSnapshot, next_uid

# Frames of these are chosen by the node that uses them.
_ANIMATED = frozenset({"SEQUENCE", "MOVIE"})


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
    """

    uid: int
    srgb: bool
    associated: bool


@dataclass
class _Entry:
    signature: tuple
    use: ImageUse
    snapshot: ImageSnapshot


class ImageReader:
    """Reads images, each once for as long as it does not change.

    Attributes
    ----------
    images : dict of int to ImageSnapshot
        Those read since `begin`.
    report : list of str
    """

    def __init__(self):
        self.images = {}
        self.report = []
        self._entries = {}
        self._seen = {}

    def begin(self):
        """Start a new round; what the last one did not use is forgotten."""
        self._entries = {k: v for k, v in self._entries.items() if k in self._seen}
        self._seen = {}
        self.images = {}
        self.report = []

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
        frame = image_user.frame_current if image_user and image.source in _ANIMATED else 0
        key = (image.session_uid, frame)
        if key in self._seen:
            return self._seen[key]
        use = self._seen[key] = self._read(key, image, image_user, frame)
        if use is None:
            where = f" ({image.filepath})" if image.filepath else ""
            self.report.append(f"image '{image.name}'{where} cannot be read; drawn in magenta")
        else:
            self.images[use.uid] = self._entries[key].snapshot
        return use

    def _read(self, key, image, image_user, frame):
        signature = _signature(image, frame)
        entry = self._entries.get(key)
        if entry and entry.signature == signature and not image.is_dirty:
            self._report_source(image)
            return entry.use
        pixels = self._pixels(image, image_user, frame)
        if pixels is None:
            self._entries.pop(key, None)
            return None
        self._report_source(image)
        pixels, srgb, associated = self._encode(image, pixels)
        if (
            entry
            and entry.use.srgb == srgb
            and entry.use.associated == associated
            and entry.snapshot.pixels.dtype == pixels.dtype
            and np.array_equal(entry.snapshot.pixels, pixels)
        ):
            entry.signature = signature
            return entry.use
        snapshot = ImageSnapshot(next_uid(), image.name, pixels, srgb)
        self._entries[key] = _Entry(signature, ImageUse(snapshot.uid, srgb, associated), snapshot)
        return self._entries[key].use

    def _report_source(self, image):
        if image.source == "TILED" and len(image.tiles) > 1:
            self.report.append(
                f"image '{image.name}' has {len(image.tiles)} UDIM tiles; only the first is drawn"
            )

    def _pixels(self, image, image_user, frame):
        if image.source == "SEQUENCE" and not image.packed_file and image_user is not None:
            return _load_file(image.filepath_from_user(image_user=image_user))
        if image.source in _ANIMATED:
            if threading.current_thread() is threading.main_thread():
                # The only way to choose the frame; it needs the thread that may draw.
                image.gl_load(frame=frame)
            else:
                self.report.append(
                    f"image '{image.name}': the frame of a movie cannot be chosen while the user"
                    " interface renders; the frame shown last is used (render in the background)"
                )
        width, height = image.size
        if width == 0 or height == 0 or image.channels == 0:
            return None
        pixels = np.empty(width * height * image.channels, np.float32)
        if len(image.pixels) != pixels.size:
            return None
        image.pixels.foreach_get(pixels)
        pixels = _with_four_channels(pixels.reshape(height, width, image.channels))
        if not image.is_float:
            # Exact: these are bytes over 255.
            return np.rint(pixels * 255.0).astype(np.uint8)
        return pixels

    def _encode(self, image, pixels):
        space = image.colorspace_settings.name
        working = color_spaces.working_space()
        is_byte = pixels.dtype == np.uint8
        data = space in color_spaces.DATA_SPACES
        # Cycles reads files itself; what is packed, painted or generated it takes from Blender,
        # which keeps 8-bit pixels straight and float pixels multiplied, and trusts the mode.
        from_file = image.source != "GENERATED" and not image.packed_file and not image.is_dirty
        straight = image.alpha_mode == "STRAIGHT"
        if from_file:
            straight = is_byte
        if image.alpha_mode == "NONE":
            pixels = pixels.copy()
            pixels[..., 3] = 255 if is_byte else 1.0
        srgb = False
        # Blender converts float images when it loads them.
        if is_byte and not data and space != working:
            srgb = space == color_spaces.SRGB and working == color_spaces.REC709
            if not srgb:
                converted = color_spaces.convert(pixels.astype(np.float32) / 255.0, space, working)
                if converted is None:
                    self.report.append(
                        f"image '{image.name}': colour space '{space}' is not known;"
                        " it is read as sRGB"
                    )
                    srgb = True
                else:
                    pixels = converted
        opaque = bool((pixels[..., 3] == (255 if pixels.dtype == np.uint8 else 1.0)).all())
        associated = not (opaque or data or image.alpha_mode in {"NONE", "CHANNEL_PACKED"})
        if associated and straight:
            pixels = _associate(pixels)
        return pixels, srgb, associated


def _signature(image, frame):
    stat = ()
    if image.source in {"FILE", "SEQUENCE", "TILED", "MOVIE"} and not image.packed_file:
        try:
            status = os.stat(image.filepath_from_user())
            stat = (status.st_mtime_ns, status.st_size)
        except (OSError, ValueError):
            stat = ("absent",)
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
        tuple(image.size) if image.source not in _ANIMATED else (),
        image.packed_file.size if image.packed_file else 0,
        generated,
        stat,
    )


def _load_file(path):
    import imbuf

    try:
        buffer = imbuf.load(path)
        with buffer.with_buffer() as view:
            pixels = np.array(view)
        buffer.free()
    except (OSError, ValueError, RuntimeError):
        return None
    return _with_four_channels(pixels)


def _with_four_channels(pixels):
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    out = np.full((*pixels.shape[:2], 4), 255 if pixels.dtype == np.uint8 else 1.0, pixels.dtype)
    out[..., :3] = pixels[..., :3] if channels >= 3 else pixels[..., :1]
    if channels == 2:
        out[..., 3] = pixels[..., 1]
    return out


def _associate(pixels):
    alpha = pixels[..., 3:]
    out = pixels.copy()
    if pixels.dtype == np.uint8:
        # Rounded down, as Cycles does.
        out[..., :3] = (pixels[..., :3].astype(np.uint16) * alpha) // 255
    else:
        out[..., :3] *= alpha
    return out
