"""Pictures through compositing nodes, as a background render gives them."""

import numpy as np
import pytest

from benchmarks.scenes.compositor_nodes import Nodes

SIZE = (48, 32)


@pytest.fixture
def scene(aplanat_bpy, empty_scene, camera):
    """A scene that Cycles renders at once; what counts are its compositing nodes."""
    scene = empty_scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    return scene


@pytest.fixture
def nodes(aplanat_bpy, scene):
    """Make nodes; `through(build)` renders what `build(tree)` returns, bottom row first."""
    return Nodes(aplanat_bpy, scene)


@pytest.fixture
def noise():
    """A picture of random colours and alpha, some brighter than 1."""
    pixels = 3.0 * np.random.default_rng(1).random((SIZE[1], SIZE[0], 4), np.float32)
    pixels[..., 3] /= 3.0
    return pixels
