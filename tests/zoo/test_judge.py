"""That the judge sees what is wrong with a scene, and nothing where nothing is."""

import numpy as np
import pytest

from addon.engine import final_render
from addon.engine.frame.pipeline import FrameRenderer
from benchmarks.zoo import agreement
from benchmarks.zoo.judge import Fault, judge
from benchmarks.zoo.scenes.script import build

PLAIN = {
    "scene": {"render.resolution_x": 8, "render.resolution_y": 6},
    "materials": {"m0": {"tree": {"Surface": {"node": "ShaderNodeEmission"}}}},
    "objects": [{"kind": "MESH", "materials": ["m0"], "set": {"location": [0.0, 6.0, 0.0]}}],
    "camera": {"set": {"dof.use_dof": True, "dof.focus_distance": 3.0, "dof.aperture_fstop": 0.5}},
    "layers": [{"set": {"use_pass_z": True}}],
    "settings": {
        "render.engine": "APLANAT",
        "aplanat.use_target_error": False,
        "aplanat.render_samples": 8,
    },
}


def changed_pictures(monkeypatch, change):
    """Have the engine's pictures go through a function of their names and pixels."""
    original = FrameRenderer.read_passes

    def read(self, names):
        return {name: change(name, pixels) for name, pixels in original(self, names).items()}

    monkeypatch.setattr(FrameRenderer, "read_passes", read)


def test_a_sound_scene_passes(aplanat_bpy):
    verdict = judge(PLAIN, most=3)
    assert (verdict.kind, verdict.text) == ("ok", "")
    assert verdict.measured["renders"] == 3


def test_an_error_of_the_engine_is_a_traceback(aplanat_bpy, monkeypatch):
    def broken(snapshot):
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr(final_render, "plan_frame", broken)
    verdict = judge(PLAIN)
    assert verdict.kind == "traceback"
    assert "ZeroDivisionError: by nothing" in verdict.text
    assert "in broken" in verdict.detail


def test_a_refused_scene_is_a_fault(aplanat_bpy):
    verdict = judge({**PLAIN, "camera": {"set": {"type": "PANO"}}})
    assert verdict.kind == "refused"
    assert "CameraError" in verdict.text


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_pixel_that_is_no_number_is_seen(aplanat_bpy, monkeypatch, value):
    def spoil(name, pixels):
        pixels[1, 1] = value if name == "Depth" else pixels[1, 1]
        return pixels

    changed_pictures(monkeypatch, spoil)
    verdict = judge(PLAIN)
    assert verdict.kind == "not finite"
    assert "1 pixels of 'Depth'" in verdict.text


def test_a_picture_that_differs_by_a_bit_is_seen(aplanat_bpy, monkeypatch):
    rng = np.random.default_rng(1)

    def shake(name, pixels):
        return np.nextafter(pixels, np.float32(2.0)) if rng.random() < 0.5 else pixels

    changed_pictures(monkeypatch, shake)
    assert judge(PLAIN, ("not repeatable",)).kind == "not repeatable"


def test_a_pass_that_is_missing_is_seen(aplanat_bpy, monkeypatch):
    monkeypatch.setattr("addon.scene.extract.read_passes", lambda layer: ("Combined",))
    verdict = judge(PLAIN)
    assert verdict.kind == "no pass"
    assert "'Depth'" in verdict.text


@pytest.fixture
def scene(aplanat_bpy):
    return build(PLAIN)


def pictures_of(bias, noise, channel=0, shared=0.0):
    """A renderer of grey pictures; those of the scene's own method are biased in a channel.

    The noise of each picture is its own, and more that both methods have with the same seed.
    """

    def render(scene):
        own = scene.aplanat.method == "ADAPTIVE"
        alone = np.random.default_rng([scene.aplanat.seed, 5, own]).standard_normal()
        common = np.random.default_rng([scene.aplanat.seed, 6]).standard_normal()
        pixels = np.full((20, 20, 4), 0.5) * (1.0 + noise * alone + shared * common)
        pixels[..., 3] = 1.0
        if own:
            pixels[..., channel] *= 1.0 + bias
        return {("ViewLayer", "Combined"): pixels.astype(np.float32)}

    return render


@pytest.mark.parametrize("channel", [0, 1, 2, 3])
def test_two_percent_of_a_channel_are_seen(scene, channel):
    render = pictures_of(0.02, 1e-4, channel)
    found = agreement.compare(scene, render, render(scene))
    assert f"energy of {'RGBA'[channel]} is 1.0" in found.fault
    assert found.measured["energy"] == pytest.approx(0.02, abs=5e-4)


@pytest.mark.parametrize("bias", [0.015, 0.02])
@pytest.mark.parametrize(("noise", "shared"), [(0.004, 0.0), (1e-3, 0.2), (0.004, 0.05)])
def test_a_bias_below_the_noise_of_a_picture_is_seen(scene, bias, noise, shared):
    # Noise that both have in common does not hide it, however large.
    render = pictures_of(bias, noise, shared=shared)
    found = agreement.compare(scene, render, render(scene))
    assert "energy of R is 1.0" in found.fault
    assert found.measured["energy"] == pytest.approx(bias, abs=0.005)


def test_noise_in_common_leaves_half_a_percent_undisputed(scene):
    render = pictures_of(0.005, 1e-4, shared=0.3)
    found = agreement.compare(scene, render, render(scene))
    assert (found.fault, found.measured["undecided"]) == ("", 0.0)
    assert found.measured["renders"] == 3


def test_a_channel_with_next_to_no_light_fails_and_passes_as_it_should(scene):
    def dim(render):
        def darker(scene):
            found = {key: pixels.copy() for key, pixels in render(scene).items()}
            for pixels in found.values():
                pixels[..., 0] *= 0.01
            return found

        return darker

    # Surely 2 % too much red is a fault, though red is a hundredth of the light; 2 % that may be
    # noise are not worth more pictures.
    render = dim(pictures_of(0.02, 1e-4))
    assert "energy of R is 1.0" in agreement.compare(scene, render, render(scene)).fault

    def noisy(scene):
        pixels = pictures_of(0.0, 1e-4)(scene)["ViewLayer", "Combined"]
        rng = np.random.default_rng([scene.aplanat.seed, 7, scene.aplanat.method == "ADAPTIVE"])
        pixels[..., 0] *= 0.01 * (1.0 + 0.02 * rng.standard_normal())
        return {("ViewLayer", "Combined"): pixels}

    found = agreement.compare(scene, noisy, noisy(scene))
    assert (found.fault, found.measured["undecided"]) == ("", 0.0)
    assert found.measured["renders"] <= 12


def test_half_a_percent_is_let_pass(scene):
    render = pictures_of(0.005, 1e-4)
    found = agreement.compare(scene, render, render(scene))
    assert not found.fault
    assert found.measured["undecided"] == 0.0
    assert found.measured["energy"] == pytest.approx(0.005, abs=5e-4)


def test_noise_alone_does_not_fail_a_scene(scene):
    for seed in range(0, 2000, 100):
        scene.aplanat.seed = seed
        render = pictures_of(0.0, 0.05)
        found = agreement.compare(scene, render, render(scene), most=12)
        assert not found.fault
        assert found.measured["undecided"] == 1.0


@pytest.mark.parametrize("noisy", ["ADAPTIVE", "REFERENCE"])
def test_the_noisier_method_gets_more_pictures(scene, noisy):
    rendered = {"ADAPTIVE": 0, "REFERENCE": 0}
    calm, wild = pictures_of(0.005, 1e-5), pictures_of(0.005, 6e-3)

    def render(scene):
        rendered[scene.aplanat.method] += 1
        return (wild if scene.aplanat.method == noisy else calm)(scene)

    found = agreement.compare(scene, render, wild(scene))
    assert (found.fault, found.measured["undecided"]) == ("", 0.0)
    assert rendered.pop(noisy) >= 6
    assert rendered.popitem()[1] <= 6


def test_a_picture_that_looks_different_with_the_same_energy_is_seen(scene):
    def render(scene):
        pixels = np.full((20, 20, 4), 0.5, np.float32)
        step = 0.1 if scene.aplanat.method == "ADAPTIVE" else -0.1
        pixels[::2] += step
        pixels[1::2] -= step
        return {("ViewLayer", "Combined"): pixels}

    found = agreement.compare(scene, render, render(scene))
    assert "looks differ" in found.fault


@pytest.mark.parametrize(
    ("method", "separate", "hardness", "expected"),
    [
        ("ADAPTIVE", False, 0.5, True),
        ("ADAPTIVE", True, 0.0, False),
        ("REFERENCE", False, 0.5, False),
        ("REFERENCE", True, 0.5, True),
        ("REFERENCE", True, 0.0, False),
    ],
)
def test_the_reference_draws_discs_where_the_scene_has_discs_of_a_look(
    scene, method, separate, hardness, expected
):
    # Discs that samples of the lens know nothing of are drawn by both methods or by neither.
    scene.aplanat.method, scene.aplanat.use_reference_bokeh = method, separate
    scene.camera.data.aplanat.bokeh.hardness = hardness
    asked = set()

    def render(scene):
        if scene.aplanat.method == "REFERENCE":
            asked.add(scene.aplanat.use_reference_bokeh)
        return pictures_of(0.0, 1e-4)(scene)

    assert not agreement.compare(scene, render, render(scene)).fault
    # Its own pictures, too, where that is the scene's method.
    assert asked == ({expected, separate} if method == "REFERENCE" else {expected})


def test_the_reference_method_is_not_compared_with_itself(scene):
    scene.aplanat.method = "REFERENCE"

    def render(scene):
        raise AssertionError("rendered again")

    found = agreement.compare(scene, render, {})
    assert (found.fault, found.measured["undecided"]) == ("", 0.0)


def test_settings_are_put_back_after_a_comparison(scene):
    scene.aplanat.level_bias = -3.0
    scene.camera.data.aplanat.bokeh.model = "CLUSTERED"
    render = pictures_of(0.0, 1e-4)
    agreement.compare(scene, render, render(scene))
    settings = scene.aplanat
    assert (settings.level_bias, settings.method, settings.seed) == (-3.0, "ADAPTIVE", 0)
    assert scene.camera.data.aplanat.bokeh.model == "CLUSTERED"


def test_kinds_of_faults_are_known():
    assert Fault("traceback", "x").kind in Fault.KINDS
