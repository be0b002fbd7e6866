"""Cloth, hair, toon and rough surfaces are lit about as Cycles lights them."""

import pytest

from benchmarks.nodes import spheres
from tests.pictures import render_aplanat, render_cycles, save_side_by_side


@pytest.mark.parametrize("light", ["world", "sun"])
def test_spheres_of_each_closure_look_as_in_cycles(aplanat_bpy, tmp_path, light):
    """Within what the table of the docs says of each; see there why they differ."""
    cases = spheres.CASES
    scene = spheres.build_spheres(aplanat_bpy, cases, light == "sun")
    ours = render_aplanat(scene, 1)
    cycles = render_cycles(scene, 32, "BLACKMAN_HARRIS", 0.01, bounces=2)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    found = spheres.compare(cases, ours, cycles)
    wrong = [
        f"{case.name}: {difference:.1f}"
        for case, difference in zip(cases, found, strict=True)
        if difference > getattr(case, light)
    ]
    assert not wrong, f"{tmp_path}\n" + "\n".join(wrong)
