"""Compare every shader node with Cycles and write the table of docs/surfaces.md.

    python -m benchmarks.tools.node_table          # print it
    python -m benchmarks.tools.node_table --write  # into the docs

Each node's cases (`benchmarks.nodes`) glow on cards that both engines draw; a node is exact where
the displayed pictures differ by 2/255 at most. Closures are compared on spheres, as means.
"""

import argparse
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))

PAGE = REPOSITORY / "docs" / "surfaces.md"
FIRST, LAST = "<!-- nodes: written by benchmarks/tools/node_table.py -->", "<!-- end of nodes -->"
EXACT_UP_TO = 2.0


def menu_nodes(bpy):
    """Return the types of shader nodes that Blender has, without ``ShaderNode``."""
    from benchmarks.nodes.stated import NOT_IN_THE_MENU

    found = (name.removeprefix("ShaderNode") for name in dir(bpy.types) if _is_shader_node(name))
    return sorted(name for name in found if name not in NOT_IN_THE_MENU)


def _is_shader_node(name):
    return name.startswith("ShaderNode")


def measured(bpy):
    """Return the largest difference of each measured node, in 1/255, by type.

    Parameters
    ----------
    bpy : module
        With Aplanat registered.

    Returns
    -------
    dict of str to (float, int)
        Difference, and number of cases.
    """
    from benchmarks.nodes import image_cases, input_cases, pattern_cases, sheet, value_cases
    from benchmarks.referees.plain_pictures import aplanat_picture, cycles_picture

    found = {}
    for module in (input_cases, value_cases, image_cases, pattern_cases):
        cases = module.CASES
        scene = sheet.build_sheet(bpy, cases)
        ours, cycles = aplanat_picture(scene), cycles_picture(scene, sheet.TINY_FILTER)
        _add(found, cases, sheet.compare(cases, ours, cycles))
    return found


def lit(bpy):
    """Return the mean difference of each closure on lit spheres, in 1/255, by type.

    Parameters
    ----------
    bpy : module
        With Aplanat registered.

    Returns
    -------
    dict of str to (float, int)
        Largest mean of a sphere, and number of spheres.
    """
    from benchmarks.nodes import spheres
    from benchmarks.referees.plain_pictures import aplanat_picture, cycles_picture

    found = {}
    for sun in (False, True):
        scene = spheres.build_spheres(bpy, spheres.CASES, sun)
        ours = aplanat_picture(scene)
        cycles = cycles_picture(scene, 0.01, samples=64, bounces=2)
        _add(found, spheres.CASES, spheres.compare(spheres.CASES, ours, cycles))
    return found


def _add(found, cases, differences):
    """Add cases to the worst difference and the number of each node's."""
    for case, difference in zip(cases, differences, strict=True):
        worst, count = found.get(case.node, (0.0, 0))
        found[case.node] = max(worst, difference), count + 1


def table(bpy):
    """Return the lines of the table and the number of nodes by status."""
    from benchmarks.nodes.stated import APPROXIMATE, EXACT, LIMITS, STATED

    differences, means = measured(bpy), lit(bpy)
    rows, counts = [], {}
    for name in menu_nodes(bpy):
        if name in differences:
            worst, cases = differences[name]
            status = EXACT if worst <= EXACT_UP_TO else APPROXIMATE
            note = LIMITS.get(name, "")
            number = f"{worst:.1f} ({cases})"
        else:
            status, note = STATED.get(name, ("fallback", "not read"))
            number = "mean {:.1f} ({})".format(*means[name]) if name in means else ""
        counts[status] = counts.get(status, 0) + 1
        label = getattr(bpy.types, f"ShaderNode{name}").bl_rna.name
        rows.append((label, f"| {label} | {status} | {number} | {note} |"))
    lines = ["| node | drawn | 1/255 (cases) | but |", "| --- | --- | --- | --- |"]
    lines += [line for _, line in sorted(rows)]
    return lines, counts


def main(words=None):
    """Print the table, or write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="into docs/surfaces.md")
    options = parser.parse_args(words)
    import bpy

    import addon

    addon.register()
    lines, counts = table(bpy)
    total = sum(counts.values())
    drawn = total - counts.get("fallback", 0)
    summary = (
        f"Of {total} nodes {counts.get('exact', 0)} are exact, {counts.get('approximate', 0)}"
        f" approximate, {counts.get('fallback', 0)} have a stated fallback:"
        f" {100 * drawn / total:.0f} % are drawn."
    )
    print("\n".join(lines))
    print(summary)
    if options.write:
        text = PAGE.read_text(encoding="utf-8")
        before, rest = text.split(FIRST)
        after = rest.split(LAST)[1]
        block = "\n".join([FIRST, "", summary, "", *lines, "", LAST])
        PAGE.write_text(before + block + after, encoding="utf-8")


if __name__ == "__main__":
    main()
