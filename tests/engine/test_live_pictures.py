"""Live pictures have one owner: a session while there is any, and nothing left afterwards."""

from types import SimpleNamespace

import pytest

from addon.engine.live_pictures import LivePictures


@pytest.fixture
def sessions():
    return []


@pytest.fixture
def live(sessions):
    def open_session():
        session = SimpleNamespace(closed=False)
        session.close = lambda: setattr(session, "closed", True)
        sessions.append(session)
        return session

    return LivePictures(open_session)


class Picture:
    """What the owner asks of a picture."""

    def __init__(self, session):
        self.session, self.closed = session, False

    def close(self):
        """Note that it ended."""
        self.closed = True


def scene(uid):
    return SimpleNamespace(session_uid=uid)


def test_pictures_share_a_session_that_ends_with_the_last(live, sessions):
    first, second = (live.begin(scene(uid), Picture) for uid in (1, 2))
    assert live.begin(scene(1), Picture) is first and len(live) == 2
    assert sessions == [first.session] and second.session is first.session
    live.keep_only({2})
    assert first.closed and not second.closed and not sessions[0].closed
    live.close()
    assert second.closed and sessions[0].closed and list(live) == []
    assert live.begin(scene(1), Picture).session is sessions[1]


def test_a_held_scene_has_no_picture_until_it_is_let_go(live):
    kept, ended = (live.begin(scene(uid), Picture) for uid in (1, 2))
    live.hold(scene(2))
    assert ended.closed and not kept.closed
    assert live.is_held(scene(2)) and live.find(scene(2)) is None
    live.let_go(scene(2))
    assert not live.is_held(scene(2))
