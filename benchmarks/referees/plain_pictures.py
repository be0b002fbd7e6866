"""One sample in the middle of each pixel, of Aplanat and of Cycles, without bounces."""

from ..scenes.pictures import render_picture


def aplanat_picture(scene):
    """Return a picture of Aplanat of one sample a pixel, shape (height, width, 4)."""
    scene.render.engine = "APLANAT"
    scene.aplanat.method = "REFERENCE"
    scene.aplanat.render_samples = 1
    scene.aplanat.pixel_filter = "BOX"
    scene.render.filter_size = 1.0
    return render_picture(scene)


def cycles_picture(scene, filter_px, samples=1, bounces=0):
    """Return a picture of Cycles of samples within a width around each pixel's middle."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = filter_px
    cycles.max_bounces = bounces
    return render_picture(scene)
