"""Light maps of a frame: of each light sample, what hides its light (**ours**).

Light samples have places in an atlas, which are drawn over as the lens samples go on. Lights have
their turns in periods as long as the atlas has places, so that whichever lens samples share a
drawing, it is lit by as many places on each light as they would have been one by one.
"""

from dataclasses import replace

import numpy as np

from ...device import state
from ...device.targets import Targets, TargetSpec
from ...device.textures import texture_2d
from ...device.uniforms import uniform_buffer
from ...passes.surface import light_map, light_table, surface
from ...sampling.lights.light_samples import schedule, turns_of
from ...sampling.lights.sky_samples import NORMALS
from ...sampling.spectral_samples import GROUP
from . import culling, light_views
from .light_places import aim_sample, aim_sky_sample, light_shares

# Texels of the atlas, and along a side of a place in it. Maps are turned from sample to sample, so
# that over the samples their steps are smooth: they need not be finer than the picture.
_MOST_TEXELS = 1 << 26
_LEAST_SIDE, _MOST_SIDE = 512, 1024
_WIDEST_ATLAS = 8192
_MOST_PLACES = 128
# Light samples after which every light has had its turns, where their number is not known.
_PERIOD = 64
# Square root of the largest mean area of the triangles of what hides light, in texels of the map.
_FINER = 0.6
# Places from which a lens sample is lit at most, and from which a picture is lit at least where
# that allows it: half of the sky's directions are below a surface, and the rest are far apart.
_MOST_EACH = 4
_LEAST_OF_LAMPS, _LEAST_OF_SKY = 128, 512
# Places that what may be splatted is lit from: fewer take less time where much of the picture is as
# bright as highlights.
_STEADY = light_map.MOST_STEADY


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
    corners : ndarray of shape (I, 8, 3)
        Of the instances' bounding boxes, in world space.

    Attributes
    ----------
    draw_calls, triangles : int
        Of the maps, since `aim`.
    """

    def __init__(self, content, buffers, spheres, corners):
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
        self._corners = corners
        self._targets = None
        self._empty = None
        self._plan = None
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
        self._batch = None
        self._shown = set()
        self._steady = self._places = 0
        self._samples = []
        shares = np.zeros(len(self._content.lights) + 1)
        if plan.shadows and seen.any() and (len(shares) > 1 or self._buffers.sky.irradiance):
            ends = (extents.nearest[seen], extents.farthest[seen])
            self._receivers = light_views.receivers_of(plan, self._corners[seen], *ends)
            lights, sky = self._content.lights, self._buffers.sky
            shares = light_shares(lights, sky, self._receivers, self._spheres, seen)
        if shares.any():
            self._divide(plan, shares)
        self._fill_table()

    def _divide(self, plan, shares):
        """Choose the number of light samples, and whose turn it is at each."""
        side = 2 ** int(np.ceil(np.log2(max(plan.width, plan.height))))
        self._side = int(np.clip(side, _LEAST_SIDE, _MOST_SIDE))
        self._steady = _STEADY if plan.bokeh else 0
        most = min(_MOST_PLACES, _MOST_TEXELS // self._side**2) - self._steady
        group = GROUP if plan.chromatic else 1
        self._group = group
        self._each = self._places_of_sample(plan, shares[-1] / shares.sum())
        if plan.automatic:
            self._places = min(_PERIOD, most)
        else:
            total = -(-plan.samples // group) * self._each
            self._places = -(-total // -(-total // most))
        self._seed = plan.source.seed if plan.source else 0
        self._turns = turns_of(shares, self._places)
        self._schedule = schedule(self._turns, self._seed)
        self._steady_turns = turns_of(shares, self._steady)
        self._steady_schedule = schedule(self._steady_turns, self._seed)
        columns = _WIDEST_ATLAS // self._side
        count = self._steady + self._places
        columns = min(columns, int(np.ceil(np.sqrt(count))))
        size = (columns * self._side, -(-count // columns) * self._side)
        if self._targets is None or (self._targets.width, self._targets.height) != size:
            self.release()
            specs = [TargetSpec("maps", "DEPTH_COMPONENT32F")]
            self._targets = Targets(*size, specs)
        self._columns = columns
        self._begin_batch(0)

    def _places_of_sample(self, plan, of_sky):
        """Return from how many places a lens sample is lit; `of_sky`: the sky's share of light."""
        if plan.automatic:
            # The first look may be the last.
            return _MOST_EACH
        least = _LEAST_OF_LAMPS + of_sky * (_LEAST_OF_SKY - _LEAST_OF_LAMPS)
        wanted = 1.0 + float(plan.subsample_counts.mean())
        wanted = max(wanted, least * self._group / plan.samples)
        return int(np.clip(np.ceil(wanted - 1e-6), 1, _MOST_EACH))

    def _begin_batch(self, batch):
        """Take new places on the lights; those of the steady samples stay."""
        self._batch = batch
        self._samples = self._samples[: self._steady]
        if not self._samples:
            self._samples = self._aimed(self._steady_schedule, self._steady_turns, 0, 1)
        self._samples += self._aimed(self._schedule, self._turns, batch, 0)
        self._shown = {place for place in self._shown if place < self._steady}

    def _aimed(self, scheduled, turns, batch, stream):
        lights, count = self._content.lights, int(turns.sum())
        found = []
        for light, number in zip(*(part.tolist() for part in scheduled), strict=True):
            resources = {
                "weight": count / int(turns[light]),
                "number": number + batch * int(turns[light]),
                "stream": 2 * light + stream,
                "seed": self._seed,
                "receivers": self._receivers,
                "hiding": self._hiding,
            }
            if light < len(lights):
                found.append(aim_sample(lights[light], light, **resources))
            else:
                found.append(aim_sky_sample(self._buffers.sky, **resources))
        return found

    def _fill_table(self):
        rows = np.zeros((len(self._samples), light_map.ROW_TEXELS, 4), np.float32)
        for place, sample in enumerate(self._samples):
            steady = place < self._steady
            rows[place, 0] = (sample.light, sample.weight, len(sample.views), steady)
            rows[place, 1, :3] = sample.place
            rows[place, 2, :3] = sample.light_of_sky
            rectangles = self._rectangles(place, len(sample.views))
            for i, (view, rectangle) in enumerate(zip(sample.views, rectangles, strict=True)):
                first = light_map.HEAD_TEXELS + i * light_map.VIEW_TEXELS
                rows[place, first : first + light_map.VIEW_TEXELS] = view.texels(rectangle)
        skies = [self._sky_table(samples) for samples in self._sequences()]
        self._table = texture_2d(light_table.table_texels(self._content.lights, rows, skies))

    def _sequences(self):
        """Return the light samples of the two sequences that surfaces read, if there are any."""
        if not self._samples:
            return ()
        return self._samples[self._steady :], self._samples[: self._steady]

    def _sky_table(self, samples):
        of_sky = [sample for sample in samples if sample.light < 0]
        if not of_sky:
            return np.ones((NORMALS, NORMALS))
        directions = np.stack([sample.place for sample in of_sky])
        light = np.array([sample.light_of_sky for sample in of_sky])
        return self._buffers.sky.corrections(directions, light)

    def _rectangles(self, place, count):
        if not count:
            return []
        corner = (place % self._columns * self._side, place // self._columns * self._side)
        return light_views.tiles(count, corner, self._side)

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
        if not self._places:
            return self._bound(())
        batch = index // self._group * self._each // self._places
        if batch != self._batch:
            self._begin_batch(batch)
            self._fill_table()
        numbers = [
            (sample // self._group * self._each + i) % self._places
            for sample in samples
            for i in range(self._each)
        ]
        if len(numbers) > light_map.MOST_MAPS:
            numbers = numbers[:: -(-len(numbers) // light_map.MOST_MAPS)]
        return self._bound([self._steady + number for number in numbers])

    def shared(self):
        """Return what surfaces are lit by in drawings that all lens samples share."""
        numbers = np.unique(np.linspace(0, self._places, light_map.MOST_MAPS, False, dtype=int))
        return self._bound([self._steady + int(number) for number in numbers if self._places])

    def steady(self):
        """Return what highlights are found by."""
        return self._bound(range(self._steady))

    def _bound(self, places):
        steady = range(self._steady)
        for place in (*places, *steady):
            if place not in self._shown:
                self._draw_map(place)
        if self._targets is None:
            if self._empty is None:
                self._empty = texture_2d(np.ones((1, 1, 1), np.float32), "R32F")
            maps = self._empty
        else:
            maps = self._targets["maps"]
        own = light_map.packed(places, light_map.MOST_MAPS // 4)
        return light_map.Lighting(
            self._table, maps, own, light_map.packed(steady, light_map.MOST_STEADY // 4)
        )

    def _draw_map(self, place):
        sample = self._samples[place]
        self._targets.forget_framebuffers()
        framebuffer = self._targets.framebuffer(depth="maps")
        with framebuffer.bind():
            rectangles = self._rectangles(place, len(sample.views))
            for view, rectangle in zip(sample.views, rectangles, strict=True):
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
            light_map.draw(listed, params, casters.instances, place + (self._batch << 8))
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
