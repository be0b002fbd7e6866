"""The GPU context: making sure there is one, and its name."""

from ..errors import DeviceUnavailableError

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

    try:
        if hasattr(gpu, "init"):
            gpu.init()
        backend = gpu.platform.backend_type_get()
    except (SystemError, RuntimeError) as error:
        raise DeviceUnavailableError(f"no GPU context ({error}); {_ADVICE}") from error
    if backend in {"NONE", "UNKNOWN"}:
        raise DeviceUnavailableError(f"no GPU context (backend {backend}); {_ADVICE}")


def device_name():
    """Return backend and renderer, for statistics."""
    import gpu

    return f"{gpu.platform.backend_type_get()}: {gpu.platform.renderer_get()}"


def max_texture_size():
    """Return the largest width and height of a texture, in texels."""
    import gpu

    return gpu.capabilities.max_texture_size_get()
