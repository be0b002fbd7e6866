"""Each client of the engine has a session; none sees what another one has."""

import threading
from types import SimpleNamespace

import numpy as np
import pytest

from addon.device.textures import TextureCache
from addon.engine.final_sessions import FinalSessions
from addon.engine.picture_notes import PictureNotes
from addon.engine.shared_resources import resources
from addon.levels.level_store import LevelStore
from tests.levels.test_level_store import sheet

pytestmark = pytest.mark.usefixtures("aplanat_bpy")


@pytest.fixture
def store(aplanat_bpy, monkeypatch, tmp_path):
    """The level store that new sessions share."""
    store = LevelStore(folder=tmp_path)
    monkeypatch.setattr(resources(), "levels", store)
    yield store
    store.close()


@pytest.fixture
def renders(aplanat_bpy):
    return FinalSessions(resources().open_session)


def test_a_render_that_nobody_hears_has_a_session_from_its_beginning_to_its_end(renders):
    renders.begin_render()
    session = renders.current()
    # Every frame and view layer of it.
    assert renders.current() is session
    renders.end_render()
    assert renders.current() is not session


def test_the_last_who_listens_hears(renders):
    with renders.listen() as outer:
        with renders.listen(strict=True) as inner:
            assert renders.listeners == 2
            assert renders.current().outcome is inner and inner.strict
        assert renders.current().outcome is outer and not outer.strict
    assert renders.listeners == 0
    assert all(renders.current().outcome is not heard for heard in (outer, inner))


def test_a_session_of_a_command_has_an_outcome_for_each_render(renders):
    with resources().open_session() as session:
        outcomes = []
        for _ in range(2):
            with renders.listen(session=session) as heard:
                assert renders.current() is session
                outcomes.append(heard)
        assert outcomes[0] is not outcomes[1]


def test_listening_is_heard_in_the_thread_that_renders(renders):
    found = []
    with renders.listen() as heard:
        thread = threading.Thread(target=lambda: found.append(renders.current().outcome))
        thread.start()
        thread.join()
    assert found[0] is heard


def test_a_warning_is_reported_once_a_render_and_again_in_the_next(renders):
    with renders.listen() as heard:
        session = renders.current()
        renders.begin_render()
        assert session.report(["a (2 copies)", "b"]) == ["a (2 copies)", "b"]
        assert session.report(["a (3 copies)", "b", "c"]) == ["c"]
        renders.begin_render()
        assert session.report(["b"]) == ["b"]
        assert heard.report == ["a (2 copies)", "b", "a (3 copies)", "c"]


def test_sessions_report_by_themselves():
    first, second = resources().open_session(), resources().open_session()
    assert first.report(["a"]) == second.report(["a"]) == ["a"]
    assert first.report(["a"]) == []


def test_a_session_that_is_closed_or_lost_leaves_no_handle(store):
    with resources().open_session() as session:
        handle = session.open_levels()
        handle.request([sheet(30)], 200)
        handle.finish()
        assert len(store._clients) == 1
    assert store._clients == [] and store.progress == (0, 0)
    session = resources().open_session()
    session.open_levels()
    del session
    assert store.progress == (0, 0) and store._clients == []


def test_a_session_in_use_is_closed_when_the_use_ends(store):
    session = resources().open_session()
    handle, mesh = session.open_levels(), sheet(30)
    with session.in_use():
        # Whoever listened has gone, and the render goes on.
        session.close()
        handle.request([mesh], 200)
        assert handle.finish()[mesh.uid]
    assert store._clients == []


def test_sessions_have_irises_of_their_own_and_equal_pictures_are_equal(aplanat_bpy):
    image = aplanat_bpy.data.images.new("iris", 8, 8)
    pixels = np.ones((8, 8, 4), np.float32)
    pixels[2:5, 3:, :3] = 0.25
    image.pixels.foreach_set(pixels.ravel())
    first, second = (resources().open_session().sources.irises for _ in range(2))
    iris = first.read(image, 0.5)
    assert first.read(image, 0.5) is iris
    other = second.read(image, 0.5)
    # By value: what was made of one serves the other.
    assert other is not iris and other == iris and hash(other) == hash(iris)
    assert first.read(image, 0.6) != iris
    pixels[2, 3, 0] = 0.5
    image.pixels.foreach_set(pixels.ravel())
    assert second.read(image, 0.5) != iris
    assert second.read(image, 0.5) == first.read(image, 0.5)
    aplanat_bpy.data.images.remove(image)


def test_textures_are_made_once_an_array_and_the_oldest_goes():
    arrays = [np.zeros((1, 1, 4)) for _ in range(3)]
    made = []

    def make(array):
        made.append(array)
        return object()

    cache = TextureCache(most=2)
    first, second = (cache.texture(array, make) for array in arrays[:2])
    assert cache.texture(arrays[0], make) is first
    cache.texture(arrays[2], make)
    # The second was not asked for longest; arrays are known by identity, not by their numbers.
    assert cache.texture(arrays[0], make) is first
    assert cache.texture(arrays[1], make) is not second
    assert len(made) == 4
    cache.clear()
    assert cache.texture(arrays[0], make) is not first


def test_notes_are_those_of_the_last_picture_of_each_scene():
    def scene(number):
        return SimpleNamespace(original=SimpleNamespace(session_uid=number))

    counts = SimpleNamespace(found=3)
    renderer = SimpleNamespace(highlights=counts, report=("x",), fates={"SHARP": 1}, sampling=None)
    notes = PictureNotes()
    notes.note(scene(1), renderer)
    note = notes.of(scene(1))
    assert (note.counts, note.problems, note.fates) == ({"found": 3}, ("x",), {"SHARP": 1})
    assert notes.of(scene(2)).counts is None
    renderer.highlights = None
    notes.note(scene(1), renderer)
    assert notes.of(scene(1)).counts is None
    for number in range(100):
        notes.change(scene(2 + number), problems=(number,))
    # Of scenes that were drawn long ago nothing is kept.
    assert notes.of(scene(1)).problems == ()
    assert notes.of(scene(101)).problems == (99,)


def test_who_is_registered_again_begins_anew(aplanat_bpy):
    from addon.engine import shared_resources

    before = resources()
    note = SimpleNamespace(original=SimpleNamespace(session_uid=-1))
    before.notes.change(note, problems=("old",))
    shared_resources.unregister()
    with pytest.raises(RuntimeError, match="not registered"):
        resources()
    shared_resources.register()
    assert resources() is not before
    assert resources().notes.of(note).problems == ()
    handlers = aplanat_bpy.app.handlers
    for of_render in (handlers.render_init, handlers.render_complete, handlers.render_cancel):
        ours = [h for h in of_render if h.__module__ == shared_resources.__name__]
        assert len(ours) == 1


def test_what_a_scene_kept_is_dropped_when_its_persistent_data_is_switched_off():
    render = SimpleNamespace(use_persistent_data=True)
    scene = SimpleNamespace(render=render, original=SimpleNamespace(session_uid=7))
    with resources().open_session() as session:
        kept = session.kept_scenes(scene)
        assert session.kept_scenes(scene) is kept
        render.use_persistent_data = False
        assert session.kept_scenes(scene) is not kept
        render.use_persistent_data = True
        assert session.kept_scenes(scene) is not kept
