"""What holds a focus: other cameras, libraries, drivers, locks; and what a pull leaves behind."""

from types import MethodType, SimpleNamespace

import pytest

from addon.errors import FocusError
from addon.scene.camera.focusing import DISTANCE, OFFSET_MARK, focus_on, why_not_focused

PLACE = (0.0, 4.0, 0.0)


@pytest.fixture
def stage(empty_scene, aplanat_bpy):
    """A camera at the origin that looks along y, and one 10 m behind it for the end of a pull."""
    cameras = {}
    for name, y in (("first", 0.0), ("second", -10.0)):
        camera = aplanat_bpy.data.objects.new(name, aplanat_bpy.data.cameras.new(name))
        camera.location, camera.rotation_euler = (0.0, y, 0.0), (1.5707963, 0.0, 0.0)
        camera.data.dof.focus_distance = 7.0
        empty_scene.collection.objects.link(camera)
        cameras[name] = camera
    empty_scene.camera = cameras["first"]
    aplanat_bpy.context.view_layer.update()
    return empty_scene


class Operator:
    """An operator as Blender calls it, without its window; `told` are its reports."""

    def __init__(self, kind, **values):
        self.kind, self.told = kind, []
        vars(self).update(values)

    def report(self, _, text):
        self.told.append(text)

    def __getattr__(self, name):
        found = getattr(self.kind, name)
        return MethodType(found, self) if callable(found) else found


def window_of(bpy):
    nothing = lambda *_: None  # noqa: E731
    window = SimpleNamespace(
        cursor_modal_set=nothing,
        cursor_modal_restore=nothing,
        screen=SimpleNamespace(areas=()),
    )
    return SimpleNamespace(
        scene=bpy.context.scene,
        window=window,
        workspace=SimpleNamespace(status_text_set=nothing),
        window_manager=SimpleNamespace(modal_handler_add=nothing),
    )


@pytest.fixture
def pull(stage, aplanat_bpy, monkeypatch):
    """A focus pull that has begun, a click of it, and where it looks."""
    from addon.ui.focus import focus_operators

    context = window_of(aplanat_bpy)
    kind = focus_operators.APLANAT_OT_focus_pull
    # The whole chain of a click but for the picture: `point` is what lies under the mouse.
    monkeypatch.setattr(focus_operators, "_view_under", lambda *_: (None, None, 0, 0))
    found = Operator(kind, length=20, easing="LINEAR", camera="")
    found.look = lambda *_: found.point

    def press(key="LEFTMOUSE", ctrl=False, point=PLACE):
        found.point = point
        event = SimpleNamespace(
            type=key, value="PRESS", ctrl=ctrl, oskey=False, mouse_x=0, mouse_y=0
        )
        return kind.modal(found, context, event)

    found.press = press
    found.start_it = lambda: kind.invoke(found, context, None)
    stage.frame_set(10, subframe=0.5)
    return found


def curve_of(camera):
    from bpy_extras.anim_utils import action_get_channelbag_for_slot

    animation = camera.data.animation_data
    bag = action_get_channelbag_for_slot(animation.action, animation.action_slot)
    return bag.fcurves.find(DISTANCE)


def keys(camera):
    return [tuple(key.co) for key in curve_of(camera).keyframe_points]


def test_a_pull_stays_with_the_camera_of_the_first_click(stage, pull, aplanat_bpy):
    first, second = (aplanat_bpy.data.objects[name] for name in ("first", "second"))
    for frame, camera in ((1, first), (20, second)):
        stage.timeline_markers.new(camera.name, frame=frame).camera = camera
    assert pull.start_it() == {"RUNNING_MODAL"}
    assert pull.press() == {"RUNNING_MODAL"}
    # What the view shows is what is measured.
    assert (stage.frame_current, stage.camera) == (30, first)
    assert pull.press(point=(0.0, 6.0, 0.0)) == {"FINISHED"}
    assert keys(first) == [pytest.approx((10.0, 4.0)), pytest.approx((30.0, 6.0))]
    assert second.data.animation_data is None
    assert (stage.frame_current, stage.frame_subframe, stage.camera) == (10, 0.5, first)


def test_nothing_is_undone_between_the_clicks(pull):
    pull.start_it()
    pull.press()
    assert pull.press("Z", ctrl=True) == {"RUNNING_MODAL"}
    assert pull.press("Z") == {"PASS_THROUGH"}


@pytest.mark.parametrize("vanished", [False, True])
def test_a_pull_that_ends_early_leaves_frame_and_camera(stage, pull, aplanat_bpy, vanished):
    first, second = (aplanat_bpy.data.objects[name] for name in ("first", "second"))
    stage.timeline_markers.new("end", frame=5).camera = second
    stage.camera = first
    pull.start_it()
    pull.press()
    if vanished:
        aplanat_bpy.data.objects.remove(first)
    assert pull.press("LEFTMOUSE" if vanished else "ESC") == {"CANCELLED"}
    assert (stage.frame_current, stage.frame_subframe) == (10, 0.5)
    if vanished:
        assert "no camera" in pull.told[-1]
    else:
        assert stage.camera == first


def test_a_copied_camera_gets_an_empty_of_its_own(stage, aplanat_bpy):
    bpy, first = aplanat_bpy, stage.camera
    target = bpy.data.objects.new("target", None)
    stage.collection.objects.link(target)
    first.data.dof.focus_object = target
    focus_on(stage, first, PLACE)
    shared = first.data.dof.focus_object
    copied = first.copy()
    copied.data = first.data.copy()
    stage.collection.objects.link(copied)
    bpy.context.view_layer.update()
    focus_on(stage, copied, (0.0, 8.0, 0.0))
    bpy.context.view_layer.update()
    own = copied.data.dof.focus_object
    assert own != shared and OFFSET_MARK in own and own.parent == target
    assert tuple(shared.matrix_world.translation) == pytest.approx(PLACE)
    assert tuple(own.matrix_world.translation) == pytest.approx((0.0, 8.0, 0.0))
    # The first one's is its own again.
    focus_on(stage, first, PLACE)
    assert first.data.dof.focus_object == shared


def test_a_driver_holds_the_distance(stage, aplanat_bpy):
    bpy, data = aplanat_bpy, stage.camera.data
    data.driver_add(DISTANCE).driver.expression = "3.0"
    data.dof.use_dof = False
    with pytest.raises(FocusError, match="driver"):
        focus_on(stage, stage.camera, PLACE)
    done = bpy.ops.view3d.aplanat_focus_pull("EXEC_DEFAULT", first=2.0, second=3.0)
    assert done == {"CANCELLED"}
    assert not data.dof.use_dof and data.animation_data.action is None


def test_locked_keys_are_told(stage, aplanat_bpy):
    data = stage.camera.data
    data.keyframe_insert(DISTANCE, frame=1)
    curve_of(stage.camera).lock = True
    done = aplanat_bpy.ops.view3d.aplanat_focus_pull("EXEC_DEFAULT", first=2.0, second=3.0)
    assert done == {"CANCELLED"} and data.dof.focus_distance == 7.0
    assert "locked" in why_not_focused(stage.camera)


@pytest.mark.parametrize("holder", ["lock", "driver", "constraint"])
def test_an_empty_that_is_held_stays(stage, aplanat_bpy, holder):
    camera = stage.camera
    target = aplanat_bpy.data.objects.new("target", None)
    stage.collection.objects.link(target)
    camera.data.dof.focus_object = target
    focus_on(stage, camera, PLACE)
    empty = camera.data.dof.focus_object
    if holder == "lock":
        empty.lock_location[1] = True
    elif holder == "driver":
        empty.driver_add("location", 1)
    else:
        empty.constraints.new("COPY_LOCATION").target = target
    before = empty.matrix_basis.copy()
    with pytest.raises(FocusError, match=holder):
        focus_on(stage, camera, (0.0, 8.0, 0.0))
    assert empty.matrix_basis == before
    # Let go, nothing holds the distance.
    assert focus_on(stage, camera, PLACE, follow=False) == pytest.approx(4.0)


@pytest.fixture
def linked(stage, aplanat_bpy, tmp_path):
    """The first camera, linked, its object overridden."""
    bpy = aplanat_bpy
    bpy.data.libraries.write(str(tmp_path / "cameras.blend"), {stage.camera})
    with bpy.data.libraries.load(str(tmp_path / "cameras.blend"), link=True) as (_, wanted):
        wanted.objects = ["first"]
    camera = wanted.objects[0].override_create()
    stage.collection.objects.link(camera)
    stage.camera = camera
    return camera


def test_a_linked_camera_is_neither_dragged_nor_picked_for(linked, stage, aplanat_bpy):
    from addon.ui.focus.focus_gizmo import is_movable
    from addon.ui.focus.focus_operators import APLANAT_OT_focus_pick

    assert not linked.data.is_editable
    assert is_movable(aplanat_bpy.data.objects["second"])
    assert not is_movable(linked)
    with pytest.raises(FocusError, match="library override"):
        focus_on(stage, linked, PLACE)
    # The key tells why, too.
    key = Operator(APLANAT_OT_focus_pick, at_cursor=True, follow=True)
    assert APLANAT_OT_focus_pick.invoke(key, window_of(aplanat_bpy), None) == {"CANCELLED"}
    assert "library override" in key.told[-1]
    stage.camera = None
    APLANAT_OT_focus_pick.invoke(key, window_of(aplanat_bpy), None)
    assert key.told[-1] == why_not_focused(None)


@pytest.mark.parametrize("keyed", [False, True])
def test_dragging_keys_where_blender_sets_keys_by_itself(stage, aplanat_bpy, keyed):
    from addon.ui.focus.focus_gizmo import APLANAT_GT_focus_plane as Plane

    data = stage.camera.data
    stage.tool_settings.use_keyframe_insert_auto = keyed
    area = SimpleNamespace(header_text_set=lambda _: None)
    context = SimpleNamespace(scene=stage, area=area)
    for cancel in (True, False):
        data.dof.focus_distance = 5.0
        Plane.exit(SimpleNamespace(_before=7.0, _data=data), context, cancel)
        assert data.dof.focus_distance == (7.0 if cancel else 5.0)
        assert (data.animation_data is not None) == (keyed and not cancel)
