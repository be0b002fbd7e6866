"""A captured picture that follows its settings: refined piece by piece, begun anew by a change.

Pieces are small, so that whoever draws them between other work never waits long; the picture is
shown after the first set of lens samples, and then from time to time until it has them all. Rays
through a real lens are traced by a thread; the picture before stays until they are.
"""

import time
from concurrent.futures import ThreadPoolExecutor

from ...device import context as device_context
from ...device import state
from ...errors import FocusError
from ...lens_io import profile_cache
from ..frame.pacing import Pacer
from .refocusing import Refocusing, nothing, planned_frame

# Lens samples of the first picture that is worth a look.
FIRST_SAMPLES = 16
# Seconds of a piece, and between two pictures that are shown. A single sample may take longer.
PIECE_SECONDS = 0.04
SHOWN_SECONDS = 0.15
# Seconds without a change after which the draft of the bokeh is replaced by the whole one.
REST_SECONDS = 0.2


class LivePicture:
    """A stack of layers on the device, and the picture of it that is being refined.

    Nothing is on the device before the first piece, or after `release`.

    Parameters
    ----------
    stack : LayerStack

    Attributes
    ----------
    settings : RefocusSettings or None
        That the picture is made with.
    """

    def __init__(self, stack):
        self.stack = stack
        self.settings = None
        self._refocusing = None
        self._pacer = Pacer(PIECE_SECONDS)
        self._shown, self._shown_at, self._finished = 0, 0.0, False
        self._changed_at = 0.0
        self._content = nothing()
        # What is being planned, and the thread that does it, there while there is a real lens.
        self._plan = self._thread = None

    @property
    def is_planned(self):
        """Whether the next `refine` will draw, and not wait for rays through the lens."""
        return self._plan is None or self._plan[1].done()

    @property
    def samples_done(self):
        """Lens samples of the picture so far."""
        return self._refocusing.samples_done if self._refocusing else 0

    @property
    def finished(self):
        """Whether the picture has all its samples, and was handed out."""
        return self._finished

    @property
    def report(self):
        """Warnings about settings that cannot be met, as a tuple of str."""
        return tuple(self._refocusing.report) if self._refocusing else ()

    def change(self, settings):
        """Restart the picture with the next piece if the settings differ.

        Parameters
        ----------
        settings : RefocusSettings
        """
        if settings != self.settings:
            self.settings, self._changed_at = settings, time.perf_counter()
            self.show_again()

    def show_again(self):
        """Return the picture again at the next `refine`, though it has not changed."""
        self._shown, self._finished = 0, False

    def refine(self):
        """Draw some lens samples more.

        Returns
        -------
        ndarray of shape (height, width, 4) or None
            Scene linear, premultiplied, bottom row first; None if there is nothing new that is
            worth a look.

        Raises
        ------
        AplanatError
            If the settings cannot form a picture, or the device has no room for it.
        """
        if self._finished:
            return None
        try:
            return self._piece()
        except FocusError:
            # Nothing has begun with such a lens.
            self._plan = None
            raise
        except BaseException:
            # Nobody knows how far it went.
            self.release()
            raise

    def _piece(self):
        if self._is_drawn:
            # Others were asked for in between.
            self._plan = None
        elif not self._is_ready():
            return None
        device_context.ensure_context()
        with state.preserved():
            if not self._is_drawn:
                self._begin()
            refocusing = self._refocusing
            if not refocusing.sampled:
                # The first picture is no later than it must, and a change waits for a piece only.
                self._pacer.samples = min(self._pacer.samples, FIRST_SAMPLES)
                self._advance(refocusing)
            if refocusing.bokeh_drafted and self._rests():
                refocusing.refine_bokeh()
            self._finished = refocusing.finished
            if not (self._finished or self._is_worth_a_look(refocusing.samples_done)):
                return None
            picture = refocusing.read()
        self._shown, self._shown_at = refocusing.samples_done, time.perf_counter()
        return picture

    @property
    def _is_drawn(self):
        """Whether the picture on the device is of these settings."""
        return self._refocusing is not None and self._refocusing.settings == self.settings

    def _is_ready(self):
        """Whether the picture can begin; where rays are to be traced, that is begun."""
        if self.settings.real_lens is None:
            self._plan = None
            return True
        if self._plan is not None and self._plan[1].done():
            if self._plan[0] == self.settings:
                return True
            # Settings have changed since: those of now are next.
            self._plan = None
        if self._plan is None:
            self._thread = self._thread or ThreadPoolExecutor(1, "lens")
            found = self._thread.submit(_planned, self.stack, self.settings, self._content)
            self._plan = self.settings, found
        return False

    def _begin(self):
        if self._plan is not None:
            planned, self._plan = self._plan[1].result(), None
        else:
            planned = planned_frame(self.stack, self.settings, self._content)
        if self._refocusing is None:
            self._refocusing = Refocusing(self.stack, self.settings, drafts=True, planned=planned)
        else:
            self._refocusing.change(self.settings, planned)

    def _advance(self, refocusing):
        start, before = time.perf_counter(), refocusing.samples_done
        refocusing.advance(self._pacer.samples)
        self._pacer.measured(refocusing.samples_done - before, time.perf_counter() - start)

    def _rests(self):
        """Whether a first picture is shown, and settings have stayed for a while."""
        return self._shown > 0 and time.perf_counter() - self._changed_at >= REST_SECONDS

    def _is_worth_a_look(self, samples):
        if samples < min(FIRST_SAMPLES, self.settings.samples):
            return False
        return self._shown == 0 or time.perf_counter() - self._shown_at >= SHOWN_SECONDS

    def read(self):
        """Return the picture as it is so far, as `refine`; there must have been one."""
        device_context.ensure_context()
        with state.preserved():
            return self._refocusing.read()

    def release(self):
        """Release everything on the device; the next piece begins anew."""
        self.show_again()
        self._plan = None
        if self._thread:
            self._thread.shutdown(wait=False, cancel_futures=True)
            self._thread = None
        if self._refocusing:
            self._refocusing.release()
            self._refocusing = None


def _planned(stack, settings, content):
    """Plan a picture through a real lens, and have what its discs need in the cache."""
    planned = planned_frame(stack, settings, content)
    lens = planned[0].camera.real_lens
    if settings.bokeh is not None and lens.shapes_bokeh:
        profile_cache.pupil_tables(lens.prescription, lens.label, lens_id=lens.id)
    return planned
