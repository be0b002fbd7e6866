"""The GPU context: making sure there is one, and its name."""

import os
import signal
import sys
import time
import warnings

from ..errors import DeviceUnavailableError
from . import keeping

_ADVICE = (
    "install a graphics driver, or Mesa's software one with EGL"
    " (Debian: libegl1 and libgl1-mesa-dri), and start Blender again"
)


def ensure_context():
    """Make sure that this thread can draw.

    Raises
    ------
    DeviceUnavailableError
        If Blender has no graphics backend, with what to install.
    """
    import gpu

    if not _has_backend() and not _survives_initialisation():
        raise DeviceUnavailableError(
            f"no GPU context (Blender finds no graphics driver); {_ADVICE}"
        )
    try:
        if hasattr(gpu, "init"):
            gpu.init()
        backend = gpu.platform.backend_type_get()
    except (SystemError, RuntimeError) as error:
        raise DeviceUnavailableError(f"no GPU context ({error}); {_ADVICE}") from error
    if backend in {"NONE", "UNKNOWN"}:
        raise DeviceUnavailableError(f"no GPU context (backend {backend}); {_ADVICE}")
    keeping.own()


def _has_backend():
    import gpu

    try:
        return gpu.platform.backend_type_get() not in {"NONE", "UNKNOWN"}
    except SystemError:
        return False


# Time limit of the probe: a hundred times what the slowest software driver took.
_PROBE_SECONDS = 20.0


def _survives_initialisation():
    """Whether a copy of this process can initialise the GPU.

    Blender dies of a segmentation fault where it finds no driver in the background, so the first
    attempt is made by a forked child. Only Linux: forking is unsafe elsewhere.
    """
    if sys.platform != "linux":
        return True
    with warnings.catch_warnings():
        # The child only initialises the GPU and ends; a deadlock would end at the time limit.
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        _initialise_and_exit()
    end = time.monotonic() + _PROBE_SECONDS
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return not os.WIFSIGNALED(status)
        time.sleep(0.005)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return True


def _initialise_and_exit():
    import gpu

    try:
        # The child's crash report and the driver's messages must not reach the user.
        signal.signal(signal.SIGSEGV, signal.SIG_DFL)
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        gpu.init()
    finally:
        os._exit(0)


def device_name():
    """Return backend and renderer, for statistics."""
    import gpu

    return f"{gpu.platform.backend_type_get()}: {gpu.platform.renderer_get()}"


def is_software():
    """Return whether the processor draws in place of a graphics device."""
    import gpu

    return gpu.platform.device_type_get() == "SOFTWARE"


def max_texture_size():
    """Return the largest width and height of a texture, in texels."""
    import gpu

    return gpu.capabilities.max_texture_size_get()
