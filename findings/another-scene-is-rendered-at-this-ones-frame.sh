#!/usr/bin/env bash
# Blender: rendering another scene takes the frame of the scene that is open, and leaves it there.
#
# `bpy.ops.render.render(scene="shot_b")` renders a scene that is not the window's. One would expect
# its own current frame, or that the call leaves both scenes alone.
# Seen (bpy 5.2.3): the scene is rendered at the frame of the *context's* scene, and its
# `frame_current` is changed to that for good. The frame of a scene other than the context's has to be
# set on the context's scene (or the scene made current) before the call.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)


def shot(name, frame):
    """Return a new scene with a camera, standing at a frame."""
    scene = bpy.data.scenes.new(name)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.camera = bpy.data.objects.new(f"{name} camera", bpy.data.cameras.new(name))
    scene.collection.objects.link(scene.camera)
    scene.frame_set(frame)
    return scene


a, b = shot("shot_a", 3), shot("shot_b", 40)
bpy.context.window.scene = a
rendered = []
bpy.app.handlers.render_post.append(lambda s, *_: rendered.append((s.name, s.frame_current)))
bpy.ops.render.render(scene="shot_b")
print(f"seen: rendered {rendered}, afterwards a at {a.frame_current}, b at {b.frame_current}")
assert rendered == [("shot_b", 3)] and (a.frame_current, b.frame_current) == (3, 3)
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
