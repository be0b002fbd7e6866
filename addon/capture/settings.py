"""Settings of a capture; values without Blender."""

import hashlib
import json
from dataclasses import asdict, dataclass

from ..settings.scene_settings import CAPTURE
from ..settings.setting import settings_of

ENGINES = ("CYCLES", "BLENDER_EEVEE", "APLANAT")
_DECLARED = settings_of(CAPTURE)
DEFAULT_LAYERS = _DECLARED["layers"].default
DEFAULT_OVERSCAN = _DECLARED["overscan"].default
_, MOST_LAYERS = _DECLARED["layers"].limits
_, MOST_OVERSCAN = _DECLARED["overscan"].limits


@dataclass(frozen=True)
class CaptureSettings:
    """How a frame is captured.

    Parameters
    ----------
    engine : str
        One of `ENGINES`.
    layers : int
        Besides the world's.
    overscan : float
        Share of the picture's width and height that is rendered on each side besides.
    resolution : tuple of 2 int or None
        Width and height in pixels; None: the scene's.
    """

    engine: str = "CYCLES"
    layers: int = DEFAULT_LAYERS
    overscan: float = DEFAULT_OVERSCAN
    resolution: tuple[int, int] | None = None

    def digest(self, frame, source, software):
        """Return a hash of these settings, the frame, and versions of source and software.

        Parameters
        ----------
        frame : int
        source, software : str
            `capture_files.source_digest` of the scene, and `shot_capture.software`.

        Returns
        -------
        str
        """
        told = {"settings": asdict(self), "frame": frame, "source": source, "software": software}
        return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()
