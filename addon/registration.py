"""Registers the Blender-facing modules, in order; unregisters them in the reverse one."""

from .cli import blender_command
from .engine import render_engine
from .ui import (
    background,
    blender_panels,
    bokeh_panel,
    bokeh_presets,
    bokeh_previews,
    chromatic_curves,
    chromatic_operators,
    chromatic_panel,
    chromatic_presets,
    chromatic_previews,
    lens_import,
    lens_operators,
    lens_panel,
    lens_thumbnails,
    level_operators,
    overrides,
    panels,
    properties,
    sampling_panel,
    sampling_presets,
)

_MODULES = (
    background,
    lens_thumbnails,
    properties,
    overrides,
    render_engine,
    blender_panels,
    sampling_presets,
    level_operators,
    sampling_panel,
    panels,
    lens_operators,
    lens_import,
    lens_panel,
    bokeh_previews,
    bokeh_presets,
    bokeh_panel,
    chromatic_curves,
    chromatic_previews,
    chromatic_presets,
    chromatic_operators,
    chromatic_panel,
    blender_command,
)


def register():
    """Register all modules."""
    for module in _MODULES:
        module.register()


def unregister():
    """Unregister all modules, the last first."""
    for module in reversed(_MODULES):
        module.unregister()
