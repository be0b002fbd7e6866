"""The Sampling panel: its sections, its presets, and what it tells of the last picture."""

import pytest

from addon.engine.frame.tile_sampling import SamplingReport


@pytest.mark.parametrize("name", ["viewport", "render", "advanced"])
def test_sections_belong_to_the_panel(aplanat_bpy, name):
    panel = getattr(aplanat_bpy.types, f"APLANAT_RENDER_PT_sampling_{name}")
    assert panel.bl_parent_id == "APLANAT_RENDER_PT_sampling"
    assert {"APLANAT"} == panel.COMPAT_ENGINES


def test_the_panel_tells_the_error_that_was_reached(aplanat_bpy):
    from addon.ui.panels.sampling_panel import sampling_as_lines

    report = SamplingReport(0.01, 0.0093, (16, 48.4, 128), 60, 12)
    assert sampling_as_lines(report) == [
        "Last picture: error 0.0093 of 0.0100, 16 to 128 samples (48 on the average)"
    ]
    stopped = SamplingReport(0.01, 0.02, (16, 48.4, 128), 60, 12)
    assert len(sampling_as_lines(stopped)) == 2
    assert sampling_as_lines(SamplingReport(None, None, (4, 4.0, 4))) == []
    assert sampling_as_lines(None) == []


def test_settings_have_blenders_words(empty_scene):
    settings = empty_scene.aplanat
    names = {prop.identifier: prop.name for prop in settings.bl_rna.properties}
    for side, word in (("render", "Render"), ("preview", "Viewport")):
        assert names[f"{side}_error"] == f"{word} Noise Threshold"
        assert names[f"{side}_min_samples"] == f"{word} Min Samples"
        assert names[f"{side}_max_samples"] == f"{word} Max Samples"
        assert names[f"{side}_time_limit"] == f"{word} Time Limit"
    # Off: it makes a picture depend on the machine.
    assert settings.render_time_limit == settings.preview_time_limit == 0.0


def test_settings_are_read(empty_scene):
    from addon.scene.settings import read_preview_sampling, read_sampling

    settings = empty_scene.aplanat
    settings.render_min_samples, settings.render_max_samples = 32, 512
    settings.preview_min_samples, settings.preview_max_samples = 24, 128
    settings.render_time_limit, settings.preview_time_limit = 60.0, 2.0
    final, preview = read_sampling(empty_scene), read_preview_sampling(empty_scene)
    assert (final.least_samples, final.most_samples, final.time_limit) == (32, 512, 60.0)
    assert (preview.least_samples, preview.most_samples, preview.time_limit) == (24, 128, 2.0)
    settings.render_time_limit = 0.0
    assert read_sampling(empty_scene).time_limit is None
