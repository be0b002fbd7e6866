"""Light maps of a frame: of each light sample, what hides its light (**ours**).

Light samples have places in an atlas. Those of a generation of lens samples stay there, so that
each is drawn once; where a next generation follows, its light samples take their places.
"""

from dataclasses import replace

import numpy as np

from ...device import state
from ...device.targets import Targets, TargetSpec
from ...device.textures import texture_2d
from ...device.uniforms import uniform_buffer
from ...passes.surface import light_map, light_table, surface
from ...sampling.lights.light_turns import GENERATION, LightTurns, unhidden
from ...sampling.spectral_samples import GROUP
from . import culling, light_views
from .light_places import aim_sample, aim_sky_samples, half_angles, light_shares

# Texels of the atlas, and along a side of a lamp's map in it. Maps are turned from sample to
# sample, so that over the samples their steps are smooth: they need not be finer than the picture.
_MOST_TEXELS = 1 << 25
_LEAST_SIDE, _MOST_SIDE = 512, 1024
_WIDEST_ATLAS = 8192
# A map of the sky is so many times smaller: there are more of them, far apart.
_OF_SKY = 2
# Square root of the largest mean area of the triangles of what hides light, in texels of the map.
_FINER = 0.6


class _Casters:
    """What hides light of a content."""

    def __init__(self, content, buffers, spheres):
        self._content = content
        self._buffers = buffers
        self.spheres = spheres
        self._draws = None

    @property
    def instances(self):
        return self._buffers.instances

    def _find(self):
        content, buffers = self._content, self._buffers
        draws = surface.build_draws(content, buffers, light_map.TARGET)
        shadow = [group.shadow for group in content.groups]
        self._draws = [draw for draw in draws if shadow[draw.group]]
        # Lengths of edges of each row at each level of detail.
        most = max((draw.level for draw in self._draws), default=0)
        self._edges = np.full((len(self.spheres.radii), most + 1), np.inf)
        scale = np.linalg.norm(content.instances.world[:, :3, :3], axis=1).max(axis=1, initial=0.0)
        for group in content.groups:
            rows = slice(group.first, group.first + group.count)
            levels = buffers.level_meshes(content.meshes[group.mesh])[: most + 1]
            edges = np.sqrt([level.triangle_area for level in levels])
            self._edges[rows, : len(edges)] = scale[rows, None] * edges

    def listed(self, view, rectangle, simplifies):
        """List the draw calls of what may be in a view.

        Parameters
        ----------
        view : light_views.LightView
        rectangle : tuple of 4 int
            Of its map.
        simplifies : bool
            At a level of detail whose triangles are as small as texels of the map.

        Returns
        -------
        list of surface.Draw
        """
        if self._draws is None:
            self._find()
        centers, radii = self.spheres.centers, self.spheres.radii
        hiding = view.sees(centers, radii)
        levels = np.zeros(len(radii), int)
        if simplifies:
            texels = view.texel_sizes(rectangle, centers, radii)
            levels = (self._edges[:, 1:] <= _FINER * texels[:, None]).sum(axis=1)
        listed = []
        for draw in self._draws:
            there = slice(draw.first, draw.first + draw.count)
            chosen = levels[there] == draw.level
            rows = draw.first + np.flatnonzero(hiding[there] & chosen)
            # Between rows of one level only rows that nothing is lost with may be drawn along.
            passing = draw.triangles if chosen.all() else np.inf
            listed += [
                replace(draw, first=first, count=count)
                for first, count in culling.runs(rows, passing)
            ]
        return listed


class LightMaps:
    """The light samples of a frame and their maps.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
    spheres : culling.BoundingSpheres

    Attributes
    ----------
    draw_calls, triangles : int
        Of the maps, since `aim`.
    """

    def __init__(self, content, buffers, spheres):
        self._content = content
        self._buffers = buffers
        self._casters = [_Casters(content, buffers, spheres)]
        if content.unseen is not None:
            bounds = {uid: mesh.bounds for uid, mesh in buffers.unseen.meshes.items()}
            unseen = culling.BoundingSpheres(content.unseen, bounds)
            self._casters.append(_Casters(content.unseen, buffers.unseen, unseen))
        self._spheres = spheres
        self._hiding = [
            np.concatenate([part.spheres.centers for part in self._casters]),
            np.concatenate([part.spheres.radii for part in self._casters]),
        ]
        self._targets = None
        self._plan = self._turns = None
        self.draw_calls = self.triangles = 0

    def aim(self, plan, seen, extents):
        """Begin a frame; later rounds of it keep the light samples.

        Parameters
        ----------
        plan : FramePlan
        seen : ndarray of shape (I,)
            bool; the instances in view.
        extents : levels.choosing.Extents
        """
        self.draw_calls = self.triangles = 0
        follows = self._plan is not None and plan.first > 0
        self._plan = plan
        if follows:
            return
        self._generation = None
        self._shown = set()
        self._samples = []
        self._turns = None
        shares = np.zeros(len(self._content.lights) + 1)
        if plan.shadows and seen.any() and (len(shares) > 1 or self._buffers.sky.irradiance):
            ends = (extents.nearest[seen], extents.farthest[seen])
            self._receivers = light_views.receivers_of(
                plan, self._content.boxes.corners(seen), *ends
            )
            lights, sky = self._content.lights, self._buffers.sky
            shares = light_shares(lights, sky, self._receivers, self._spheres, seen)
        if shares.any():
            self._divide(plan, shares)
            self._begin_generation(0)
        self._fill_table()

    def _divide(self, plan, shares):
        """Choose the light samples, and where their maps are in the atlas."""
        lights = self._content.lights
        # Samples of all wavelengths of a group have the same shadows.
        self._group = GROUP if plan.chromatic else 1
        self._seed = plan.source.seed if plan.source else 0
        self._turns = LightTurns(
            shares,
            np.append(half_angles(lights, self._receivers), 0.0),
            np.append([light.kind == "AREA" for light in lights], False),
            None if plan.automatic else -(-plan.samples // self._group),
            self._seed,
        )
        self._of, self._numbers = self._turns.lights_and_numbers()
        lamps = int((self._of < len(lights)).sum())
        cells = lamps + -(-(len(self._of) - lamps) // _OF_SKY**2)
        side = 2 ** int(np.ceil(np.log2(max(plan.width, plan.height))))
        side = int(np.clip(side, _LEAST_SIDE, _MOST_SIDE))
        while cells * side**2 > _MOST_TEXELS:
            side //= 2
        columns = min(_WIDEST_ATLAS // side, int(np.ceil(np.sqrt(cells))))
        size = (columns * side, -(-cells // columns) * side)
        self._lamps, self._side, self._columns = lamps, side, columns
        if self._targets is None or (self._targets.width, self._targets.height) != size:
            self.release()
            self._targets = Targets(*size, [TargetSpec("maps", "DEPTH_COMPONENT32F")])

    def _tile(self, place):
        """Return the corner and the side of a light sample's place in the atlas, texels."""
        side, lamps, part = self._side, self._lamps, (0, 0)
        cell = place
        if place >= lamps:
            cell, inside = divmod(place - lamps, _OF_SKY**2)
            cell += lamps
            part = (inside % _OF_SKY, inside // _OF_SKY)
        corner = [cell % self._columns * side, cell // self._columns * side]
        if place >= lamps:
            side //= _OF_SKY
        return (corner[0] + part[0] * side, corner[1] + part[1] * side), side

    def _begin_generation(self, generation):
        """Take new places on the lights."""
        self._generation = generation
        self._shown = set()
        lights, counts = self._content.lights, self._turns.counts
        self._samples = []
        resources = {
            "seed": self._seed,
            "receivers": self._receivers,
            "hiding": self._hiding,
        }
        for light, number in zip(self._of.tolist(), self._numbers.tolist(), strict=True):
            if light < len(lights):
                number += generation * int(counts[light])
                given = (lights[light], light, number, 2 * light)
                self._samples.append(aim_sample(*given, **resources))
        if counts[-1]:
            each = int(self._turns.each[-1])
            given = (each, int(counts[-1]) // each, generation, 2 * len(lights))
            self._samples += aim_sky_samples(self._buffers.sky, *given, **resources)

    def _fill_table(self):
        rows = np.zeros((len(self._samples), light_map.ROW_TEXELS, 4), np.float32)
        for place, sample in enumerate(self._samples):
            rows[place, 0] = (sample.light, 0.0, len(sample.views), 0.0)
            rows[place, 1] = (*sample.place, sample.group_of_sky)
            rows[place, 2, :3] = sample.light_of_sky
            rectangles = self._rectangles(place)
            for i, (view, rectangle) in enumerate(zip(sample.views, rectangles, strict=True)):
                first = light_map.HEAD_TEXELS + i * light_map.VIEW_TEXELS
                rows[place, first : first + light_map.VIEW_TEXELS] = view.texels(rectangle)
        self._table = texture_2d(light_table.table_texels(self._content.lights, rows))

    def _rectangles(self, place):
        count = len(self._samples[place].views)
        return light_views.tiles(count, *self._tile(place)) if count else []

    def of_samples(self, index, samples):
        """Return what surfaces are lit by that are drawn for lens samples; their maps are drawn.

        Parameters
        ----------
        index : int
            The lens sample for which the drawing is made.
        samples : iterable of int
            All that share it.

        Returns
        -------
        passes.surface.light_map.Lighting
        """
        if self._turns is None:
            return self._bound(None)
        generation = index // self._group // GENERATION
        if generation != self._generation:
            self._begin_generation(generation)
            self._fill_table()
        return self._bound(self._turns.of_samples([n // self._group for n in samples]))

    def shared(self):
        """Return what surfaces are lit by in drawings that all lens samples share."""
        if self._turns is None:
            return self._bound(None)
        return self._bound(self._turns.of_samples(range(GENERATION)))

    def steady(self):
        """Return what highlights are found by."""
        return self._bound(self._turns and self._turns.steady())

    def _bound(self, own):
        """Return what is bound for surfaces lit by a `LightList`; None: nothing hides light."""
        if own is None:
            lists = light_table.list_texels([unhidden(len(self._content.lights))] * 2)
            nothing = texture_2d(np.ones((1, 1, 1), np.float32), "R32F")
            return light_map.Lighting(self._table, nothing, texture_2d(lists))
        steady = self._turns.steady()
        for place in (*own.places.tolist(), *steady.places.tolist()):
            if place not in self._shown:
                self._draw_map(place)
        lists = texture_2d(light_table.list_texels((own, steady)))
        return light_map.Lighting(self._table, self._targets["maps"], lists)

    def _draw_map(self, place):
        sample = self._samples[place]
        self._targets.forget_framebuffers()
        framebuffer = self._targets.framebuffer(depth="maps")
        with framebuffer.bind():
            # On Vulkan a depth buffer that may not be written is cleared as a whole.
            state.opaque()
            for view, rectangle in zip(sample.views, self._rectangles(place), strict=True):
                with state.scissored(*rectangle):
                    framebuffer.clear(depth=1.0)
                with state.confined(*rectangle):
                    self._draw_view(view, rectangle, place)
        self._shown.add(place)

    def _draw_view(self, view, rectangle, place):
        matrix, projection = view.matrices()
        params = uniform_buffer(
            surface.VIEW_PARAMS.pack(
                view=matrix,
                view_inverse=np.linalg.inv(matrix),
                projection=projection,
                lens=(1.0, float(view.parallel), 0.0, 1.0),
                film=(*rectangle[2:], 0.0, 0.0),
            )
        )
        for casters in self._casters:
            simplifies = self._plan.level_bias is not None
            listed = casters.listed(view, rectangle, simplifies)
            number = place + self._generation * len(self._samples)
            light_map.draw(listed, params, casters.instances, number)
            self.draw_calls += len(listed)
            self.triangles += sum(draw.triangles * draw.count for draw in listed)

    @property
    def bytes(self):
        """Bytes of the atlas on the device."""
        return self._targets.bytes if self._targets else 0

    def release(self):
        """Give the atlas back to the device."""
        if self._targets is not None:
            self._targets.release()
        self._targets = None
        self._shown = set()
