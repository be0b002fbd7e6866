"""Registers the Blender-facing modules, in order; unregisters them in the reverse one."""

from .cli import blender_command
from .engine import render_engine, shared_resources
from .ui.focus import focus_gizmo, focus_operators, focus_overlay, focus_panels
from .ui.jobs import background, live_refocus, report_redraw
from .ui.operators import (
    capture_operator,
    chromatic_curves,
    chromatic_operators,
    compositor_operators,
    lens_import,
    lens_operators,
    level_operators,
    refocus_operators,
    refocus_writing,
    report_operators,
)
from .ui.panels import (
    aberration_panel,
    blender_panels,
    bokeh_panel,
    capture_panel,
    chromatic_panel,
    compositor_panel,
    lens_browser_panel,
    lens_panel,
    panel_order,
    refocus_panel,
    render_panels,
    report_panel,
    sampling_panel,
)
from .ui.presets import preset_menus
from .ui.previews import aberration_previews, bokeh_previews, chromatic_previews, lens_thumbnails
from .ui.properties import data_block_properties, migrations, overrides

_MODULES = (
    shared_resources,
    background,
    lens_thumbnails,
    data_block_properties,
    overrides,
    migrations,
    render_engine,
    blender_panels,
    preset_menus,
    level_operators,
    report_redraw,
    report_operators,
    report_panel,
    sampling_panel,
    render_panels,
    lens_operators,
    lens_import,
    lens_panel,
    lens_browser_panel,
    aberration_previews,
    aberration_panel,
    bokeh_previews,
    bokeh_panel,
    chromatic_curves,
    chromatic_previews,
    chromatic_operators,
    chromatic_panel,
    panel_order,
    capture_operator,
    capture_panel,
    live_refocus,
    refocus_operators,
    refocus_writing,
    refocus_panel,
    focus_operators,
    focus_overlay,
    focus_gizmo,
    focus_panels,
    compositor_operators,
    compositor_panel,
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
