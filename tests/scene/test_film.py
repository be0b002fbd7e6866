"""The raster of a render has Blender's own size, also where it rounds."""

import pytest

from addon.errors import InputError
from addon.scene.settings import read_film
from tests.pictures import render_cycles

# Width, height, per cent, border (left, bottom, right, top), region. The sizes are those of what
# Cycles rendered cropped to the border; a tenth times ten pixels rounds either way, depending
# on the precision.
CASES = [
    (33, 21, 50, None, (0, 0, 16, 10)),
    (33, 21, 33, None, (0, 0, 10, 6)),
    (99, 77, 7, None, (0, 0, 6, 5)),
    (101, 51, 100, (0.1, 0.33, 0.77, 0.9), (10, 16, 67, 29)),
    (10, 10, 100, (0.7, 0.3, 1.0, 0.6), (7, 3, 3, 3)),
    (10, 10, 100, (0.1, 0.2, 0.7, 0.9), (1, 2, 6, 7)),
    (64, 84, 100, (1 / 64, 33 / 84, 8 / 64, 60 / 84), (1, 33, 7, 27)),
    (36, 84, 100, (19 / 36, 75 / 84, 29 / 36, 76 / 84), (19, 75, 10, 1)),
]


def apply(scene, width, height, percentage, border):
    render = scene.render
    render.resolution_x, render.resolution_y = width, height
    render.resolution_percentage = percentage
    render.use_border = render.use_crop_to_border = border is not None
    if border is not None:
        render.border_min_x, render.border_min_y = border[:2]
        render.border_max_x, render.border_max_y = border[2:]


@pytest.mark.parametrize(("width", "height", "percentage", "border", "region"), CASES)
def test_region_is_the_picture_that_cycles_renders(
    aplanat_bpy, empty_scene, width, height, percentage, border, region
):
    scene = empty_scene
    camera = aplanat_bpy.data.objects.new("camera", aplanat_bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    apply(scene, width, height, percentage, border)
    film = read_film(scene)
    assert film.region == region
    assert (film.width, film.height) == (width * percentage // 100, height * percentage // 100)
    assert render_cycles(scene, 1).shape[:2] == (region[3], region[2])


@pytest.mark.parametrize(
    ("width", "height", "percentage", "border", "message"),
    [
        (4, 4, 10, None, "less than one"),
        (100, 100, 100, (0.5, 0.5, 0.5, 0.9), "render region"),
        (100, 100, 100, (0.8, 0.8, 0.2, 0.2), "render region"),
        (65536, 65536, 100, None, "pixels"),
    ],
)
def test_pictures_without_or_with_absurdly_many_pixels_are_refused(
    empty_scene, width, height, percentage, border, message
):
    apply(empty_scene, width, height, percentage, border)
    with pytest.raises(InputError, match=message):
        read_film(empty_scene)


def test_a_small_region_of_an_enormous_picture_is_fine(empty_scene):
    apply(empty_scene, 65536, 65536, 100, (0.5, 0.5, 0.51, 0.51))
    assert read_film(empty_scene).region == (32768, 32768, 655, 655)
