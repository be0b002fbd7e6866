#!/usr/bin/env python3
"""Draws the rooms of addon/ and one frame's way through them: docs/images/architecture.svg.

Usage: scripts/architecture_picture.py [-o FILE]

The rooms and their imports are those of ROOMS in tests/layering/test_imports.py, which the tests
hold the code to. A room imports rooms of lower rows only. Run it again when rooms change: a test
compares the picture with what this script draws.
"""

import argparse
import ast
from pathlib import Path
from xml.sax.saxutils import escape

REPO = Path(__file__).resolve().parents[1]
DRAWING = REPO / "tests" / "layering" / "test_imports.py"
PICTURE = REPO / "docs" / "images" / "architecture.svg"

# What each room of addon/ is for, and where its box lies in its row: first column, columns.
ROLES = {
    "ui": ("panels, properties, operators", 0, 6),
    "compositor": ("node groups, the sprite of a lens", 0, 3),
    "cli": ("the command line", 3, 3),
    "engine": ("plans, draws and shows a frame; what Blender calls", 0, 4.6),
    "capture": ("scenes as depth layers", 4.6, 1.4),
    "plots": ("drawings of lenses", 0, 1.15),
    "scene": ("reads Blender into a snapshot", 1.15, 2.2),
    "levels": ("levels of detail of meshes", 3.35, 1.2),
    "passes": ("GPU passes, a module each", 4.55, 1.45),
    "lens_io": ("lens files and importers, the lens library", 0, 3),
    "snapshot": ("the scene of one frame as frozen values", 3, 3),
    "lens_bokeh": ("the disc that a lens makes of a point of light", 0, 2.9),
    "settings": ("declarations, presets", 2.9, 1.4),
    "layers": ("depth layers as values and files", 4.3, 1.7),
    "files": ("whole files, caches", 0, 1.25),
    "optics": ("ray tracing, paraxial optics", 1.25, 1.75),
    "sampling": ("lens samples, thin lens, spectrum", 3, 1.75),
    "device": ("the only importer of gpu", 4.75, 1.25),
}

# One frame's way: the rooms in the order in which the snapshot of a scene meets them.
WALK = {
    "scene": "reads Blender's scene",
    "snapshot": "keeps it as values",
    "engine.planning": "makes the FramePlan",
    "levels": "hands out coarser meshes",
    "engine.frame": "goes sample by sample",
    "engine.bokeh": "draws the highlights",
    "engine.visibility": "finds what hides them",
    "engine.drawing": "draws the objects",
    "passes": "binds shader and targets",
    "device": "talks to the GPU",
}

COLORS = {
    "ui": "#e4e4e4",
    "cli": "#e4e4e4",
    "engine": "#e5dcf4",
    "scene": "#d9efd7",
    "passes": "#fde3c8",
    "device": "#fde3c8",
}
PLAIN = "#d8e7f8"

# All in px.
WIDTH, MARGIN, GAP = 960, 16, 10
COLUMN = (WIDTH - 2 * MARGIN + GAP) / 6
ROW, CHIP, BADGE = 90, 18, 8
STEP_HEIGHT, STEPS_A_ROW = 44, 5


def rooms(path=DRAWING):
    """Return the rooms of the layering test, each with those that it may import, bottom first."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "ROOMS":
            return eval(compile(ast.Expression(node.value), str(path), "eval"))
    raise SystemExit(f"{path} has no ROOMS.")


def top_level(drawing):
    """Return the imports between the folders that lie in addon/ itself."""
    found = {}
    for name, imports in drawing.items():
        folder = name.partition(".")[0]
        others = {other.partition(".")[0] for other in imports}
        found[folder] = found.get(folder, set()) | (others - {folder})
    return found


def ranks(imports):
    """Return the row of each room: one above the highest room that it imports."""
    rows = {}

    def rank(name):
        if name not in rows:
            rows[name] = 1 + max((rank(other) for other in imports[name]), default=-1)
        return rows[name]

    for name in imports:
        rank(name)
    return rows


class Drawing:
    """Collects the elements of an SVG picture."""

    def __init__(self):
        self.elements = []

    def box(self, x, y, width, height, fill, radius=6):
        """Add a rectangle."""
        self.elements.append(
            f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="{radius}" '
            f'fill="{fill}" stroke="#555" stroke-width="0.8"/>'
        )

    def text(self, x, y, words, size=12, weight="normal", fill="#222", anchor="start"):
        """Add a line of text that begins (or has its middle) at x."""
        self.elements.append(
            f'<text x="{x:g}" y="{y:g}" font-size="{size}" font-weight="{weight}" '
            f'fill="{fill}" text-anchor="{anchor}">{escape(words)}</text>'
        )

    def arrow(self, start, end):
        """Add an arrow between two points."""
        (x1, y1), (x2, y2) = start, end
        self.elements.append(
            f'<path d="M{x1:g} {y1:g} L{x2:g} {y2:g}" stroke="#777" stroke-width="1.2" '
            'fill="none" marker-end="url(#head)"/>'
        )

    def badge(self, x, y, number):
        """Add a numbered disc."""
        self.elements.append(f'<circle cx="{x:g}" cy="{y:g}" r="{BADGE}" fill="#b3261e"/>')
        self.text(x, y + 3.5, str(number), 10, "bold", "#fff", "middle")

    def svg(self, width, height):
        """Return the picture."""
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
            f'width="{width}" height="{height}" '
            'font-family="Helvetica, Arial, DejaVu Sans, sans-serif">'
        )
        marker = (
            '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" '
            'markerHeight="7" orient="auto"><path d="M0 0 L8 4 L0 8 z" fill="#777"/></marker>'
            "</defs>"
        )
        ground = f'<rect width="{width}" height="{height}" fill="#fff"/>'
        return "\n".join([head, marker, ground, *self.elements, "</svg>", ""])


def draw(drawing=None):
    """Return the picture of the rooms as the text of an SVG file."""
    drawing = rooms() if drawing is None else drawing
    imports = top_level(drawing)
    if set(imports) != set(ROLES):
        raise SystemExit(f"Give {sorted(set(imports) ^ set(ROLES))} a place in ROLES, or take it.")
    missing = [name for name in WALK if name not in drawing]
    if missing:
        raise SystemExit(f"{missing} of WALK are no rooms.")
    rows = ranks(imports)
    highest = max(rows.values())
    numbers = {name: number for number, name in enumerate(WALK, 1)}
    picture = Drawing()
    top = _steps(picture)
    picture.text(MARGIN, top, "The rooms of addon/: each imports from rows below", 13, "bold")
    for name, (role, column, columns) in ROLES.items():
        x, width = MARGIN + column * COLUMN, columns * COLUMN - GAP
        y = top + 12 + (highest - rows[name]) * (ROW + GAP)
        picture.box(x, y, width, ROW, COLORS.get(name, PLAIN))
        picture.text(x + 10, y + 20, name, 15, "bold")
        picture.text(x + 10, y + 36, role, 11, fill="#444")
        if name in numbers:
            picture.badge(x + width - BADGE - 5, y + BADGE + 6, numbers[name])
        inner = _inner(name, drawing)
        _chips(picture, name, inner, numbers, (x + 10, y + 43, width - 20))
        lines = _wrapped(sorted(imports[name]), int(width / 5.4))
        for number, line in enumerate(reversed(lines)):
            picture.text(x + 10, y + ROW - 7 - 11 * number, line, 9.5, fill="#666")
    return picture.svg(WIDTH, round(top + 12 + (highest + 1) * (ROW + GAP) - GAP + MARGIN))


def _steps(picture):
    """Draw one frame's way as numbered steps, in rows; return where the next part begins."""
    picture.text(
        MARGIN, MARGIN + 10, "One frame's way, from Blender's scene to the picture", 13, "bold"
    )
    width = (WIDTH - 2 * MARGIN + 22) / STEPS_A_ROW
    for number, (name, what) in enumerate(WALK.items()):
        line, place = divmod(number, STEPS_A_ROW)
        x, y = MARGIN + place * width, MARGIN + 22 + line * (STEP_HEIGHT + 12)
        picture.box(x, y, width - 22, STEP_HEIGHT, COLORS.get(name.partition(".")[0], PLAIN))
        picture.badge(x + 14, y + 15, number + 1)
        picture.text(x + 27, y + 19, name, 12, "bold")
        picture.text(x + 8, y + 36, what, 11, fill="#444")
        if place + 1 < STEPS_A_ROW:
            middle = y + STEP_HEIGHT / 2
            picture.arrow((x + width - 20, middle), (x + width - 2, middle))
    return y + STEP_HEIGHT + 34


def _wrapped(names, characters):
    """Return "imports a, b, ..." in lines of at most so many characters."""
    lines = ["imports " + names[0] if names else "imports nothing of these"]
    for name in names[1:]:
        if len(lines[-1]) + len(name) + 3 > characters:
            lines[-1] += ","
            lines.append(name)
        else:
            lines[-1] += f", {name}"
    return lines


def _inner(name, drawing):
    """Return the rooms inside a room; those inside one of them stand behind it in brackets."""
    inside = [room.split(".")[1:] for room in drawing if room.startswith(f"{name}.")]
    found = []
    for first in dict.fromkeys(parts[0] for parts in inside):
        deeper = ", ".join(parts[1] for parts in inside if parts[0] == first and parts[1:])
        found.append(f"{first} ({deeper})" if deeper else first)
    return found


def _chips(picture, room, inner, numbers, place):
    """Draw the rooms inside a room, in rows."""
    left, y, width = place
    x = left
    for name in inner:
        number = numbers.get(f"{room}.{name}")
        size = 6.0 * len(name) + 14 + (2 * BADGE + 2 if number else 0)
        if x + size > left + width:
            x, y = left, y + CHIP + 4
        picture.box(x, y, size, CHIP, "#fff", 9)
        picture.text(x + 8, y + 12.5, name, 10.5)
        if number:
            picture.badge(x + size - BADGE - 1, y + CHIP / 2, number)
        x += size + 6


def main():
    """Write the picture."""
    parser = argparse.ArgumentParser(
        prog="scripts/architecture_picture.py", description=__doc__.splitlines()[0]
    )
    parser.add_argument("-o", "--output", type=Path, default=PICTURE)
    arguments = parser.parse_args()
    arguments.output.write_text(draw(), encoding="utf-8")


if __name__ == "__main__":
    main()
