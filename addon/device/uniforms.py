"""Uniform buffers made from bytes."""

import numpy as np

from . import census


def _buffer(data):
    import gpu

    values = np.frombuffer(data, np.float32).copy()
    return gpu.types.Buffer("FLOAT", values.size, values)


def uniform_buffer(data):
    """Upload the bytes of a uniform block.

    Parameters
    ----------
    data : bytes
        A multiple of 16 long.

    Returns
    -------
    GPUUniformBuf
    """
    import gpu

    return census.record("uniform_buffer", gpu.types.GPUUniformBuf(_buffer(data)), len(data))


def bind_resource(shader, name, resource):
    """Bind a uniform block, a number, a vector (tuple) or a texture, whichever it is.

    Textures are images where the name ends in ``_img``, else they are sampled.
    """
    import gpu

    if isinstance(resource, gpu.types.GPUUniformBuf):
        shader.uniform_block(name, resource)
    elif isinstance(resource, int):
        shader.uniform_int(name, resource)
    elif isinstance(resource, float | tuple):
        shader.uniform_float(name, resource)
    elif name.endswith("_img"):
        shader.image(name, resource)
    else:
        shader.uniform_sampler(name, resource)
