"""Probes: the scene as glass sees it from its middle, once for all lens samples.

Six faces of a cube, three in a row of an atlas, with depth, so that rays from anywhere in the glass
find what they meet (see lib/surface/probe_lib.glsl). They have what no lens sample's picture holds:
what is beside and behind the camera, and what other things hide.
"""

import numpy as np

from ....device import state
from ....device.targets import Targets, TargetSpec
from ....device.uniforms import uniform_buffer
from ....passes.surface import surface

_SIDE = 256
# Where the camera looks in each face, and what is up; must agree with probe_lib.
_FACES = (
    *(((1, 0, 0), (0, 0, 1)), ((-1, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, 0, 1))),
    *(((0, -1, 0), (0, 0, 1)), ((0, 0, 1), (0, 1, 0)), ((0, 0, -1), (0, 1, 0))),
)
# Share of the glass' radius that nothing is nearer than.
_NEAR = 0.02


class Probe:
    """A scene as seen from a point.

    Parameters
    ----------
    center : ndarray of shape (3,)
        In world space, m.
    radius : float
        Of the glass around it, m.
    farthest : float
        Distance of the farthest thing, m.

    Attributes
    ----------
    clip : tuple of 4 float
        As in `GlassParams`.
    """

    def __init__(self, center, radius, farthest):
        self.center, self.radius = center, radius
        near = _NEAR * radius
        self.clip = (near, max(1.05 * farthest, 4.0 * radius), float(_SIDE), 0.0)
        specs = (TargetSpec("color", "RGBA16F"), TargetSpec("depth", "DEPTH_COMPONENT32F"))
        self._targets = Targets(3 * _SIDE, 2 * _SIDE, specs)

    @property
    def bytes(self):
        """How many bytes it takes on the device."""
        return self._targets.bytes

    def textures(self):
        """Return what shaders of glass read of it, as (name, GPUTexture)."""
        return (
            ("probe_tx", self._targets["color"]),
            ("probe_depth_tx", self._targets["depth"]),
        )

    def draw(self, draws, instances, lights):
        """Draw the scene.

        Parameters
        ----------
        draws : list of surface.Draw
            For `passes.surface.surface_target.COLOR`, of all instances that are no glass.
        instances : GPUTexture
            The content's own instance table.
        lights : passes.surface.light_map.Lighting
        """
        views = [uniform_buffer(self._view_params(*face)) for face in _FACES]
        with self._targets.framebuffer("color", depth="depth").bind():
            framebuffer = self._targets.framebuffer("color", depth="depth")
            framebuffer.clear(color=(0.0,) * 4, depth=1.0)
            for number, view in enumerate(views):
                x, y = number % 3 * _SIDE, number // 3 * _SIDE
                with state.confined(x, y, _SIDE, _SIDE):
                    state.opaque()
                    surface.draw_sample(draws, view, instances, (0.0,) * 4, 0, lights=lights)
        self._targets.forget_framebuffers()

    def _view_params(self, forwards, up):
        forwards, up = np.array(forwards, float), np.array(up, float)
        view = np.eye(4)
        view[:3, :3] = np.cross(forwards, up), up, -forwards
        view[:3, 3] = -view[:3, :3] @ self.center
        near, far = self.clip[:2]
        projection = np.diag([1.0, 1.0, -(far + near) / (far - near), 0.0])
        projection[2, 3], projection[3, 2] = -2.0 * far * near / (far - near), -1.0
        return surface.VIEW_PARAMS.pack(
            view=view,
            view_inverse=np.linalg.inv(view),
            projection=projection,
            lens=(1.0, 0.0, 0.0, 1.0),
            film=(_SIDE, _SIDE, 0.0, 0.0),
        )

    def release(self):
        """Give the textures back to the device."""
        self._targets.release()
