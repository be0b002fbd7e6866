"""Render targets: what is made is released, and what is too large is refused with advice."""

import pytest

from addon.device import census, context
from addon.device.targets import Targets, TargetSpec
from addon.errors import DeviceLimitError


@pytest.fixture(autouse=True)
def gpu_context(aplanat_bpy):
    context.ensure_context()


def test_a_picture_larger_than_the_device_allows_is_refused_with_advice():
    limit = context.max_texture_size()
    with pytest.raises(DeviceLimitError, match=r"render border.*allows \d+ pixels a side"):
        Targets(limit + 1, 4, [TargetSpec("image", "RGBA32F")])


def test_a_picture_that_does_not_fit_into_memory_is_refused_with_advice(monkeypatch):
    import gpu

    def refuse(*_, **__):
        raise RuntimeError("gpu.texture.new(...) failed")

    targets = Targets(4096, 4096, [])
    # Whether a device refuses by itself depends on the machine's memory.
    monkeypatch.setattr(gpu.types, "GPUTexture", refuse)
    with pytest.raises(DeviceLimitError, match=r"4096 x 4096 pixels needs 0.2 GiB .*border"):
        targets.add(TargetSpec("image", "RGBA32F"))


def test_released_targets_are_gone():
    with census.taken() as count:
        with Targets(8, 4, [TargetSpec("a", "RGBA32F"), TargetSpec("b", "R32F", 3)]) as targets:
            targets.framebuffer("a")
            alive = count.alive()
            assert alive["texture"] == (2, 8 * 4 * (16 + 3 * 4))
            assert alive["framebuffer"] == (1, 0)
            assert targets.bytes == alive["texture"][1]
        assert count.alive() == {}


def test_a_texture_that_somebody_holds_is_alive():
    with census.taken() as count:
        targets = Targets(4, 4, [TargetSpec("a", "RGBA32F")])
        held = targets["a"]
        targets.release()
        assert count.alive() == {"texture": (1, 256)}
        del held
        assert count.alive() == {}


def test_nothing_is_recorded_without_a_census():
    with census.taken() as count:
        pass
    with Targets(4, 4, [TargetSpec("a", "RGBA32F")]):
        assert count.alive() == {}


def test_clear_fills_every_pixel():
    from addon.device.readback import read_color

    with Targets(4, 4, [TargetSpec("a", "RGBA32F")]) as targets:
        targets.clear("a", (1.0, 2.0, 3.0, 1e10))
        pixels = read_color(targets.framebuffer("a"), 4, 4)
    assert (pixels == [1.0, 2.0, 3.0, 1e10]).all()
