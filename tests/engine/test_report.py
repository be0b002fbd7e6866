"""The warnings of a frame: gathered once, from all who find them."""

from types import SimpleNamespace

from addon.engine.outcome import RenderOutcome
from addon.engine.report import frame_report, in_short, without_count
from addon.errors import StrictError


def snapshot(camera=(), content=()):
    return SimpleNamespace(
        camera=SimpleNamespace(report=tuple(camera)), content=SimpleNamespace(report=tuple(content))
    )


def test_a_frame_reports_camera_content_and_drawing_each_line_once():
    renderer = SimpleNamespace(report=("c", "a"))
    assert frame_report(snapshot(["a"], ["b", "a"]), renderer) == ("a", "b", "c")
    assert frame_report(snapshot(["a"], ["b"])) == ("a", "b")


def test_a_status_line_tells_how_many_and_the_first():
    assert in_short(()) == ""
    assert in_short(("one",)) == "Warning: one"
    assert in_short(("one", "two")) == "2 warnings, the first: one"


def test_only_a_strict_listener_stops_at_warnings():
    for strict in (False, True):
        heard = RenderOutcome(strict=strict)
        heard.check_strict()
        heard.note(["a", "a"])
        heard.note(["a", "b"])
        assert heard.report == ["a", "b"]
        stopped = None
        try:
            heard.check_strict()
        except StrictError as error:
            stopped = error.warnings
        assert stopped == (("a", "b") if strict else None)


def test_a_warning_about_more_copies_is_the_same_warning():
    line = "object 'Hair': hair curves cannot be drawn; left out"
    assert without_count(f"{line} (12 copies)") == without_count(line) == line
    assert without_count("scene 'A (2 copies)': left out") == "scene 'A (2 copies)': left out"
