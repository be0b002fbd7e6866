"""The circle of confusion as colours over a 3D view (methods 1)."""

from ..device import shader_source, state
from ..device.readback import read_depth
from ..device.shaders import ShaderInfo, compile_shader

OVERLAY = ShaderInfo(
    name="aplanat_focus_overlay",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/focus_overlay_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "depth_tx"),),
    push_constants=(("MAT4", "from_clip"), ("VEC4", "optics"), ("IVEC2", "origin")),
)


def draw(fullscreen, from_clip, blur, acceptable):
    """Draw over the frame buffer that is bound, within its viewport.

    Its depth is read back: Blender gives no texture of it. That takes some milliseconds, in a view
    of a person who sets the focus, and in no frame of ours.

    Parameters
    ----------
    fullscreen : GPUBatch
    from_clip : ndarray of shape (4, 4)
        From the clip space of the view to the space of the camera that is set, float.
    blur : DepthOfField
    acceptable : float
        Diameter of the circle of confusion that counts as in focus, px.
    """
    depth, origin = read_depth()
    shader = compile_shader(OVERLAY)
    shader.bind()
    shader.uniform_sampler("depth_tx", depth)
    shader.uniform_float("from_clip", from_clip.T.ravel().tolist())
    parallel = float(blur.orthographic)
    shader.uniform_float("optics", (blur.focus_distance, blur.reach, acceptable, parallel))
    shader.uniform_int("origin", origin)
    state.veil()
    shader.draw(fullscreen)
