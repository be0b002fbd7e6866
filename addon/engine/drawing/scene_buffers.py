"""A scene's meshes, images, materials and instances on the device.

Parts are identified by uid: parts that the previous content had are not uploaded again, and parts
that the new content lacks are released.
"""

from dataclasses import replace

import numpy as np

from ...device.census import size_of_texture
from ...device.geometry import MeshBuffers
from ...device.textures import TextureCache, image_texture, texture_2d
from ...device.uniforms import uniform_buffer
from ...levels.bent_levels import unbent_levels
from ...levels.making.graded_levels import MergeTree
from ...passes.surface import environment, environment_bake
from ...sampling.lights.sky_samples import Sky
from .occluders import ShapeCache

# Columns of a world's image from which directions of its light are chosen.
_SKY_TEXELS, _LEAST_SKY_TEXELS = 256, 64
# Must agree with lib/surface/instance_lib.glsl.
INSTANCES_PER_ROW = 256
INSTANCE_TEXELS = 6


class SceneBuffers:
    """Device-side copies of a scene's content, updated by difference.

    Parameters
    ----------
    look_textures : TextureCache or None
        Of the session; None: its own.

    Attributes
    ----------
    meshes : dict of int to MeshBuffers
    images : dict of int to GPUTexture
    levels : dict of int to tuple of MeshBuffers
        Levels of detail from 1 up, by the mesh's uid.
    levels_version : int
        Grows when levels are added.
    shapes : ShapeCache
        Meshes as occluders of highlights.
    look_textures : TextureCache
        Textures of the appearance of bokeh discs.
    expected_pairs : int
        Pairs of highlight and cluster of triangles in the last frame; see
        `engine.visibility.stage`.
    instances : GPUTexture
        The instance table.
    lighting : tuple of (str, GPUUniformBuf or GPUTexture)
        Resources of lit surfaces: the world.
    unseen : SceneBuffers or None
        Of what only hides light.
    sky : sampling.lights.sky_samples.Sky
        The world that lights the scene.
    environment_buffer, environment_image : GPUUniformBuf, GPUTexture or None
        The world for the background; no image where it is one colour.
    captured : engine.layered.stack_layers.StackLayers or None
        A captured picture, where one takes the place of the content.
    uploads : dict of str to int
        Numbers of meshes, images, materials and instance tables that were uploaded, of
        environments that were prefiltered, and of meshes whose levels were uploaded so far.
    """

    def __init__(self, look_textures=None):
        self.look_textures = TextureCache() if look_textures is None else look_textures
        self.meshes = {}
        self.images = {}
        self.levels = {}
        self.levels_version = 0
        self.shapes = ShapeCache()
        self.expected_pairs = 0
        self.captured = None
        self.instances = None
        self.lighting = ()
        self.unseen = self.sky = None
        self._shown = _Environment()
        self._lit_by = _Environment()
        self.uploads = dict.fromkeys(
            ("meshes", "images", "materials", "instance_tables", "environments", "levels"), 0
        )
        self._level_meshes = {}
        self._merge_trees = {}
        self._unbent = {}
        self._fixed = None
        self._materials = {}
        self._instance_table = None
        self._content = None

    def update(self, content):
        """Upload the new parts of a `SceneContent`, and release those that it lacks."""
        for _ in self.update_steps(content):
            pass

    def update_steps(self, content):
        """Do what `update` does in steps; if they are abandoned, the next call completes them."""
        if content is self._content:
            return
        self._content = None
        for uid in self.meshes.keys() - content.meshes.keys():
            del self.meshes[uid]
            for kept in self._made_of_levels():
                kept.pop(uid, None)
        levels = (level.uid for levels in self._level_meshes.values() for level in levels)
        self.shapes.keep({*content.meshes, *levels})
        for uid in self.images.keys() - content.images.keys():
            del self.images[uid]
        for key in [k for k in self._materials if k[0] not in content.materials]:
            del self._materials[key]
        for uid, mesh in content.meshes.items():
            if uid not in self.meshes:
                self.meshes[uid] = MeshBuffers(mesh)
                self.uploads["meshes"] += 1
                yield
        for uid, image in content.images.items():
            if uid not in self.images:
                self.images[uid] = image_texture(image)
                self.uploads["images"] += 1
                yield
        if self._instance_table is not content.instances:
            self.instances = texture_2d(instance_texels(content.instances))
            self._instance_table = content.instances
            self.uploads["instance_tables"] += 1
        yield from self._update_lighting(content)
        if content.unseen is None:
            self.unseen = None
        else:
            self.unseen = self.unseen or SceneBuffers(self.look_textures)
            yield from self.unseen.update_steps(content.unseen)
        self._content = content

    def _update_lighting(self, content):
        if self._fixed is None:
            self._fixed = (environment.ggx_texture(), environment.single_texel())
        shown = content.world
        # One that lights the scene, too, is prefiltered; another is made for that alone.
        lit_by = self._shown if shown.lighting is None else self._lit_by
        for found, world in ((self._shown, shown), (lit_by, shown.lighting or shown)):
            if found.update(world, content.images, self.images, found is lit_by):
                self.uploads["environments"] += 1
                yield
        self.sky = lit_by.sky[1]
        table_of_ggx, empty = self._fixed
        self.lighting = (
            ("environment_buf", lit_by.buffer),
            ("environment_tx", lit_by.image or empty),
            ("environment_levels_tx", lit_by.levels or empty),
            ("ggx_tx", table_of_ggx),
        )

    @property
    def environment_buffer(self):
        """The world behind all surfaces."""
        return self._shown.buffer

    @property
    def environment_image(self):
        """Its image; None where it is one colour."""
        return self._shown.image

    def mesh_levels(self, uid):
        """Return the buffers of a mesh at each uploaded level of detail, from 0 up."""
        return (self.meshes[uid], *self.levels.get(uid, ()))

    def level_meshes(self, mesh):
        """Return the snapshots of a mesh at each uploaded level of detail, from 0 up."""
        return (mesh, *self._level_meshes.get(mesh.uid, ()))

    def add_levels(self, uid, levels):
        """Upload the levels of detail of a mesh.

        Parameters
        ----------
        uid : int
            Of a mesh of the content.
        levels : sequence of MeshLevel
            From level 1 up.
        """
        self.levels[uid] = tuple(MeshBuffers(level) for level in levels)
        self.uploads["levels"] += 1
        self._level_meshes[uid] = tuple(levels)
        for made_of_them in (self._merge_trees, self._unbent):
            made_of_them.pop(uid, None)
        self.levels_version += 1

    def set_levels(self, levels):
        """Have the levels of detail of some meshes and of no other, in steps.

        Parameters
        ----------
        levels : dict of int to sequence of MeshLevel
            By the mesh's uid.
        """
        for uid in self.levels.keys() - levels.keys():
            for kept in self._made_of_levels():
                kept.pop(uid, None)
            self.levels_version += 1
        for uid, meshes in levels.items():
            if self._level_meshes.get(uid) != tuple(meshes):
                self.add_levels(uid, meshes)
                yield

    def _made_of_levels(self):
        return self.levels, self._level_meshes, self._merge_trees, self._unbent

    def unbent_levels(self, uid, keys):
        """Return how many uploaded levels of a mesh keep the distributions of some attributes.

        Parameters
        ----------
        uid : int
        keys : frozenset of str
            See `levels.bent_levels.unbent_levels`.

        Returns
        -------
        int
        """
        known = self._unbent.setdefault(uid, {})
        if keys not in known:
            known[keys] = unbent_levels(self._content.meshes[uid], self._level_meshes[uid], keys)
        return known[keys]

    def merge_tree(self, uid, deepest):
        """Return the `MergeTree` of a mesh down to an uploaded level, made at its first use."""
        trees = self._merge_trees.setdefault(uid, {})
        if deepest not in trees:
            levels = self._level_meshes[uid][:deepest]
            trees[deepest] = MergeTree(self._content.meshes[uid], levels)
        return trees[deepest]

    def drop_levels(self):
        """Release the levels of detail; full detail is drawn until new ones are added."""
        for kept in self._made_of_levels():
            kept.clear()
        self.levels_version += 1

    def texture_bytes(self):
        """Return how many bytes the images and the instance table take on the device."""
        textures = [*self.images.values(), *([self.instances] if self.instances else [])]
        return sum(map(size_of_texture, textures))

    def geometry_bytes(self):
        """Return how many bytes the meshes take on the device."""
        levels = (level for levels in self.levels.values() for level in levels)
        return sum(mesh.bytes for mesh in (*self.meshes.values(), *levels))

    def neighbouring_instances(self, instances):
        """Return the instance tables of the previous and the next frame.

        Uploaded at each call; instances without neighbouring transforms stand still.

        Parameters
        ----------
        instances : InstanceTable

        Returns
        -------
        tuple of two GPUTexture
        """
        return tuple(
            self.instances
            if world is None
            else texture_2d(instance_texels(replace(instances, world=world)))
            for world in (instances.previous_world, instances.next_world)
        )

    def material_constants(self, uid, code):
        """Return the uniform block of a material, uploading it at its first use."""
        key = (uid, code.constants)
        buffer = self._materials.get(key)
        if buffer is None:
            buffer = uniform_buffer(np.array(code.constants, np.float32).tobytes())
            self._materials[key] = buffer
            self.uploads["materials"] += 1
        return buffer


class _Environment:
    """A world on the device: its block, its image, and its levels for lighting; and its `Sky`."""

    def __init__(self):
        self.buffer = self.image = self.levels = None
        self.sky = self._small = None
        self._world = None

    def update(self, world, images, textures, lights):
        """Take a world; `lights` prefilters its image. Returns whether something was computed."""
        known = self._world and (self._world.image, self._world.amplification, self._world.graph)
        same_image = known == (world.image, world.amplification, world.graph)
        computes = bool(world.image) and (not same_image or (lights and self.levels is None))
        if not same_image:
            self.image = self.levels = self._small = None
        if computes:
            self._compute(world, images, textures, lights)
        if self._world != world:
            self.buffer = environment.environment_buffer(world)
            self._world = world
        if lights and (computes or self.sky is None or self.sky[0] != world):
            small = np.ones((32, 64, 3)) if self._small is None else self._small
            lit = small * np.array(world.color)
            self.sky = (world, Sky(lit, np.array(world.rotation, np.float64)))
        return computes

    def _compute(self, world, images, textures, lights):
        image = images[world.image]
        if world.graph is None:
            pixels = image.linear_colors()
        else:
            pixels = environment_bake.bake(world.graph, images, textures)
        pixels = environment.world_pixels(pixels, world)
        if lights:
            self.levels = environment.prefilter(pixels)
            small = environment.shrink(pixels, _SKY_TEXELS)
            self._small = environment.squared(small, _LEAST_SKY_TEXELS).astype(np.float64)
        changed = world.graph is not None or world.amplification
        if image.srgb or image.pixels.dtype == np.uint8 or changed:
            opaque = np.ones((*pixels.shape[:2], 1), np.float32)
            self.image = texture_2d(np.concatenate([pixels, opaque], axis=2))
        else:
            self.image = textures[image.uid]


def instance_texels(instances, detail=None):
    """Lay out the instance table as `lib/surface/instance_lib.glsl` reads it.

    Parameters
    ----------
    instances : InstanceTable
    detail : ndarray of shape (I, 2), optional
        Level of detail, and share of the lens samples that copy a shared drawing.

    Returns
    -------
    ndarray of shape (rows, 1536, 4)
        float32.
    """
    count = len(instances.world)
    rows = max(1, -(-count // INSTANCES_PER_ROW))
    texels = np.zeros((rows * INSTANCES_PER_ROW, INSTANCE_TEXELS, 4), np.float32)
    texels[:count, :3] = instances.world[:, :3]
    texels[:count, 3, 0] = instances.cryptomatte_id
    if detail is not None:
        texels[:count, 3, 1:3] = detail
    if instances.looks is not None:
        texels[:count, 4] = instances.looks[:, :4]
        texels[:count, 5, :2] = instances.looks[:, 4:]
    return texels.reshape(rows, INSTANCES_PER_ROW * INSTANCE_TEXELS, 4)
