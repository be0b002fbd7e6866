"""A scene's meshes, images, materials and instances on the device.

Content is found by uid: what the previous content had already is not uploaded again, and what the
new one lacks is released.
"""

from dataclasses import replace

import numpy as np

from ..device.census import size_of_texture
from ..device.geometry import MeshBuffers
from ..device.textures import image_texture, texture_2d
from ..device.uniforms import uniform_buffer

# Must agree with lib/instance_lib.glsl.
INSTANCES_PER_ROW = 256


class SceneBuffers:
    """Device-side copies of a scene's content, updated by difference.

    Attributes
    ----------
    meshes : dict of int to MeshBuffers
    images : dict of int to GPUTexture
    instances : GPUTexture
    uploads : dict of str to int
        How many meshes, images, materials and instance tables were uploaded so far.
    """

    def __init__(self):
        self.meshes = {}
        self.images = {}
        self.instances = None
        self.uploads = {"meshes": 0, "images": 0, "materials": 0, "instance_tables": 0}
        self._materials = {}
        self._instance_table = None
        self._content = None

    def update(self, content):
        """Upload what is new in a `SceneContent` and release what it lacks."""
        for _ in self.update_steps(content):
            pass

    def update_steps(self, content):
        """Do what `update` does in steps; left half done, the next call completes it."""
        if content is self._content:
            return
        self._content = None
        for uid in self.meshes.keys() - content.meshes.keys():
            del self.meshes[uid]
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
        self._content = content

    def texture_bytes(self):
        """Return how many bytes the images and the instance table take on the device."""
        textures = [*self.images.values(), *([self.instances] if self.instances else [])]
        return sum(map(size_of_texture, textures))

    def geometry_bytes(self):
        """Return how many bytes the meshes take on the device."""
        return sum(mesh.bytes for mesh in self.meshes.values())

    def neighbouring_instances(self, instances):
        """Return the instance tables of the previous and the next frame.

        They are uploaded when they are asked for; what has none stands still.

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


def instance_texels(instances):
    """Lay out the instance table as `lib/instance_lib.glsl` reads it.

    Parameters
    ----------
    instances : InstanceTable

    Returns
    -------
    ndarray of shape (rows, 1024, 4)
        float32.
    """
    count = len(instances.world)
    rows = max(1, -(-count // INSTANCES_PER_ROW))
    texels = np.zeros((rows * INSTANCES_PER_ROW, 4, 4), np.float32)
    texels[:count, :3] = instances.world[:, :3]
    texels[:count, 3, 0] = instances.cryptomatte_id
    return texels.reshape(rows, INSTANCES_PER_ROW * 4, 4)
