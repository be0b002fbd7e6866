"""Images are read once for as long as they do not change, as Cycles decodes them."""

import threading
from types import SimpleNamespace

import numpy as np
import OpenEXR
import pytest

from addon.scene.extract import SceneExtractor
from addon.scene.images import images
from addon.scene.images.image_pixels import encode_srgb, reduced, without_infinite
from addon.scene.images.images import ImageReader
from addon.snapshot.content import decode_srgb
from tests import scene_builders as scenes
from tests.surface_scenes import Tree, image, random_pixels

# Rounding of single precision.
SINGLE = 2e-6


@pytest.fixture
def bpy(aplanat_bpy):
    aplanat_bpy.ops.wm.read_factory_settings(use_empty=True)
    return aplanat_bpy


@pytest.fixture
def reads(monkeypatch):
    """Names of the images whose pixels were copied from Blender."""
    from addon.scene.images import images

    names, read = [], images.read_pixels

    def counted(block):
        names.append(block.name)
        return read(block)

    monkeypatch.setattr(images, "read_pixels", counted)
    return names


def painted_scene(bpy):
    made = bpy.data.images.new("paint", 4, 4)
    made.pixels.foreach_set(random_pixels(1, 4, 4).ravel())
    assert made.is_dirty
    material = bpy.data.materials.new("m")
    material.node_tree.nodes.clear()
    tree = Tree(material.node_tree)
    tree.emission(tree.node("TexImage", image=made).outputs["Color"])
    cube = scenes.add(bpy, "cube", scenes.cube(bpy), material)
    return made, cube


def test_a_painted_image_is_read_again_only_when_blender_tells_of_a_change(bpy, reads):
    made, cube = painted_scene(bpy)
    with scenes.told_of_updates(bpy, SceneExtractor()) as extractor:

        def look():
            depsgraph = bpy.context.evaluated_depsgraph_get()
            (snapshot,) = extractor.extract_content(depsgraph).images.values()
            return snapshot

        first = look()
        assert reads == ["paint"]
        for x in (1.0, 2.0):
            cube.location.x = x
            assert look() is first
        assert reads == ["paint"]
        made.pixels[0] = 0.25
        made.update_tag()
        assert look().pixels[0, 0, 0] == 64
        assert reads == ["paint", "paint"]


def test_a_reader_that_is_not_told_compares_unsaved_images(bpy, reads):
    made, _ = painted_scene(bpy)
    reader = ImageReader()
    for _ in range(2):
        reader.begin()
        reader.read(made)
    assert reads == ["paint", "paint"]
    assert len(reader.images) == 1


def test_each_frame_of_a_sequence_has_its_own_file(bpy, tmp_path):
    for frame in (1, 2):
        pixels = np.full((2, 2, 4), 0.25 * frame, np.float32)
        OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGBA": pixels}).write(
            str(tmp_path / f"a{frame:04d}.exr")
        )
    made = bpy.data.images.load(str(tmp_path / "a0001.exr"))
    made.source = "SEQUENCE"
    tree = Tree(bpy.data.materials.new("m").node_tree)
    user = tree.node("TexImage", image=made).image_user
    user.frame_duration = 2
    reader = ImageReader()
    for frame in (1, 2):
        user.frame_offset = frame - 1
        user.frame_current = frame
        reader.begin()
        use = reader.read(made, user)
        assert reader.images[use.uid].pixels[0, 0, 3] == 0.25 * frame


def test_the_srgb_encoding_and_its_decoding_are_inverse_beyond_white_and_below_black():
    linear = np.linspace(-1.0, 40.0, 200).reshape(-1, 1, 1) * np.ones(4)
    encoded = encode_srgb(linear)
    assert (encoded[..., 3] == linear[..., 3]).all()
    assert np.allclose(decode_srgb(encoded[..., :3]), linear[..., :3], rtol=SINGLE)


def test_pixels_that_are_not_finite_or_beyond_bounds_are_cleared_in_all_channels():
    pixels = np.ones((1, 5, 4), np.float32)
    pixels[0, 1, 0], pixels[0, 2, 3], pixels[0, 3, 2] = np.nan, -np.inf, 1e31
    cleared, dropped = without_infinite(pixels)
    assert dropped == 3
    assert cleared[0, :, 0].tolist() == [1.0, 0.0, 0.0, 0.0, 1.0]
    assert (cleared[0, 1:4] == 0.0).all()
    whole = np.ones((1, 2, 4), np.float32)
    assert without_infinite(whole)[0] is whole


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_a_reduced_image_holds_means_of_squares(kind):
    pixels = (np.random.default_rng(3).random((7, 10, 4)) * 255).astype(kind)
    small = reduced(pixels, 4)
    assert small.shape == (3, 4, 4) and small.dtype == kind
    expected = pixels[:3, :3].astype(np.float64).mean(axis=(0, 1))
    assert np.abs(small[0, 0] - expected).max() <= (0.5 if kind is np.uint8 else 1e-4)
    # The last row and column are of fewer texels.
    assert np.abs(small[2, 3] - pixels[6, 9].astype(np.float64)).max() < 1e-4
    assert reduced(pixels, 10) is pixels


def test_an_image_too_large_for_the_device_is_reduced_and_told(bpy):
    made = image(bpy, "large", random_pixels(2, 8, 12))
    reader = ImageReader(largest=6)
    use = reader.read(made)
    assert reader.images[use.uid].pixels.shape == (4, 6, 4)
    (line,) = reader.report
    assert line == (
        "image 'large': its 12 x 8 pixels are more than the graphics device holds (6 a side);"
        " it is drawn in 6 x 4"
    )


def test_a_movie_is_read_in_the_main_thread_from_a_thread_that_renders(monkeypatch):
    done = []
    movie = SimpleNamespace(
        source="MOVIE", packed_file=None, gl_load=lambda frame: done.append(frame)
    )
    monkeypatch.setattr(images, "read_pixels", lambda image: done.append("read"))

    def in_main_thread(work):
        done.append("asked")
        result = work()
        done.append("answered")
        return result

    def read(reader):
        thread = threading.Thread(target=lambda: notes.append(reader._pixels(movie, None, 7)[2]))
        thread.start()
        thread.join()

    notes = []
    read(ImageReader(in_main_thread=in_main_thread))
    # Choosing the frame and reading it are one piece of work: nobody chooses another between.
    assert done == ["asked", 7, "read", "answered"] and notes == [[]]
    done.clear()
    read(ImageReader())
    assert done == ["read"] and "movie" in notes[1][0]
    done.clear()
    ImageReader()._pixels(movie, None, 3)
    assert done == [3, "read"]
