"""Glass of a scene: drawn after all that is seen through it, from back to front (**ours**).

Each piece of glass sees the picture of the lens sample as it is without it and what is nearer, and
where that does not have what a ray meets, a probe of the scene. A lens sample is a picture from one
point, so what is behind glass is as blurred as it should be, over the samples.
"""

from dataclasses import replace

import numpy as np

from ....device import geometry, state
from ....device.targets import TargetSpec
from ....device.uniforms import uniform_buffer
from ....passes import sprite
from ....passes.surface import glass, surface, surface_target
from ....passes.surface.draw import by_level
from .probes import Probe
from .veils import Veils

# Most pieces of glass that have a probe of their own and see one another; others use that of the
# nearest.
_MOST_PROBES = 8


class GlassDrawing:
    """Draws the glass of a content.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
    target : passes.surface.surface_target.SurfaceTarget
        Of the picture.
    draws : list of surface.Draw
        Of the glass, for that target.
    spheres : culling.BoundingSpheres
    """

    def __init__(self, content, buffers, target, draws, spheres):
        self._content, self._buffers = content, buffers
        self._target = target
        self._split = None
        self.draws = draws
        self._by_level = by_level(draws)
        self._spheres = spheres
        self._probes = {}
        self._scene = None
        self._backs = {}
        if draws:
            wanted = {(draw.group, draw.slot) for draw in draws}
            self._backs = by_level(
                surface.build_draws(content, buffers, glass.exits_of(target), wanted)
            )
            self._groups = sorted({draw.group for draw in draws})
            self._fullscreen = geometry.fullscreen_batch()

    def aim(self, plan, visible, part):
        """Prepare a frame or a round of it.

        Parameters
        ----------
        plan : FramePlan
        visible : ndarray of shape (I,)
            bool.
        part : tuple of 4 int or None
            As for `SceneDrawing.aim`.
        """
        self._rows = []
        self._plan = plan
        self.confine(part)
        if not self.draws:
            return
        if plan.shadows and part is None:
            # Shadows are fitted to the camera.
            self.release()
        groups = (self._content.groups[number] for number in self._groups)
        rows = [np.arange(group.first, group.first + group.count) for group in groups]
        rows = np.unique(np.concatenate(rows))
        rows = rows[visible[rows]]
        depths = -(self._spheres.centers[rows] @ plan.view[2, :3] + plan.view[2, 3])
        self._rows = rows[np.argsort(-depths, kind="stable")].tolist()

    def confine(self, part):
        """Say which part of the raster is drawn, as `SceneDrawing.confine`."""
        x, y, width, height = part or (0, 0, self._plan.width, self._plan.height)
        self._part = [self._plan.subpixels * n for n in (x, y, x + width, y + height)]

    def split_light(self):
        """Return surfaces of whose light a part is splatted, with all their light, as `Veils`."""
        if self._split is None:
            unsplit = self._target.unsplit
            target = replace(surface_target.whole(self._target), deferred=False)
            draws = surface.build_draws(self._content, self._buffers, target)
            draws = (draw for draw in draws if (draw.group, draw.slot) not in unsplit)
            self._split = Veils([draw for draw in draws if not draw.refracts])
        return self._split

    def specs(self, plan):
        """Return the targets that it needs besides the sample's."""
        if not self._rows:
            return ()
        fine = plan.subpixels
        kinds = (
            *(("glass_behind", "RGBA32F"), ("glass_behind_depth", "R32F")),
            *(("glass_backs", "RGBA32F"), ("glass_backs_depth", "DEPTH_COMPONENT32F")),
            *(("glass_mattes", "RGBA32F"),) * ("MATTES" in self._target.defines),
        )
        return tuple(TargetSpec(name, kind, scale=fine) for name, kind in kinds)

    @property
    def is_seen(self):
        """Whether any glass is in view."""
        return bool(self._rows)

    def draw(self, targets, lights, confined, of_row, draw, draw_behind):
        """Draw the glass of a lens sample.

        Parameters
        ----------
        targets : Targets
            The sample's, with what is not glass, and those of `specs`.
        lights : LightMaps
        confined : callable
            Returns a context in which only a part of the bound frame buffer is drawn.
        of_row : callable
            From draws by group and level and a row to those of the row's level.
        draw : callable
            Draws a list of draws into the bound frame buffer, with bindings.
        draw_behind : callable
            Draws into a frame buffer what the sample lacks: light that is splatted, veils.
        """
        self._make_probes(lights.shared)
        mattes = "mattes" in targets
        slots = ("sample", "mattes") if mattes else ("sample",)
        behind = ("glass_behind", "glass_mattes") if mattes else ("glass_behind",)
        batches = np.array_split(self._rows, min(len(self._rows), _MOST_PROBES))
        for rows in (batch.tolist() for batch in batches):
            with targets.framebuffer("glass_behind", "glass_behind_depth").bind():
                sample = (targets["sample"], targets["sample_depth"])
                sprite.store(self._fullscreen, *sample, None, (0, 0))
            draw_behind(targets.framebuffer(*behind, depth="sample_depth"))
            backs = targets.framebuffer("glass_backs", depth="glass_backs_depth")
            with backs.bind(), confined():
                backs.clear(color=(0.0,) * 4, depth=0.0)
                state.farthest()
                for row in rows:
                    draw(of_row(self._backs, row))
            bindings = [self._bindings(row, targets) for row in rows]
            with targets.framebuffer(*slots, depth="sample_depth").bind(), confined():
                state.opaque()
                for row, bound in zip(rows, bindings, strict=True):
                    draw(of_row(self._by_level, row), bound)

    def _bindings(self, row, targets):
        probe = self._probes[self._probe_of[row]]
        params = uniform_buffer(
            surface.GLASS_PARAMS.pack(
                probe=(*probe.center, float(self._spheres.radii[row])),
                clip=probe.clip,
                part=self._part,
            )
        )
        return (
            ("glass_buf", params),
            ("behind_tx", targets["glass_behind"]),
            ("behind_depth_tx", targets["glass_behind_depth"]),
            ("exits_tx", targets["glass_backs"]),
            *probe.textures(),
        )

    def _make_probes(self, lights):
        """Draw the probes that are not there yet."""
        centers, radii = self._spheres.centers, self._spheres.radii
        # The largest first.
        chosen = sorted(self._rows, key=lambda row: (-radii[row], row))[:_MOST_PROBES]
        nearest = (
            np.linalg.norm(centers[chosen] - centers[row], axis=1).argmin() for row in self._rows
        )
        self._probe_of = {
            row: chosen[place] for row, place in zip(self._rows, nearest, strict=True)
        }
        for row in sorted({*self._probe_of.values()} - self._probes.keys()):
            if self._scene is None:
                target = surface_target.of_picture(False, "SHADOWS" in self._target.defines, None)
                draws = surface.build_draws(self._content, self._buffers, target)
                self._scene = [d for d in draws if d.level == 0 and not d.refracts]
            away = np.linalg.norm(centers - centers[row], axis=1) + radii
            probe = Probe(centers[row], max(float(radii[row]), 1e-6), float(away.max()))
            probe.draw(self._scene, self._buffers.instances, lights())
            self._probes[row] = probe

    @property
    def bytes(self):
        """How many bytes probes take on the device."""
        return sum(probe.bytes for probe in self._probes.values())

    def release(self):
        """Give the probes back to the device."""
        for probe in self._probes.values():
            probe.release()
        self._probes.clear()
