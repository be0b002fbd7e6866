"""Counts and warnings of the last picture of each scene, for the panels."""

import threading
from collections import OrderedDict
from dataclasses import dataclass, field, replace

_MOST_SCENES = 64


@dataclass(frozen=True)
class Findings:
    """What a picture lacks, for *Render > Report*.

    Parameters
    ----------
    warnings : tuple of str
        As `report.frame_report` returns them.
    error : str
        Why there is no picture, in one line; empty if there is one.
    levels : float
        Share of its levels of detail that are made, 0 to 1.
    """

    warnings: tuple[str, ...] = ()
    error: str = ""
    levels: float = 1.0


@dataclass(frozen=True)
class PictureNote:
    """Counts and warnings of the last picture of a scene.

    Parameters
    ----------
    counts : dict of str to int or None
        As `HighlightCounts` has them; None where no highlights were searched.
    thresholds : tuple of 2 float or None
        The least and the largest automatic threshold of highlights; None where there was none.
    problems : tuple of str
        Warnings, as in `FrameRenderer.report`.
    fates : dict of str to int
        Numbers of highlight sources, as in `FrameRenderer.fates`.
    sampling : SamplingReport or None
        Samples and error that were reached.
    viewport, render : Findings or None
        Of the viewport and of the final render; None where there was none yet.
    """

    counts: dict | None = None
    thresholds: tuple | None = None
    problems: tuple = ()
    fates: dict = field(default_factory=dict)
    sampling: object = None
    viewport: Findings | None = None
    render: Findings | None = None


class PictureNotes:
    """`PictureNote` by scene; safe to use from the main thread and the render thread."""

    def __init__(self):
        self._notes = OrderedDict()
        self._has_news = False
        self._lock = threading.Lock()

    def note(self, scene, renderer):
        """Store the counts and warnings of a picture, finished or not.

        Parameters
        ----------
        scene : bpy.types.Scene
        renderer : FrameRenderer
        """
        counts = dict(vars(renderer.highlights)) if renderer.highlights else None
        self.change(
            scene,
            counts=counts,
            thresholds=renderer.thresholds,
            problems=renderer.report,
            fates=dict(renderer.fates),
            sampling=renderer.sampling,
        )

    def change(self, scene, **values):
        """Replace fields of the `PictureNote` of a scene."""
        number = scene.original.session_uid
        with self._lock:
            before = self._notes.get(number, PictureNote())
            after = self._notes[number] = replace(before, **values)
            if (before.viewport, before.render) != (after.viewport, after.render):
                self._has_news = True
            self._notes.move_to_end(number)
            while len(self._notes) > _MOST_SCENES:
                self._notes.popitem(last=False)

    def of(self, scene):
        """Return the `PictureNote` of a scene."""
        with self._lock:
            return self._notes.get(scene.original.session_uid, PictureNote())

    def take_news(self):
        """Return whether any scene's `Findings` have changed since the last call."""
        with self._lock:
            news, self._has_news = self._has_news, False
            return news
