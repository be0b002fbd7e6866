"""What nodes give is what Cycles gives: many in one picture, each on a card that glows with it."""

import numpy as np
import pytest

from benchmarks.nodes import image_cases, input_cases, pattern_cases, sheet, value_cases
from tests.pictures import render_aplanat, render_cycles, save_side_by_side

# In 1/255 of the sRGB encoded picture.
LARGEST_DIFFERENCE = 2.0

SHEETS = {
    "inputs": input_cases.CASES,
    "values": value_cases.CASES,
    "images": image_cases.CASES,
    "patterns": pattern_cases.CASES,
}


@pytest.mark.parametrize("name", SHEETS)
def test_nodes_agree_with_cycles(aplanat_bpy, tmp_path, name):
    cases = SHEETS[name]
    scene = sheet.build_sheet(aplanat_bpy, cases)
    ours = render_aplanat(scene, 1)
    cycles = render_cycles(scene, 1, "BLACKMAN_HARRIS", sheet.TINY_FILTER)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    assert np.isfinite(ours).all()
    found = sheet.compare(cases, ours, cycles)
    wrong = [
        f"{case.name}: {difference:.1f}"
        for case, difference in zip(cases, found, strict=True)
        if difference > LARGEST_DIFFERENCE
    ]
    assert not wrong, f"{tmp_path}\n" + "\n".join(wrong)


def test_a_wrong_number_is_found(aplanat_bpy):
    """The comparison is able to fail."""
    cases = value_cases.CASES[:4]
    scene = sheet.build_sheet(aplanat_bpy, cases)
    cycles = render_cycles(scene, 1, "BLACKMAN_HARRIS", sheet.TINY_FILTER)
    wrong = cycles.copy()
    # Of the second card, second from the left in the lowest row.
    wrong[-4, 11, :3] += 0.1
    assert [d > LARGEST_DIFFERENCE for d in sheet.compare(cases, wrong, cycles)] == [0, 1, 0, 0]


def test_the_docs_have_a_line_for_each_node(aplanat_bpy):
    from benchmarks.nodes.stated import STATED
    from benchmarks.tools.node_table import FIRST, LAST, PAGE, menu_nodes

    text = PAGE.read_text(encoding="utf-8").split(FIRST)[1].split(LAST)[0]
    lines = [line.split(" | ") for line in text.splitlines() if line.startswith("| ")][2:]
    nodes = menu_nodes(aplanat_bpy)
    labels = {n: getattr(aplanat_bpy.types, f"ShaderNode{n}").bl_rna.name for n in nodes}
    assert sorted(line[0].removeprefix("| ") for line in lines) == sorted(labels.values())
    tried = {case.node for cases in SHEETS.values() for case in cases}
    assert set(nodes) - {"MixRGB"} <= tried | set(STATED)
    assert not tried & set(STATED)
