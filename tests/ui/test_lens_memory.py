"""What a camera remembers for each real lens: kept through files and copies, and never harmful."""

import pytest

from addon.ui.properties.bokeh_properties import APPEARANCE_NAMES
from addon.ui.properties.chromatic_properties import SETTING_NAMES
from addon.ui.properties.lens_memory import values_of

TESSAR, PLANAR = "tessar-50mm-f2.8", "planar-50mm-f1.4"
# By group: what belongs to a lens, and three choices of it.
GROUPS = {
    "bokeh": (
        APPEARANCE_NAMES,
        {"hardness": 0.5, "onion": 0.0, "vignetting": "LENS"},
        {"hardness": 0.5, "onion": 0.25, "vignetting": "NONE"},
        {"hardness": -0.5, "onion": 0.5, "vignetting": "ANALYTIC"},
    ),
    "chromatic": (
        SETTING_NAMES,
        {"use": True, "axial": 2.0, "glass": "N-BK7", "mode": "SPECTRAL"},
        {"use": True, "axial": 4.0, "glass": "F2", "mode": "RGB"},
        {"use": False, "axial": 0.5, "glass": "N-SF11", "mode": "RGB"},
    ),
}
# Texts that are no such memory, or one of another version.
DAMAGES = {
    "bokeh": (
        "{",
        "[]",
        '{"": 3}',
        '{"": {"vignetting": "X", "grain": "x", "dust": 99999999999}}',
    ),
    "chromatic": ("{", "[]", '{"": 3}', '{"": {"mode": "NO_MODE", "axial": "x", "glass": 3}}'),
}


@pytest.fixture(params=GROUPS)
def which(request):
    return request.param


@pytest.fixture
def group(camera, which):
    return getattr(camera.aplanat, which)


def set_all(group, values):
    for name, value in values.items():
        setattr(group, name, value)


def test_each_lens_has_its_own_and_a_new_one_takes_over_what_is_there(camera, group, which):
    names, thin, tessar, planar = GROUPS[which]
    set_all(group, thin)
    camera.aplanat.lens = TESSAR
    assert values_of(group, thin) == thin
    set_all(group, tessar)
    of_tessar = values_of(group, names)
    camera.aplanat.lens = PLANAR
    set_all(group, planar)
    of_planar = values_of(group, names)
    camera.aplanat.lens = TESSAR
    assert values_of(group, names) == of_tessar
    camera.aplanat.lens_choice = f"lens:{PLANAR}"
    assert values_of(group, names) == of_planar
    camera.aplanat.lens = ""
    assert values_of(group, thin) == thin
    # The second time nothing changes hands.
    camera.aplanat.lens = TESSAR
    camera.aplanat.lens = TESSAR
    assert values_of(group, names) == of_tessar


def test_what_belongs_to_the_camera_stays(camera):
    bokeh = camera.aplanat.bokeh
    bokeh.threshold = 2.0
    camera.aplanat.lens = TESSAR
    bokeh.threshold = 3.0
    camera.aplanat.lens = ""
    assert bokeh.threshold == 3.0


def test_it_is_saved_and_copied(camera, group, which, aplanat_bpy, tmp_path):
    bpy = aplanat_bpy
    _, thin, tessar, _ = GROUPS[which]
    set_all(group, thin)
    camera.aplanat.lens = TESSAR
    set_all(group, tessar)
    copy = camera.copy()
    copy.aplanat.lens = ""
    assert values_of(getattr(copy.aplanat, which), thin) == thin
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    loaded = bpy.data.cameras["Camera"].aplanat
    assert values_of(getattr(loaded, which), tessar) == tessar
    loaded.lens = ""
    assert values_of(getattr(loaded, which), thin) == thin


def test_a_damaged_memory_does_no_harm(camera, group, which):
    _, thin, _, _ = GROUPS[which]
    for damage in DAMAGES[which]:
        setattr(camera.aplanat, f"{which}_memory", damage)
        set_all(group, thin)
        camera.aplanat.lens = TESSAR if camera.aplanat.lens == "" else ""
        assert values_of(group, thin) == thin
