"""Meshes on the device: one vertex buffer a mesh, one batch a material slot."""

import zlib

import numpy as np

from . import census

_GLSL_TYPES = {2: "VEC2", 3: "VEC3", 4: "VEC4"}


def attribute_identifier(key):
    """Return the GLSL name of a mesh attribute such as ``"uv:UVMap"``.

    Blender keeps attribute names in a short buffer, so the name is the kind's letter and a hash.
    """
    kind = key.partition(":")[0]
    return f"{kind[0]}{zlib.crc32(key.encode()):08x}"


def attribute_type(components):
    """Return the GLSL type, in upper case, of an attribute with a number of components."""
    return _GLSL_TYPES[components]


class MeshBuffers:
    """The batches of a `MeshSnapshot`, by material slot.

    Attributes
    ----------
    batches : dict of int to (GPUBatch, int)
        Batch and number of triangles, by slot.
    bounds : ndarray of shape (2, 3)
        Lower and upper corner in object space.
    triangles : int
        Of all slots.
    bytes : int
    """

    def __init__(self, mesh):
        import gpu

        vertex_format = gpu.types.GPUVertFormat()
        columns = {"pos": mesh.positions}
        columns.update({attribute_identifier(k): v for k, v in mesh.attributes.items()})
        if mesh.motion:
            columns["pos_previous"], columns["pos_next"] = mesh.motion
        for name, values in columns.items():
            vertex_format.attr_add(
                id=name, comp_type="F32", len=values.shape[1], fetch_mode="FLOAT"
            )
        vertices = gpu.types.GPUVertBuf(vertex_format, len(mesh.positions))
        for name, values in columns.items():
            vertices.attr_fill(name, np.ascontiguousarray(values, np.float32))
        vertex_bytes = 4 * sum(values.size for values in columns.values())
        census.record("vertex_buffer", vertices, vertex_bytes)
        self.bounds = mesh.bounds
        self.triangles = len(mesh.triangles)
        self.bytes = vertex_bytes + 4 * mesh.triangles.size
        self.batches = {}
        for slot, first, count in mesh.slots:
            indices = np.ascontiguousarray(mesh.triangles[first : first + count], np.int32)
            elements = gpu.types.GPUIndexBuf(type="TRIS", seq=indices)
            census.record("index_buffer", elements, indices.nbytes)
            batch = gpu.types.GPUBatch(type="TRIS", buf=vertices, elem=elements)
            census.record("batch", batch)
            self.batches[slot] = (batch, count)


def fullscreen_batch():
    """Return a triangle that covers the whole target; attribute ``pos``."""
    import gpu

    vertex_format = gpu.types.GPUVertFormat()
    vertex_format.attr_add(id="pos", comp_type="F32", len=2, fetch_mode="FLOAT")
    vertices = gpu.types.GPUVertBuf(vertex_format, 3)
    vertices.attr_fill("pos", np.array([[-1, -1], [3, -1], [-1, 3]], np.float32))
    census.record("vertex_buffer", vertices, 24)
    return census.record("batch", gpu.types.GPUBatch(type="TRIS", buf=vertices))


def rectangles_batch(rectangles):
    """Return two triangles for each of some rectangles; attribute ``pos``.

    Parameters
    ----------
    rectangles : ndarray of shape (R, 4)
        Left, lower, right and upper edge, in clip space.
    """
    import gpu

    corners = np.asarray(rectangles, np.float32)[:, [0, 1, 2, 1, 0, 3, 0, 3, 2, 1, 2, 3]]
    corners = np.ascontiguousarray(corners.reshape(-1, 2))
    vertex_format = gpu.types.GPUVertFormat()
    vertex_format.attr_add(id="pos", comp_type="F32", len=2, fetch_mode="FLOAT")
    vertices = gpu.types.GPUVertBuf(vertex_format, len(corners))
    vertices.attr_fill("pos", corners)
    census.record("vertex_buffer", vertices, corners.nbytes)
    return census.record("batch", gpu.types.GPUBatch(type="TRIS", buf=vertices))


def square_batch():
    """Return two triangles over the unit square; attribute ``pos``."""
    import gpu

    vertex_format = gpu.types.GPUVertFormat()
    vertex_format.attr_add(id="pos", comp_type="F32", len=2, fetch_mode="FLOAT")
    corners = np.array([[0, 0], [1, 0], [0, 1], [0, 1], [1, 0], [1, 1]], np.float32)
    vertices = gpu.types.GPUVertBuf(vertex_format, len(corners))
    vertices.attr_fill("pos", corners)
    census.record("vertex_buffer", vertices, corners.nbytes)
    return census.record("batch", gpu.types.GPUBatch(type="TRIS", buf=vertices))


def numbered_batch(count):
    """Return triangles whose corners are only numbered, from 0; attribute ``corner``."""
    import gpu

    vertex_format = gpu.types.GPUVertFormat()
    vertex_format.attr_add(id="corner", comp_type="F32", len=1, fetch_mode="FLOAT")
    numbers = np.arange(count, dtype=np.float32)[:, None]
    vertices = gpu.types.GPUVertBuf(vertex_format, count)
    vertices.attr_fill("corner", numbers)
    census.record("vertex_buffer", vertices, numbers.nbytes)
    return census.record("batch", gpu.types.GPUBatch(type="TRIS", buf=vertices))
