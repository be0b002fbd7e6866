"""The adaptive method's final renders against the reference method's: the same picture, sooner."""

import math

import numpy as np
import pytest

from addon.engine.shared_resources import listen
from tests.pictures import energy_ratio, save_side_by_side, ssim
from tests.surface_scenes import Tree

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

WIDTH, HEIGHT = 160, 90
# More than the places on the lens that 32 samples with 4 subsamples stand for.
TRUTH = 192
FOCUS = 6.0


def render(scene, method, samples=32, subsamples=4, **settings):
    """Render and return what became of it."""
    import bpy

    scene.render.engine = "APLANAT"
    own = scene.aplanat
    own.method, own.use_target_error = method, False
    own.render_samples, own.subsamples = samples, subsamples
    own.pixel_filter, scene.render.filter_size = "BOX", 1.0
    for name, value in settings.items():
        setattr(own, name, value)
    with listen(keep_pictures=True) as heard:
        bpy.ops.render.render(scene=scene.name)
    assert heard.error is None
    return heard


def passes(heard):
    """The pictures of a render by name, top row first."""
    found = heard.layers[0].passes
    return {name: picture.pixels[::-1] for name, picture in found.items()}


def combined(heard):
    return passes(heard)["Combined"]


def blob(bpy, name, place, radius, colors, parts=40):
    """A smooth ball of `parts` x `parts` quads, its colour varying from vertex to vertex."""
    import bmesh

    mesh = bpy.data.meshes.new(name)
    form = bmesh.new()
    bmesh.ops.create_uvsphere(form, u_segments=parts, v_segments=parts, radius=radius)
    form.to_mesh(mesh)
    form.free()
    vertices = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", vertices)
    height = vertices.reshape(-1, 3)[:, 2:] / radius
    shade = 0.5 + 0.5 * np.sin(4.0 * height)
    rgba = np.ones((len(height), 4), np.float32)
    rgba[:, :3] = shade * colors[0] + (1.0 - shade) * colors[1]
    mesh.color_attributes.new("Col", "FLOAT_COLOR", "POINT").data.foreach_set("color", rgba.ravel())
    material = bpy.data.materials.new(name)
    material.node_tree.nodes.clear()
    tree = Tree(material.node_tree)
    color = tree.node("VertexColor", layer_name="Col").outputs["Color"]
    tree.emission(color)
    mesh.materials.append(material)
    made = bpy.data.objects.new(name, mesh)
    made.location = place
    bpy.context.scene.collection.objects.link(made)
    return made


def surface_of(thing):
    """Clear an object's material for another surface."""
    tree = thing.data.materials[0].node_tree
    tree.nodes.clear()
    return Tree(tree)


@pytest.fixture
def scene(empty_scene, aplanat_bpy):
    """Balls before, in and behind the focus, in a grey world, through a three-bladed iris."""
    bpy = aplanat_bpy
    scene = empty_scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    world = bpy.data.worlds.new("grey")
    scene.world = world
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.22, 0.25, 1.0)
    blob(bpy, "Near", (-0.7, 3.0, -0.3), 0.35, ((1.0, 0.4, 0.1), (0.3, 0.02, 0.0)))
    blob(bpy, "Focus", (0.1, FOCUS, 0.0), 0.7, ((0.1, 0.7, 0.2), (0.9, 0.9, 0.3)))
    blob(bpy, "Far", (2.6, 12.0, 0.6), 1.3, ((0.2, 0.3, 1.0), (0.8, 0.8, 1.0)))
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    camera.rotation_euler = (math.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    dof = data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, FOCUS, 0.06
    dof.aperture_blades, dof.aperture_rotation = 3, 0.4
    return scene


def check(scene, tmp_path, least_ssim, energy=0.01, **settings):
    """Compare both methods; return the adaptive render."""
    adaptive = render(scene, "ADAPTIVE", **settings)
    reference = combined(render(scene, "REFERENCE", TRUTH))
    picture = combined(adaptive)
    save_side_by_side(tmp_path / "adaptive_reference_difference.png", picture, reference)
    assert np.isfinite(picture).all()
    assert ssim(picture, reference) > least_ssim, tmp_path
    assert energy_ratio(picture, reference) == pytest.approx(1.0, abs=energy), tmp_path
    alpha = [image[..., 3].mean() for image in (picture, reference)]
    assert alpha[0] == pytest.approx(alpha[1], abs=0.005), tmp_path
    return adaptive


def test_the_adaptive_picture_is_the_reference(scene, tmp_path):
    # Measured 0.9971; without subsamples 0.9935.
    work = check(scene, tmp_path, 0.995).statistics
    assert work.subsamples == pytest.approx(4.0)
    assert work.triangles_submitted < 0.6 * work.triangles_full_detail
    assert work.sprites_copied > work.sprites_drawn > 0


def test_more_samples_come_nearer_to_the_reference(scene):
    reference = combined(render(scene, "REFERENCE", TRUTH))
    found = [ssim(combined(render(scene, "ADAPTIVE", n)), reference) for n in (8, 32, 128)]
    assert found[0] < found[1] < found[2]


def test_without_a_lens_both_methods_draw_the_same_bits(scene):
    scene.camera.data.dof.use_dof = False
    adaptive = render(scene, "ADAPTIVE", use_sharing=False)
    reference = render(scene, "REFERENCE")
    work = adaptive.statistics
    assert work.subsamples == 0.0
    assert work.triangles_submitted == reference.statistics.triangles_submitted
    # The scene has fewer triangles than pixels: otherwise the reference's raster would be finer.
    assert work.subpixels == reference.statistics.subpixels == 1
    assert combined(adaptive).tobytes() == combined(reference).tobytes()


def test_without_a_lens_shared_drawings_move_edges_by_less_than_a_cell(scene):
    scene.camera.data.dof.use_dof = False
    shared = render(scene, "ADAPTIVE")
    alone = render(scene, "ADAPTIVE", use_sharing=False)
    # Cells of half a pixel: places within a pixel fall into 3 x 3 of them, for each of three balls.
    assert shared.statistics.sprites_drawn <= 9 * 3
    # Cells with two or three places are drawn: their copies would cost more than these balls.
    assert shared.statistics.triangles_submitted < 0.5 * alone.statistics.triangles_submitted
    difference = np.abs(combined(shared) - combined(alone))[..., :3]
    # An edge of contrast 1 that moves by a quarter of a pixel at most; most pixels have none.
    assert difference.max() < 0.3
    assert difference.mean() < 0.004


def test_what_lets_light_through_is_drawn_with_sharing(scene, aplanat_bpy, tmp_path):
    # In focus, so that its drawings would be shared if it hid everything behind it.
    tree = surface_of(aplanat_bpy.data.objects["Focus"])
    glow = tree.node("Emission", {"Color": (0.9, 0.5, 0.1)})
    clear = tree.node("BsdfTransparent")
    sockets = {"Fac": 0.5, "Shader": glow.outputs[0], "Shader_001": clear.outputs[0]}
    tree.surface(tree.node("MixShader", sockets).outputs[0])
    # Which of two surfaces is seen is drawn by lot for each pixel and sample: of 32 lots a pixel's
    # mean has a deviation of 0.09 of their difference. The mean over all pixels has none. Measured
    # 0.968.
    check(scene, tmp_path, 0.94)


def test_what_only_adds_light_is_drawn_with_sharing(scene, aplanat_bpy, tmp_path):
    tree = surface_of(aplanat_bpy.data.objects["Near"])
    glow = tree.node("Emission", {"Color": (0.5, 0.2, 0.1)})
    clear = tree.node("BsdfTransparent")
    sockets = {"Shader": glow.outputs[0], "Shader_001": clear.outputs[0]}
    tree.surface(tree.node("AddShader", sockets).outputs[0])
    check(scene, tmp_path, 0.99)


@pytest.mark.parametrize("name", ["Near", "Focus"])
def test_a_holdout_is_drawn_with_sharing(scene, aplanat_bpy, tmp_path, name):
    scene.render.film_transparent = True
    aplanat_bpy.data.objects[name].is_holdout = True
    adaptive = check(scene, tmp_path, 0.985, energy=0.01)
    assert combined(adaptive)[..., 3].min() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("surface", ["opaque", "clear", "glow", "holdout"])
def test_what_reaches_through_the_focus_is_drawn_coarser_where_it_blurs(
    scene, aplanat_bpy, tmp_path, surface
):
    bpy = aplanat_bpy
    long = blob(bpy, "Long", (0.0, FOCUS, -1.0), 0.5, ((0.2, 0.4, 0.9), (0.9, 0.8, 0.2)), 160)
    long.scale = (1.0, 6.0, 0.6)
    if surface == "holdout":
        scene.render.film_transparent = long.is_holdout = True
    elif surface != "opaque":
        tree = surface_of(long)
        light = tree.node("Emission", {"Color": (0.4, 0.2, 0.1)})
        clear = tree.node("BsdfTransparent")
        kind = "MixShader" if surface == "clear" else "AddShader"
        sockets = {"Shader": light.outputs[0], "Shader_001": clear.outputs[0]}
        if surface == "clear":
            sockets["Fac"] = 0.5
        tree.surface(tree.node(kind, sockets).outputs[0])
    # Clear: drawn by lot for each pixel and sample, as above.
    work = check(scene, tmp_path, 0.94 if surface == "clear" else 0.985).statistics
    # The long ball has 50 000 triangles, the other three 9 000 together.
    assert work.triangles_submitted < 0.6 * work.triangles_full_detail


def test_an_image_around_the_scene_is_blurred_where_nothing_stands_before_it(
    scene, aplanat_bpy, tmp_path
):
    v, u = np.mgrid[0:64, 0:128] / np.array([64.0, 128.0])[:, None, None]
    pixels = np.ones((64, 128, 4), np.float32)
    for channel, turns in enumerate((6, 9, 14)):
        pixels[..., channel] = 0.5 + 0.5 * np.sin(2 * np.pi * (turns * u + channel * v))
    made = aplanat_bpy.data.images.new("waves", 128, 64, float_buffer=True)
    made.pixels.foreach_set(pixels.ravel())
    made.update()
    made.pack()
    scene.world.node_tree.nodes.clear()
    tree = Tree(scene.world.node_tree, "ShaderNodeOutputWorld")
    color = tree.node("TexEnvironment", image=made).outputs[0]
    tree.surface(tree.node("Background", {"Color": color}).outputs[0])
    check(scene, tmp_path, 0.99)


def test_a_parallel_camera_blurs_the_same(scene, tmp_path):
    data = scene.camera.data
    data.type, data.ortho_scale = "ORTHO", 6.0
    data.dof.aperture_fstop = 0.3
    check(scene, tmp_path, 0.99)


def test_the_same_frame_twice_is_the_same_bits(scene):
    scene.view_layers[0].use_pass_cryptomatte_object = True
    scene.view_layers[0].aplanat.use_pass_focus_matte = True
    first, second = (passes(render(scene, "ADAPTIVE")) for _ in range(2))
    for name, picture in first.items():
        assert picture.tobytes() == second[name].tobytes(), name


def test_mattes_are_those_of_the_reference(scene):
    layer = scene.view_layers[0]
    layer.use_pass_cryptomatte_object = layer.use_pass_z = True
    layer.aplanat.use_pass_focus_matte = True
    found, expected = passes(render(scene, "ADAPTIVE", 64)), passes(render(scene, "REFERENCE", 256))
    assert list(found) == list(expected)
    # They take the places of the samples alone, 64 of them: an edge of contrast 1 in strong blur
    # has a deviation of 0.06 a pixel.
    focus = np.abs(found["Focus Matte"] - expected["Focus Matte"])
    assert focus.mean() < 0.01
    assert np.array_equal(found["Depth"], expected["Depth"])
    for object_id in np.unique(expected["CryptoObject00"][..., ::2]):
        shares = []
        for pictures in (found, expected):
            ranks = [p for n, p in pictures.items() if n.startswith("CryptoObject")]
            share = np.zeros((HEIGHT, WIDTH))
            for rank in ranks:
                for channel in (0, 2):
                    hit = rank[..., channel] == object_id
                    share += np.where(hit, rank[..., channel + 1], 0.0)
            shares.append(share)
        assert np.abs(shares[0] - shares[1]).mean() < 0.01, object_id
        assert shares[0].mean() == pytest.approx(shares[1].mean(), abs=0.003), object_id


def test_levels_follow_a_mesh_that_deforms(scene, aplanat_bpy, tmp_path):
    near = aplanat_bpy.data.objects["Near"]
    near.shape_key_add(name="Basis")
    bent = near.shape_key_add(name="Bent")
    for point in bent.points:
        x, y, z = point.co
        point.co = (x + 0.8 * z * z, y, 1.3 * z)
    for frame, value in ((1, 0.0), (4, 1.0)):
        bent.value = value
        bent.keyframe_insert("value", frame=frame)
    made = []
    for frame in range(1, 5):
        scene.frame_set(frame)
        adaptive = render(scene, "ADAPTIVE")
        reference = combined(render(scene, "REFERENCE", TRUTH))
        picture = combined(adaptive)
        save_side_by_side(tmp_path / f"{frame}.png", picture, reference)
        assert ssim(picture, reference) > 0.995, tmp_path
        work = adaptive.statistics
        assert work.triangles_submitted < 0.6 * work.triangles_full_detail
        made.append((work.decimations, work.replays))
    # Simplified once at most (an earlier test may have had the same mesh), then bent along.
    assert all(decimations == 0 for decimations, _ in made[1:])
    assert all(replays == 1 for _, replays in made[1:])


def test_a_bias_that_spends_all_levels_draws_in_full_detail(scene):
    full = render(scene, "ADAPTIVE", use_levels=False, use_sharing=False, level_bias=0.0)
    biased = render(scene, "ADAPTIVE", use_levels=True, use_sharing=False, level_bias=16.0)
    scene.aplanat.level_bias = 0.0
    assert biased.statistics.triangles_submitted == full.statistics.triangles_submitted
    assert combined(biased).tobytes() == combined(full).tobytes()
