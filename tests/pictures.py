"""Rendering small pictures in this process' Blender and comparing them."""

import numpy as np

from benchmarks.scenes.pictures import render_picture


def render_aplanat(scene, samples, pixel_filter="BOX", filter_size=1.0):
    """Render with Aplanat."""
    scene.render.engine = "APLANAT"
    scene.aplanat.method = "REFERENCE"
    scene.aplanat.render_samples = samples
    scene.aplanat.pixel_filter = pixel_filter
    scene.render.filter_size = filter_size
    return render_picture(scene)


def render_cycles(scene, samples, pixel_filter="BOX", filter_size=1.0, bounces=0, seed=0):
    """Render with Cycles on the CPU: no denoising, no adaptive sampling, no clamping."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.seed = seed
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = pixel_filter
    cycles.filter_width = filter_size
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.transparent_max_bounces = 8
    return render_picture(scene)


def srgb(linear):
    """Encode scene-linear values for viewing, clipped to 0..1."""
    x = np.clip(np.nan_to_num(np.asarray(linear, np.float64), posinf=1e6), 0.0, 1.0)
    return np.where(x <= 0.0031308, x * 12.92, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def ssim(test, reference):
    """Structural similarity of two scene-linear pictures after sRGB encoding."""
    from skimage.metrics import structural_similarity

    return float(
        structural_similarity(
            srgb(test[..., :3]),
            srgb(reference[..., :3]),
            data_range=1.0,
            channel_axis=2,
            gaussian_weights=True,
            sigma=1.5,
            use_sample_covariance=False,
        )
    )


def energy_ratio(test, reference):
    """Sum of a picture's RGB over the sum of the reference's."""
    return float(test[..., :3].sum(dtype=np.float64) / reference[..., :3].sum(dtype=np.float64))


def save_side_by_side(path, test, reference):
    """Write test, reference and four times their difference as one PNG, for looking."""
    import imageio.v3 as iio

    a, b = srgb(test[..., :3]), srgb(reference[..., :3])
    strip = np.concatenate([a, b, np.clip(np.abs(a - b) * 4, 0, 1)], axis=1)
    iio.imwrite(path, np.rint(strip * 255).astype(np.uint8))
