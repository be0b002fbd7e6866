"""Processor seconds until shaders of many closures are compiled: 1, 6, 12 and 24 Principled nodes.

    python -m benchmarks.tools.compile_times
    python -m benchmarks.tools.compile_times --counts 1 6

Drivers compile at the first drawing, so each shader also draws one triangle. Processor time, not
time on the wall: other programs may be busy.
"""

import argparse
import os
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))


def principled_tree(count):
    """Return the graph of a number of Principled nodes, mixed one into the other."""
    from addon.snapshot.surface_graph import (
        DEFAULT_GRAPH,
        Constant,
        Link,
        ShaderNode,
        SurfaceGraph,
    )

    nodes, mixed = [], None
    for _ in range(count):
        nodes.append(DEFAULT_GRAPH.nodes[0])
        link = Link(len(nodes) - 1, "BSDF")
        if mixed is not None:
            pair = (("Fac", Constant((0.3,))), ("Shader", mixed), ("Shader_001", link))
            nodes.append(ShaderNode("mix_shader", pair))
            link = Link(len(nodes) - 1, "Shader")
        mixed = link
    return SurfaceGraph(tuple(nodes), mixed)


def compile_seconds(count):
    """Return processor seconds from the graph to the first drawing.

    Parameters
    ----------
    count : int
        Of Principled nodes.

    Returns
    -------
    float
    """
    import numpy as np

    from addon.device.geometry import MeshBuffers
    from addon.device.shaders import compile_shader
    from addon.device.targets import Targets, TargetSpec
    from addon.passes.nodes import surface_code
    from addon.passes.surface import surface, surface_target
    from addon.snapshot.content import MeshSnapshot

    corners = np.array([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]], np.float32)
    attributes = {"normal": np.tile(np.float32([0, 0, 1]), (3, 1))}
    triangle = np.array([[0, 1, 2]], np.int32)
    mesh = MeshSnapshot(1, "triangle", corners, triangle, ((0, 0, 1),), attributes)
    batch, _ = MeshBuffers(mesh).batches[0]
    with Targets(8, 8, [TargetSpec("color", "RGBA32F")]) as targets:
        start = time.process_time()
        code = surface_code.generate(principled_tree(count), attributes)
        info = surface.surface_info(surface_target.COLOR, code, attributes)
        shader = compile_shader(info)
        framebuffer = targets.framebuffer("color")
        with framebuffer.bind():
            shader.bind()
            _give_everything(shader, info)
            shader.draw_instanced(batch, 1)
            framebuffer.read_color(0, 0, 1, 1, 4, 0, "FLOAT")
        return time.process_time() - start


def _give_everything(shader, info):
    """Bind something to all that a shader declares."""
    import gpu

    from addon.device.uniforms import uniform_buffer

    for _, name in info.samplers:
        shader.uniform_sampler(name, gpu.types.GPUTexture((8, 8), format="RGBA32F"))
    for _, name in info.uniforms:
        shader.uniform_block(name, uniform_buffer(bytes(1 << 14)))
    for kind, name, *_ in info.push_constants:
        if kind.startswith("I"):
            shader.uniform_int(name, 0)
        else:
            shader.uniform_float(name, (0.0,) * 4 if kind == "VEC4" else 0.0)


def main(words=None):
    """Print a line for each number of nodes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--counts", type=int, nargs="+", default=[1, 6, 12, 24])
    options = parser.parse_args(words)
    # Mesa keeps what it has compiled.
    os.environ["MESA_SHADER_CACHE_DISABLE"] = "true"
    import bpy  # noqa: F401  (the graphics device is Blender's)
    import gpu

    gpu.init()
    # What is done once a process is no part of the first time.
    compile_seconds(0)
    for count in options.counts:
        print(f"{count:3} Principled: {compile_seconds(count):7.2f} s", flush=True)


if __name__ == "__main__":
    main()
