#!/usr/bin/env python3
"""Writes docs/reference/settings.md from the declarations in addon/settings.

Usage: scripts/pages/settings_page.py

Run it again when a setting changes: a test compares the page with what this script writes.
"""

import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPO))

from addon.settings.bokeh_settings import BOKEH  # noqa: E402  (after the path is set)
from addon.settings.chromatic_settings import CHROMATIC  # noqa: E402
from addon.settings.refocus_settings import DEPTH_PASS, REFOCUS  # noqa: E402
from addon.settings.scene_part_settings import (  # noqa: E402
    ABERRATIONS,
    DISTORTION,
    LAMP,
    LENS,
    MATERIAL,
    WORLD,
)
from addon.settings.scene_settings import CAPTURE, SCENE, VIEW_LAYER  # noqa: E402

PAGE = REPO / "docs" / "reference" / "settings.md"
# By what it starts with in Python.
PARTS = {
    "scene.aplanat": ("Scene", SCENE),
    "scene.aplanat.capture": ("Capture of depth layers", (CAPTURE,)),
    "scene.aplanat.refocus": ("Refocused picture of a scene", (REFOCUS, DEPTH_PASS)),
    "view_layer.aplanat": ("View layer", VIEW_LAYER),
    "camera.data.aplanat": ("Camera", (LENS, ABERRATIONS, DISTORTION)),
    "camera.data.aplanat.bokeh": ("Bokeh of a camera", BOKEH),
    "camera.data.aplanat.chromatic": ("Chromatic aberration of a camera", CHROMATIC),
    "material.aplanat": ("Material", (MATERIAL,)),
    "light.aplanat": ("Light", (LAMP,)),
    "world.aplanat": ("World", (WORLD,)),
}
HEAD = """# All settings

Written by `scripts/pages/settings_page.py` from the declarations that Blender's properties, the
readers, the command line and the statistics follow, too. *Kept* settings are those that presets
set; of a camera also those that it remembers for each real lens. The last column is the key in
`settings` of `--stats` that tells the setting, or what came of it; see
[command-line.md](../command-line.md).
"""


def number(value):
    """Return a number as a person writes it."""
    return f"{value:,}" if isinstance(value, int) else f"{value:g}"


def values(setting):
    """Return what a setting can be."""
    if isinstance(setting.default, bool):
        return "on, off"
    if setting.items:
        return ", ".join(f"`{item.identifier}`" for item in setting.items)
    if isinstance(setting.default, str):
        return "text"
    if setting.default is None:
        return "a data-block"
    least, most = setting.limits
    if most is None:
        return f"{number(least)} and more"
    return f"{number(least)} to {number(most)}"


def default(setting):
    """Return the default as a person writes it."""
    value = setting.default
    if isinstance(value, bool):
        return "on" if value else "off"
    if value is None or value == "":
        return "none"
    return f"`{value}`" if isinstance(value, str) else number(value)


def meaning(setting):
    """Return the tooltip, with those of the choices."""
    told = [setting.description, *(f"*{item.label}*: {item.description}" for item in setting.items)]
    return ". ".join(told) + "."


def row(setting):
    """Return a setting's line in the table."""
    cells = (
        setting.label,
        f"`{setting.name}`",
        values(setting),
        default(setting),
        meaning(setting) + (" *Kept.*" if setting.kept else ""),
        f"`{setting.told}`" if setting.told else "",
    )
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def write():
    """Return the text of the page."""
    parts = [HEAD]
    for path, (title, sections) in PARTS.items():
        parts.append(f"## {title}: `{path}`\n")
        for section in sections:
            if len(sections) > 1:
                parts.append(f"### {section.title}\n")
            parts.append(f"*{section.place}*\n")
            lines = [
                "| setting | in Python | values | default | meaning | told as |",
                "| --- | --- | --- | --- | --- | --- |",
                *map(row, section.settings),
            ]
            parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(write(), encoding="utf-8")
