"""Colours of surfaces equal those of Cycles: exactly where they are unlit, closely where lit."""

import math

import numpy as np
import OpenEXR
import pytest

from tests.pictures import (
    energy_ratio,
    render_aplanat,
    render_cycles,
    save_side_by_side,
    srgb,
    ssim,
)
from tests.surface_scenes import (
    Tree,
    add_light,
    add_uv,
    both,
    card_scene,
    image,
    random_pixels,
    sphere_scene,
    world_image,
)

# Cycles' 16 samples lie within 0.01 pixel of ours, and a pixel is up to a third of a texel here:
# that and its rare stray sample are all that may differ. A wrong decoding, order of operations or
# texel differs by whole percents everywhere.
MEAN = 2e-4
SHARE_OFF = 0.03
OFF = 1e-3


@pytest.fixture
def bpy(aplanat_bpy):
    return aplanat_bpy


def assert_equal_pixel_by_pixel(scene, tmp_path):
    ours, cycles = both(scene)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    difference = np.abs(ours - cycles)[..., :3]
    assert difference.mean() < MEAN, tmp_path
    assert (difference.max(axis=2) > OFF).mean() < SHARE_OFF, tmp_path
    return ours


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND", "CLIP", "MIRROR"])
@pytest.mark.parametrize("interpolation", ["Linear", "Closest"])
def test_image_texels_are_interpolated_and_extended_as_in_cycles(
    bpy, tmp_path, interpolation, extension
):
    scene, _, tree = card_scene(bpy, 32, uv=((-0.71, -0.62), (1.83, 1.47)))
    node = tree.node(
        "TexImage",
        image=image(bpy, "random", random_pixels(1)),
        interpolation=interpolation,
        extension=extension,
    )
    tree.emission(node.outputs["Color"])
    assert_equal_pixel_by_pixel(scene, tmp_path)


@pytest.mark.parametrize(
    "is_float, space, mode",
    [
        (False, "sRGB", "STRAIGHT"),
        (False, "sRGB", "CHANNEL_PACKED"),
        (False, "sRGB", "NONE"),
        (False, "Non-Color", "STRAIGHT"),
        (False, "Linear Rec.2020", "STRAIGHT"),
        (True, "Linear Rec.709", "PREMUL"),
        (True, "Linear Rec.709", "STRAIGHT"),
    ],
)
@pytest.mark.parametrize("alpha_is_read", [False, True])
def test_images_are_decoded_as_in_cycles(bpy, tmp_path, is_float, space, mode, alpha_is_read):
    scene, _, tree = card_scene(bpy, 32)
    made = image(bpy, "random", random_pixels(2, alpha=True), is_float, space, mode)
    node = tree.node("TexImage", image=made)
    tree.emission(node.outputs["Color"], node.outputs["Alpha"] if alpha_is_read else 1.0)
    assert_equal_pixel_by_pixel(scene, tmp_path)


@pytest.mark.parametrize("kind", ["POINT", "TEXTURE", "VECTOR", "NORMAL"])
def test_mapping_of_a_named_uv_map_equals_cycles(bpy, tmp_path, kind):
    scene, card, tree = card_scene(bpy, 32)
    add_uv(card.data, "second", ((0.1, 1.2), (1.4, 0.1)))
    uv = tree.node("UVMap", uv_map="second")
    inputs = {"Vector": uv.outputs[0], "Rotation": (0.3, 0.2, 0.7), "Scale": (1.3, 0.7, 2.0)}
    mapping = tree.node("Mapping", inputs, vector_type=kind)
    if kind in {"POINT", "TEXTURE"}:
        mapping.inputs["Location"].default_value = (0.2, 0.3, 0.4)
    made = image(bpy, "random", random_pixels(3))
    node = tree.node("TexImage", {"Vector": mapping.outputs[0]}, image=made)
    tree.emission(node.outputs["Color"])
    assert_equal_pixel_by_pixel(scene, tmp_path)


def test_missing_image_is_magenta_as_in_cycles(bpy, tmp_path):
    scene, _, tree = card_scene(bpy, 8)
    missing = bpy.data.images.new("missing", 1, 1)
    missing.source = "FILE"
    missing.filepath = "//not_there.png"
    node = tree.node("TexImage", image=missing)
    tree.emission(node.outputs["Color"])
    ours = assert_equal_pixel_by_pixel(scene, tmp_path)
    assert ours[4, 4].tolist() == [1.0, 0.0, 1.0, 1.0]


def test_light_of_a_surface_that_lets_everything_through_is_added(bpy, tmp_path):
    """Emission added to half transparency and to full transparency, in front of a bright card."""
    scene, card, tree = card_scene(bpy, 8)
    tree.emission((0.3, 0.6, 0.2))
    for height, transmission, color in ((0.5, 0.5, (0.1, 0.2, 0.3)), (1.0, 1.0, (0.4, 0.1, 0.0))):
        copy = card.copy()
        copy.data = card.data.copy()
        copy.location.z = height
        material = bpy.data.materials.new("glow")
        material.node_tree.nodes.clear()
        glow = Tree(material.node_tree)
        through = glow.node("BsdfTransparent", {"Color": (transmission,) * 3})
        light = glow.node("Emission", {"Color": color})
        parts = {"Shader": through.outputs[0], "Shader_001": light.outputs[0]}
        glow.surface(glow.node("AddShader", parts).outputs[0])
        copy.data.materials[0] = material
        scene.collection.objects.link(copy)
    ours = render_aplanat(scene, 256)
    cycles = render_cycles(scene, 4)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    # By hand: what the card sends, halved, and the light of both.
    expected = np.array([0.3, 0.6, 0.2]) / 2 + [0.1, 0.2, 0.3] + np.array([0.4, 0.1, 0.0])
    assert np.abs(cycles[..., :3] - expected).max() < 1e-5
    # 64 pixels times 256 independent decisions: the mean's deviation is 0.3 / sqrt(16384).
    assert np.abs(ours[..., :3].mean(axis=(0, 1)) - expected).max() < 4 * 0.3 / 128


def test_film_alpha_of_mixed_transparency_and_holdout_equals_cycles(bpy):
    scene, _, tree = card_scene(bpy, 8)
    scene.render.film_transparent = True
    shaders = [
        tree.node("Emission", {"Color": (1.0, 0.5, 0.25)}),
        tree.node("BsdfTransparent"),
        tree.node("Holdout"),
    ]
    first, second, third = (node.outputs[0] for node in shaders)
    mix = tree.node("MixShader", {"Fac": 0.25, "Shader": first, "Shader_001": second})
    both_of_them = {"Fac": 0.4, "Shader": mix.outputs[0], "Shader_001": third}
    tree.surface(tree.node("MixShader", both_of_them).outputs[0])
    ours = render_aplanat(scene, 256).mean(axis=(0, 1))
    cycles = render_cycles(scene, 64).mean(axis=(0, 1))
    # 0.45 of the emission, 0.15 let through, 0.4 a hole; deviation of 16384 decisions below 0.004.
    assert np.abs(ours - cycles).max() < 0.012
    assert cycles[3] == pytest.approx(0.45, abs=0.02)


LIT = {
    "diffuse": ("BsdfDiffuse", {"Color": (0.8, 0.5, 0.3)}),
    "plastic": ("BsdfPrincipled", {"Base Color": (0.8, 0.3, 0.2), "Roughness": 0.3}),
    "metal": (
        "BsdfPrincipled",
        {"Base Color": (0.8, 0.5, 0.2), "Roughness": 0.5, "Metallic": 1.0},
    ),
    "rough": ("BsdfGlossy", {"Color": (0.9, 0.7, 0.5), "Roughness": 1.0}),
}


@pytest.mark.parametrize(
    "kind, settings",
    [
        ("SUN", {"energy": 3.0, "angle": 0.01}),
        ("SUN", {"energy": 3.0, "exposure": 0.5, "use_temperature": True, "temperature": 3500.0}),
        ("POINT", {"energy": 1500.0, "shadow_soft_size": 0.3}),
        ("POINT", {"energy": 1500.0, "shadow_soft_size": 1.0, "use_soft_falloff": False}),
        ("SPOT", {"energy": 1500.0, "spot_size": 1.4, "spot_blend": 0.5}),
        ("AREA", {"energy": 1500.0, "size": 2.0}),
    ],
)
def test_spheres_under_a_light_look_as_in_cycles(bpy, tmp_path, kind, settings):
    scene = sphere_scene(bpy, LIT.values())
    add_light(bpy, kind, (3.0, -5.0, 4.0), **settings)
    ours = render_aplanat(scene, 16)
    cycles = render_cycles(scene, 64)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    # Units and falloff are Cycles'; highlights of large lights are an approximation, an area
    # light's is round. Measured: within 0.6 % of energy, SSIM 0.985 to 0.998.
    assert energy_ratio(ours, cycles) == pytest.approx(1.0, abs=0.02), tmp_path
    assert ssim(ours, cycles) > 0.97, tmp_path


def test_spheres_in_a_constant_world_reflect_what_they_do_in_cycles(bpy, tmp_path):
    scene = sphere_scene(bpy, LIT.values())
    world_image(bpy, None)
    scene.render.film_transparent = True
    ours = render_aplanat(scene, 8)
    cycles = render_cycles(scene, 128, bounces=1)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    # Albedo table and scattering between facets; measured within 0.6 % (Cycles' noise included).
    assert energy_ratio(ours, cycles) == pytest.approx(1.0, abs=0.01), tmp_path


RARER = {
    "metal with a tinted edge": (
        "BsdfMetallic",
        {"Base Color": (0.9, 0.6, 0.3), "Edge Tint": (0.6, 0.7, 0.9), "Roughness": 0.3},
    ),
    "coat": ("BsdfPrincipled", {"Base Color": (0.7, 0.1, 0.1), "Coat Weight": 1.0}),
    "tinted coat": (
        "BsdfPrincipled",
        {
            **{"Base Color": (0.7, 0.1, 0.1), "Coat Weight": 0.8, "Coat Tint": (0.4, 0.8, 0.5)},
            "Coat Roughness": 0.3,
        },
    ),
    "metal of the Principled": (
        "BsdfPrincipled",
        {
            **{"Base Color": (0.9, 0.6, 0.3), "Metallic": 1.0, "Roughness": 0.4},
            "Specular Tint": (0.5, 0.6, 0.9),
        },
    ),
}


@pytest.mark.parametrize("lamp", [False, True])
def test_metals_and_coats_reflect_what_they_do_in_cycles(bpy, tmp_path, lamp):
    scene = sphere_scene(bpy, RARER.values(), 32)
    if lamp:
        add_light(bpy, "POINT", (3.0, -6.0, 4.0), energy=1500.0, shadow_soft_size=1.0)
    else:
        world_image(bpy, None)
    scene.render.film_transparent = True
    ours = render_aplanat(scene, 16)
    cycles = render_cycles(scene, 64, bounces=1)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    # Measured: within 1 % of energy, mean difference of the displayed picture 0.009 at most.
    assert energy_ratio(ours, cycles) == pytest.approx(1.0, abs=0.02), tmp_path
    assert np.abs(srgb(ours) - srgb(cycles)).mean() < 0.012, tmp_path


def test_a_translucent_surface_is_lit_from_behind_as_in_cycles(bpy):
    scene, _, tree = card_scene(bpy, 8)
    tree.surface(tree.node("BsdfTranslucent", {"Color": (0.8, 0.3, 0.2)}).outputs[0])
    add_light(bpy, "SUN", (0.5, 0.3, -2.0), energy=3.0)
    ours, cycles = render_aplanat(scene, 4), render_cycles(scene, 16)
    assert ours[4, 4, 0] > 0.3
    assert np.abs(ours - cycles).max() < 0.01


def test_glass_is_not_seen_in_a_world_of_one_colour(bpy, tmp_path):
    """What it mirrors, lets through and keeps inside is all the light there is."""
    scene = sphere_scene(bpy, [("BsdfGlass", {"IOR": 1.45, "Roughness": 0.0})], 32)
    world_image(bpy, None)
    picture = render_aplanat(scene, 32)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", picture, np.ones_like(picture))
    # All light of a white world arrives; both faces' shares add up to it.
    assert picture[..., :3].mean() == pytest.approx(1.0, abs=0.01)
    # Also where the film is transparent: it is the world that glass shows, not what the film has.
    scene.render.film_transparent = True
    picture = render_aplanat(scene, 8)
    glass = picture[picture[..., 3] > 0.999]
    assert len(glass) > 100
    assert glass[:, :3].mean() == pytest.approx(1.0, abs=0.01)


def test_spheres_in_an_image_world_look_as_in_cycles(bpy, shared, tmp_path):
    scene = sphere_scene(bpy, LIT.values())
    world_image(bpy, shared / "models/hdri_park.exr", rotation=0.8)
    scene.render.film_transparent = True
    ours = render_aplanat(scene, 16)
    cycles = render_cycles(scene, 256, bounces=1)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    # Prefiltered light: an approximation, and Cycles' noise at this number of samples.
    assert energy_ratio(ours, cycles) == pytest.approx(1.0, abs=0.06), tmp_path
    assert ssim(ours, cycles) > 0.92, tmp_path


def test_the_world_behind_the_scene_is_blurred_as_in_cycles(bpy, shared, tmp_path):
    scene = sphere_scene(bpy, [], pixels=64)
    camera = scene.camera.data
    camera.lens = 60.0
    # A three-bladed iris shows which way round the lens is at infinity.
    dof = camera.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 1.5, 0.25
    dof.aperture_blades, dof.aperture_rotation = 3, 0.4
    # Towards two lamps of the studio.
    scene.camera.rotation_euler = (math.pi / 2, 0.0, math.pi)
    world_image(bpy, shared / "models/hdri_studio.exr", rotation=0.8)
    ours = render_aplanat(scene, 256)
    cycles = render_cycles(scene, 256)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    assert energy_ratio(ours, cycles) == pytest.approx(1.0, abs=0.01), tmp_path
    # Both are sums of 256 places on the lens.
    assert ssim(ours, cycles) > 0.97, tmp_path


def _sequence(bpy, folder, kind, flame):
    """Two frames of 16-bit PNG or float EXR with alpha; return the path of the first."""
    pixels = random_pixels(5, alpha=True)
    # No brighter than white when divided by alpha: sRGB raises what is brighter to thousands.
    pixels[..., :3] *= pixels[..., 3:]
    if flame:
        # Light without opacity.
        pixels[0, :2, 3] = 0.0
    suffix = "exr" if kind == "EXR" else "png"
    for frame in (1, 2):
        made = image(bpy, f"frame {frame}", pixels / frame, True, "Linear Rec.709", "PREMUL")
        path = str(folder / f"{kind}{frame:04d}.{suffix}")
        if kind == "EXR":
            top_first = np.ascontiguousarray(pixels[::-1] / frame)
            OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGBA": top_first}).write(path)
        else:
            settings = bpy.context.scene.render.image_settings
            settings.media_type = "IMAGE"
            settings.file_format, settings.color_mode = "PNG", "RGBA"
            settings.color_depth = "16" if kind == "PNG16" else "8"
            made.save_render(path)
    return str(folder / f"{kind}0001.{suffix}")


@pytest.mark.parametrize("mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"])
@pytest.mark.parametrize("space", ["sRGB", "Linear Rec.2020", "Non-Color"])
@pytest.mark.parametrize("kind", ["PNG8", "PNG16", "EXR"])
def test_frames_of_sequences_are_decoded_as_in_cycles(bpy, tmp_path, kind, space, mode):
    scene, _, tree = card_scene(bpy, 16)
    made = bpy.data.images.load(_sequence(bpy, tmp_path, kind, space != "sRGB"))
    made.source = "SEQUENCE"
    made.colorspace_settings.name, made.alpha_mode = space, mode
    node = tree.node("TexImage", image=made)
    node.image_user.frame_duration, node.image_user.use_auto_refresh = 2, True
    node.image_user.frame_start = 1
    scene.frame_set(2)
    tree.emission(node.outputs["Color"], node.outputs["Alpha"])
    assert_equal_pixel_by_pixel(scene, tmp_path)
    tree.emission(node.outputs["Color"])
    assert_equal_pixel_by_pixel(scene, tmp_path)


@pytest.mark.parametrize("working", ["Linear Rec.2020", "ACEScg"])
def test_colors_become_values_with_the_weights_of_the_working_space(bpy, tmp_path, working):
    scene, _, tree = card_scene(bpy, 8)
    bpy.ops.wm.set_working_color_space(working_space=working)
    # The space of the file is set back by the next empty one.
    pixels = image(bpy, "colors", random_pixels(6), True, working)
    node = tree.node("TexImage", image=pixels, interpolation="Closest")
    tree.emission((1.0, 1.0, 1.0), node.outputs["Color"])
    assert_equal_pixel_by_pixel(scene, tmp_path)
    stated = tree.node("RGB")
    stated.outputs[0].default_value = (0.9, 0.1, 0.4, 1.0)
    tree.emission((1.0, 1.0, 1.0), stated.outputs[0])
    assert_equal_pixel_by_pixel(scene, tmp_path)
