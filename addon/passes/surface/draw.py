"""Draw calls of surfaces."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Draw:
    """One draw call.

    Parameters
    ----------
    shader : GPUShader
    batch : GPUBatch
    triangles : int
        Of one instance.
    first, count : int
        Rows of the instance table.
    constants : GPUUniformBuf or None
    textures : tuple of (str, GPUTexture)
    transparent : bool
        Its opacity is decided by a random number per sample, so lens samples share no drawing.
    lighting : tuple of (str, GPUUniformBuf or GPUTexture)
        What a lit surface reads of the lights and the world, the same for all of them.
    material_id : float or None
        Cryptomatte id, where the shader reads it.
    group : int
        Which of the content's groups is drawn.
    level : int
        Its level of detail.
    slot : int
        The material slot of its mesh.
    slack : float
        How far its triangles may be from the true surface, in the mesh's units.
    part : {None, 'GLOW', 'FILTER'}
        What of the surface is drawn; see `surface.build_veils`.
    refracts : bool
        It reads `surface.GLASS_TEXTURES` and ``glass_buf``.
    deferred : deferred.Deferred or None
        It is shaded once a pixel, by `shader`.
    """

    shader: object
    batch: object
    triangles: int
    first: int
    count: int
    constants: object
    textures: tuple
    transparent: bool
    lighting: tuple = ()
    material_id: float | None = None
    group: int = 0
    level: int = 0
    slot: int = 0
    slack: float = 0.0
    part: str | None = None
    refracts: bool = False
    deferred: object | None = None


def by_level(draws):
    """Return draws by group and level of detail, dict of (int, int) to list of Draw."""
    found = {}
    for draw in draws:
        found.setdefault((draw.group, draw.level), []).append(draw)
    return found
