"""Bokeh on OpenGL and on Vulkan: every shader that it needs compiles and the pictures agree."""

import numpy as np
import pytest

from benchmarks.bokeh.charts import FOCUS, many_highlights
from tests import surface_scenes
from tests.pictures import ssim

SIZE, LAMPS = (112, 63), 90
# By name: sources, visibility, debug view, real lens (focused near, or it would blur nothing).
MODES = {
    "raster": ("POINT", "RASTER", "NONE", ""),
    "warp": ("POINT", "WARP", "NONE", ""),
    "splat": ("POINT", "SPLAT", "NONE", ""),
    "clusters": ("CLUSTERED", "RASTER", "NONE", ""),
    "lens": ("CLUSTERED", "WARP", "NONE", "planar-50mm-f1.4"),
    "sources": ("POINT", "AUTO", "SOURCES", ""),
    "cluster_marks": ("CLUSTERED", "AUTO", "CLUSTERS", ""),
    "fates": ("POINT", "AUTO", "VISIBILITY", ""),
}

# Runs inside Blender.
CODE = """
import importlib, sys
import bpy, gpu
import numpy as np

folder, *modes = sys.argv[sys.argv.index("--") + 1 :]
shared = importlib.import_module("bl_ext.user_default.aplanat.addon.engine.shared_resources")
scene = bpy.context.scene
camera = scene.camera.data
bokeh = camera.aplanat.bokeh
focus = camera.dof.focus_distance
result = {}
for mode in modes:
    name, bokeh.model, bokeh.visibility, bokeh.debug_view, camera.aplanat.lens = mode.split(",")
    camera.dof.focus_distance = 0.5 if camera.aplanat.lens else focus
    bokeh.hardness = 0.8 if bokeh.model == "CLUSTERED" else 0.0
    with shared.listen(keep_pictures=True) as heard:
        bpy.ops.render.render()
    if heard.error:
        raise heard.error
    pixels = heard.layers[0].passes["Combined"].pixels
    np.save(f"{folder}/{name}.npy", pixels)
    result[name] = heard.statistics.highlights
result["backend"] = gpu.platform.backend_type_get()
"""


@pytest.fixture(scope="session")
def lamps_blend(aplanat_bpy, tmp_path_factory):
    """Lamps of light and a glossy ball under a light, behind bars."""
    bpy = aplanat_bpy
    scene = many_highlights(SIZE, LAMPS)
    material = bpy.data.materials.new("gloss")
    material.node_tree.nodes.clear()
    tree = surface_scenes.Tree(material.node_tree)
    inputs = {"Base Color": (0.8, 0.6, 0.3), "Roughness": 0.15, "Metallic": 1.0}
    tree.surface(tree.node("BsdfPrincipled", inputs).outputs[0])
    mesh = bpy.data.meshes.new("ball")
    surface_scenes.bmesh_sphere(mesh)
    mesh.materials.append(material)
    ball = bpy.data.objects.new("ball", mesh)
    ball.location, ball.scale = (0.5, 2.0 * FOCUS, 0.3), (0.6,) * 3
    scene.collection.objects.link(ball)
    surface_scenes.add_light(bpy, "POINT", (-3.0, 0.0, 4.0), energy=2000.0)
    own = scene.aplanat
    own.method, own.use_target_error = "ADAPTIVE", False
    own.render_samples, own.subsamples = 4, 2
    scene.camera.data.aplanat.bokeh.use = True
    path = tmp_path_factory.mktemp("lamps") / "lamps.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


@pytest.mark.slow
def test_vulkan_draws_the_bokeh_that_opengl_does(blender, lamps_blend, tmp_path):
    found = {}
    modes = [",".join(map(str, (name, *mode))) for name, mode in MODES.items()]
    for backend in ("opengl", "vulkan"):
        (tmp_path / backend).mkdir()
        options = ("--gpu-backend", backend)
        arguments = (tmp_path / backend, *modes)
        found[backend] = blender.run_code(
            CODE, *arguments, blend=lamps_blend, options=options
        ).result
        assert found[backend].pop("backend").lower() == backend
    for name in MODES:
        counts = [found[backend][name] for backend in ("opengl", "vulkan")]
        assert min(count["splatted"] for count in counts) > 50, name
        # Places at the edge of a pixel or a bound may fall to either side.
        for key, number in counts[0].items():
            assert abs(counts[1][key] - number) <= 2 + 0.01 * number, (name, key)
        opengl, vulkan = (np.load(tmp_path / b / f"{name}.npy") for b in ("opengl", "vulkan"))
        assert opengl[..., :3].max() > 0.5, name
        assert ssim(vulkan, opengl) >= 0.999, name
