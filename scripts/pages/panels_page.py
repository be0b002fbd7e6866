#!/usr/bin/env python3
"""Writes docs/reference/panels.md: our panels, which of EEVEE's are shown, and why not the others.

Usage: scripts/pages/panels_page.py

Run it again when a panel changes: a test compares the page with what this script writes, and fails
for a panel of Blender's that is not shown and has no reason here.
"""

import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPO))

PAGE = REPO / "docs" / "reference" / "panels.md"
TABS = {
    "render": "Render",
    "output": "Output",
    "view_layer": "View Layer",
    "scene": "Scene",
    "world": "World",
    "object": "Object",
    "data": "Data",
    "material": "Material",
    "": "3D view and others",
}
# By what the class name begins with, the longest that fits: our panel, or why there is none.
REASONS = {
    "RENDER_PT_eevee_sampling": "Aplanat's *Sampling*",
    "RENDER_PT_eevee_sampling_shadows": "*Light* has the switch; shadows have no steps to set",
    "RENDER_PT_eevee_clamping": "light is not clamped; bright spots become bokeh",
    "RENDER_PT_eevee_light_paths": "there is one path, from the light over a surface to the lens",
    "RENDER_PT_eevee_raytracing": "surfaces mirror lights and the world only",
    "RENDER_PT_eevee_screen_trace": "surfaces mirror lights and the world only",
    "RENDER_PT_eevee_denoise": "surfaces mirror lights and the world only",
    "RENDER_PT_eevee_gi_approximation": "no light from surface to surface",
    "RENDER_PT_eevee_depth_of_field": "the lens is the camera's: *Sampling* and *Bokeh*",
    "RENDER_PT_eevee_film": "Aplanat's *Film*",
    "RENDER_PT_eevee_hair": "hair is not drawn",
    "RENDER_PT_eevee_motion_blur": "motion blur is not drawn; a warning says so",
    "RENDER_PT_eevee_performance": "Aplanat's *Performance*",
    "RENDER_PT_eevee_volumes": "fog in boxes has no steps; other volumes are not drawn",
    "RENDER_PT_simplify": "Aplanat's *Simplify*, of what it follows",
    "SCENE_PT_eevee_light_probes": "light probes are not used",
    "VIEWLAYER_PT_eevee_layer_passes_data": "Aplanat's *Passes > Data*",
    "VIEWLAYER_PT_eevee_layer_passes_light": "light is not kept apart by kind",
    "VIEWLAYER_PT_layer_passes_aov": "shaders have no outputs of their own",
    "VIEWLAYER_PT_layer_passes_cryptomatte": "Aplanat's *Passes > Cryptomatte*",
    "VIEWLAYER_PT_filter": "Aplanat's *Filter*, of what it follows",
    "VIEWLAYER_PT_override": "Aplanat's *Override*, of what it follows",
    "EEVEE_WORLD_PT_lightprobe": "light probes are not used",
    "EEVEE_WORLD_PT_settings": "it has only what is listed below it",
    "EEVEE_WORLD_PT_sun": "the world's light is not turned into a sun",
    "EEVEE_WORLD_PT_mist": "no Mist pass",
    "EEVEE_WORLD_PT_volume": "the volume of a world is not drawn; a warning says so",
    "DATA_PT_EEVEE_light_distance": "lights have no limit",
    "DATA_PT_EEVEE_light_influence": "Aplanat's *Influence*, of what it follows",
    "DATA_PT_EEVEE_light_shadow": "in a panel of our own: nothing else of it is needed",
    "DATA_PT_lightprobe": "light probes are not used",
    "DATA_PT_context_lightprobe": "light probes are not used",
    "DATA_PT_preview": "no previews of lights",
    "DATA_PT_volume_render": "volume objects are not drawn; a warning says so",
    "OBJECT_PT_shading": "light linking and terminators are not followed; a warning says so",
    "OBJECT_PT_shadow_terminator": "shadows begin where triangles turn away",
    "MATERIAL_PT_preview": "no previews of materials",
    "EEVEE_MATERIAL_PT_settings": "Aplanat's *Settings*, of what it follows",
    "EEVEE_MATERIAL_PT_thickness": "glass is as thick as its mesh",
    "NODE_EEVEE_MATERIAL_PT_settings": "Aplanat's *Settings*, of what it follows",
    "VIEW3D_PT_shading_render_pass": "the viewport shows the picture; passes are in the render",
}
HEAD = """# Panels

Written by `scripts/pages/panels_page.py`: the panels that Blender shows with EEVEE, tab by tab,
and what stands there with Aplanat. A panel is shown where its settings are followed, or needed to
set things right; what is not followed is not shown. Panels of particles, physics and textures are
Blender's own for every engine.

Aplanat's own panels stand first; what their settings do is told in [quality](../quality.md),
[lenses](../lenses.md), [bokeh](../bokeh.md), [chromatic aberration](../chromatic-aberration.md),
[passes](../passes.md), [layers](../layers.md), [compositor](../compositor.md), and of each setting
in [settings](settings.md).

## Aplanat's own

"""
# Editors by their type, and what Blender calls the tabs of its properties.
EDITORS = {"IMAGE_EDITOR": "Image editor", "NODE_EDITOR": "Compositor", "VIEW_3D": "3D view"}


def reason(name):
    """Return why a panel of Blender's is not shown, or None."""
    fitting = [start for start in REASONS if name.startswith(start)]
    return REASONS[max(fitting, key=len)] if fitting else None


def panels():
    """Return EEVEE's panels by tab: class, and whether Aplanat shows it."""
    import bpy

    from addon.engine.render_engine import ENGINE_ID
    from addon.ui.panels.blender_panels import subclasses

    found = {tab: [] for tab in TABS}
    for panel in subclasses(bpy.types.Panel):
        engines = getattr(panel, "COMPAT_ENGINES", ())
        tab = getattr(panel, "bl_context", "")
        if "BLENDER_EEVEE" in engines and panel.__module__.startswith("bl_ui") and tab in found:
            found[tab].append((panel, ENGINE_ID in engines))
    return found


def own_panels():
    """Return Aplanat's panels: where each is found, and what it holds."""
    from addon.registration import _MODULES

    classes = [cls for module in _MODULES for cls in getattr(module, "CLASSES", ())]
    found = []
    for cls in classes:
        if "_PT_" not in cls.__name__ or cls.__name__.endswith("_presets"):
            continue
        editor = EDITORS.get(cls.bl_space_type) or TABS[cls.bl_context]
        found.append((" > ".join([editor, *path_of(cls)]), cls.__doc__.partition("\n")[0]))
    return found


def path_of(cls):
    """Return the names of a panel and of those that it stands in, the outermost first."""
    import bpy

    parent = getattr(cls, "bl_parent_id", "")
    above = path_of(getattr(bpy.types, parent)) if parent else []
    return [*above, cls.bl_label] if cls.bl_label else above


def write():
    """Return the text of the page; Aplanat must be registered."""
    rows = [f"| {place} | {text} |" for place, text in own_panels()]
    parts = [HEAD + "\n".join(["| panel | what it holds |", "| --- | --- |", *rows]) + "\n"]
    for tab, listed in panels().items():
        if not listed:
            continue
        rows = ["| panel | with Aplanat |", "| --- | --- |"]
        for panel, shown in sorted(listed, key=lambda item: item[0].__name__):
            label = getattr(panel, "bl_label", "") or "(head)"
            told = "shown" if shown else reason(panel.__name__)
            rows.append(f"| {label} (`{panel.__name__}`) | {told} |")
        parts.append(f"## {TABS[tab]}\n")
        parts.append("\n".join(rows) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    import addon

    addon.register()
    PAGE.write_text(write(), encoding="utf-8")
