"""What the device holds is dropped by the thread that draws, wherever Python lost it."""

import gc
import threading

import pytest

from addon.device import census, keeping


class Texture:
    """Stands for one of Blender's: notes the thread in which it is freed."""

    def __init__(self, freed, held=None):
        self._freed = freed
        self._held = held

    def __del__(self):
        self._freed.append(threading.current_thread())


@pytest.fixture(autouse=True)
def alone(monkeypatch):
    monkeypatch.setattr(keeping, "_held", [])
    monkeypatch.setattr(keeping, "_owner", threading.get_ident())


def in_another_thread(work):
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()


def test_what_is_in_use_stays():
    freed = []
    texture = census.record("texture", Texture(freed))
    keeping.let_go()
    assert not freed and keeping._held
    del texture
    keeping.let_go()
    assert freed == [threading.current_thread()] and not keeping._held


def test_a_cycle_that_another_thread_collects_frees_nothing_there():
    freed = []
    cycle = {"texture": census.record("texture", Texture(freed))}
    cycle["itself"] = cycle
    del cycle
    in_another_thread(gc.collect)
    in_another_thread(keeping.let_go)
    assert not freed
    keeping.let_go()
    assert freed == [threading.main_thread()]


def test_a_frame_buffer_goes_with_the_textures_that_only_it_holds():
    freed = []
    texture = census.record("texture", Texture(freed))
    framebuffer = census.record("framebuffer", Texture(freed, texture))
    del texture
    keeping.let_go()
    assert not freed
    del framebuffer
    keeping.let_go()
    assert len(freed) == 2


def test_the_many_of_a_frame_are_not_looked_at_for_each_new_one(monkeypatch):
    looks, freed = [], []
    monkeypatch.setattr(keeping, "_left", 0)
    is_orphan = keeping.is_orphan
    monkeypatch.setattr(keeping, "is_orphan", lambda holder: looks.append(1) or is_orphan(holder))
    in_use = []
    for number in range(4000):
        texture = census.record("texture", Texture(freed))
        if number % 4:
            in_use.append(texture)
        del texture
        keeping.let_go_now_and_then()
        # What nobody needs is never more than half of the rest, or few.
        assert len(keeping._held) <= 1.5 * len(in_use) + 65
    assert len(looks) < 6 * 4000
    assert 0 < len(freed) < 1000
    keeping.let_go()
    assert len(freed) == 1000


def test_a_census_counts_what_others_hold():
    freed = []
    with census.taken() as taken:
        texture = census.record("texture", Texture(freed), 12)
        assert taken.alive() == {"texture": (1, 12)}
        del texture
        assert taken.alive() == {} and len(freed) == 1
