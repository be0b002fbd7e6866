"""What Blender itself hands to an engine, told apart from what the engine makes of it.

Blender's evaluation is not repeatable everywhere: the same text is filled with its triangles in
another order, metaballs get their vertices in another order, UVs of what a Bevel modifier has cut
differ in their last bits, and particles are elsewhere each time they are evaluated (bpy 5.2.3). Two
renders must be the same bits only where they were given the same scene.
"""

import hashlib
from contextlib import contextmanager
from unittest.mock import patch

import numpy as np

from addon.engine import session

# What values of an attribute are called in Blender, how many numbers they are, and of which kind.
_ATTRIBUTES = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int8),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "QUATERNION": ("value", 4, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}


@contextmanager
def digests_of_scenes():
    """Record a digest of each scene that is given to a final render inside a `with` block.

    Yields
    ------
    list of str
        One a view layer and view that is rendered.
    """
    digests = []

    class Recorder(session.SceneExtractor):
        def extract(self, depsgraph, *arguments, **options):
            digests.append(digest(depsgraph))
            return super().extract(depsgraph, *arguments, **options)

    with patch.object(session, "SceneExtractor", Recorder):
        yield digests


def digest(depsgraph):
    """Return a digest of the places and meshes of an evaluated scene, read without our readers.

    Of meshes: vertices, triangles, normals, and all attributes, UVs and colours among them.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph

    Returns
    -------
    str
    """
    found = hashlib.sha256()
    known = set()
    for instance in depsgraph.object_instances:
        obj = instance.object
        found.update(obj.name.encode())
        found.update(np.array(instance.matrix_world, np.float32).tobytes())
        data = obj.data
        if obj.type == "MESH" and data is not None and data.as_pointer() not in known:
            known.add(data.as_pointer())
            attributes = [
                (attribute.data, *_ATTRIBUTES[attribute.data_type])
                for attribute in data.attributes
                if attribute.data_type in _ATTRIBUTES
            ]
            for items, name, width, kind in (
                (data.vertices, "co", 3, np.float32),
                (data.loops, "vertex_index", 1, np.int32),
                (data.loop_triangles, "loops", 3, np.int32),
                (data.corner_normals, "vector", 3, np.float32),
                *attributes,
            ):
                values = np.zeros(len(items) * width, kind)
                items.foreach_get(name, values)
                found.update(values.tobytes())
    return found.hexdigest()
