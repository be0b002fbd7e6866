"""The statistics of `--stats` and `--json`; docs/command-line.md describes the keys."""

import sys

import bpy

from ...device.context import device_name
from ...engine.views import views_of
from ...files.version import version
from ...lens_bokeh.openings.pictures import PictureIris
from ...sampling.chromatic import RGB_WAVELENGTHS_NM
from ...scene.camera.bokeh import corner_tangent, read_bokeh
from ...scene.camera.breathing import read_breathing
from ...scene.camera.camera import focus_distance
from ...scene.camera.chromatic import read_chromatic
from ...scene.camera.distortion import read_distortion
from ...scene.camera.irises import read_opening
from ...scene.camera.lenses import read_real_lens
from ...scene.settings import read_passes, read_sampling
from ...settings.bokeh_settings import BOKEH
from ...settings.scene_part_settings import ABERRATIONS
from ...settings.scene_settings import ADVANCED, LEVELS, LIGHT, RENDER, SAMPLING
from ...settings.setting import settings_of, told, told_by


def settings_in_force(scene, sources, arguments=None):
    """Return every setting that shapes a frame.

    Parameters
    ----------
    scene : bpy.types.Scene
        At the frame in question.
    sources : CameraSources
        Of the session that renders it.
    arguments : argparse.Namespace, optional
        Of `render`.

    Returns
    -------
    dict
    """
    render = scene.render
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = scene.camera.evaluated_get(depsgraph)
    data = camera.data
    dof = data.dof
    focus = dof.focus_object
    lens, _ = read_real_lens(data, sources.shelf)
    opening, _ = read_opening(data, lens, sources.irises)
    return {
        **_sampling(scene),
        "filter": told(scene.aplanat.pixel_filter),
        "filter_size_px": render.filter_size,
        "resolution": [
            render.resolution_x * render.resolution_percentage // 100,
            render.resolution_y * render.resolution_percentage // 100,
        ],
        "pixel_aspect": render.pixel_aspect_x / render.pixel_aspect_y,
        "border": (
            [render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y]
            if render.use_border
            else None
        ),
        "crop_to_border": render.use_border and render.use_crop_to_border,
        "film_transparent": render.film_transparent,
        "simplify": render.use_simplify,
        "scene": scene.name,
        "view_layers": [layer.name for layer in scene.view_layers if layer.use],
        "passes": {
            layer.name: list(read_passes(layer)) for layer in scene.view_layers if layer.use
        },
        "views": [view.name for view in views_of(None, scene) if view] or None,
        "stereo": _stereo(render, data),
        "compositing": bool(render.use_compositing and scene.compositing_node_group),
        "compositor_precision": render.compositor_precision.lower(),
        "camera": camera.name,
        "camera_type": data.type.lower(),
        "focal_length_mm": data.lens if data.type == "PERSP" else None,
        "sensor_mm": [data.sensor_width, data.sensor_height],
        "sensor_fit": data.sensor_fit.lower(),
        "shift": [data.shift_x, data.shift_y],
        "clip_m": [data.clip_start, data.clip_end],
        "depth_of_field": dof.use_dof,
        "lens": lens.id if lens else None,
        "zoom_position": lens.label if lens else None,
        "fstop": lens.f_number if lens else dof.aperture_fstop,
        "focus_object": focus.name if focus else None,
        "focus_distance_m": focus_distance(depsgraph, camera) if dof.use_dof else None,
        "aperture_blades": dof.aperture_blades,
        "aperture_rotation": dof.aperture_rotation,
        "aperture_ratio": dof.aperture_ratio,
        **_iris(data, opening),
        "lens_exposure": lens.exposure.lower() if lens else None,
        "aberrations": _aberrations(data, lens),
        "breathing": _breathing(depsgraph, camera, lens),
        "distortion": _distortion(scene, data, lens),
        "bokeh": _bokeh(scene, data, lens, opening),
        "chromatic": _chromatic(data, lens),
        "amplify_whites": scene.world.aplanat.amplification if scene.world else 0.0,
        "view_transform": scene.view_settings.view_transform,
        "look": scene.view_settings.look,
        "exposure": scene.view_settings.exposure,
        "gamma": scene.view_settings.gamma,
        "working_space": bpy.data.colorspace.working_space,
        "no_bokeh": bool(arguments and arguments.no_bokeh),
        "no_chromatic": bool(arguments and arguments.no_chromatic),
    }


def _sampling(scene):
    """Return how a frame is sampled; null is what the method does not use."""
    sampling = read_sampling(scene)
    automatic = sampling.method == "ADAPTIVE" and sampling.target_error is not None
    numbers = told_by(sampling, SAMPLING, RENDER, ADVANCED, LEVELS, LIGHT) | {
        "target_error": sampling.target_error,
        "time_limit_s": sampling.time_limit,
        "share_drawings": sampling.reuse_grid,
    }
    if automatic:
        # They follow from the noise and from the blur; the work tells how many there were.
        unused = ("samples", "subsamples")
    else:
        unused = ("target_error", "min_samples", "max_samples")
    numbers |= dict.fromkeys(unused)
    if sampling.method != "ADAPTIVE":
        numbers["subsamples"] = 0
    if sampling.method != "LAYERED":
        numbers |= dict.fromkeys(("layers", "layer_source", "view_dependent_layers"))
    return numbers


def _stereo(render, data):
    if not render.use_multiview or render.views_format != "STEREO_3D":
        return None
    stereo = data.stereo
    return {
        "convergence": stereo.convergence_mode.lower(),
        "convergence_distance_m": stereo.convergence_distance,
        "interocular_distance_m": stereo.interocular_distance,
        "pivot": stereo.pivot.lower(),
    }


def _breathing(depsgraph, camera, lens):
    """Return how much larger the picture is for its focus; null where it does not breathe."""
    if not (camera.data.aplanat.use_breathing and camera.data.dof.use_dof):
        return None
    return read_breathing(camera.data, lens, focus_distance(depsgraph, camera))[0]


def _aberrations(data, lens):
    """Return the strengths of an artist's lens; null with a real one."""
    if lens:
        return None
    return {name: getattr(data.aplanat, name) for name in settings_of(ABERRATIONS)}


def _distortion(scene, data, lens):
    terms, _ = read_distortion(data, lens, corner_tangent(data, scene))
    return {"source": told(data.aplanat.distortion), "terms": list(terms)}


def _iris(data, opening):
    if isinstance(opening, PictureIris):
        name = data.aplanat.bokeh.iris_image.name
        return {"iris_image": name, "blade_curvature": None, "round_wide_open": None}
    return {
        "iris_image": None,
        "blade_curvature": opening.curvature,
        "round_wide_open": opening.closing is not None,
    }


def _bokeh(scene, data, lens, opening):
    own = scene.aplanat
    bokeh, _ = read_bokeh(data, lens, corner_tangent(data, scene), opening)
    if bokeh is None or (own.method == "REFERENCE" and not own.use_reference_bokeh):
        return None
    look, iris = bokeh.appearance, _iris(data, opening)
    return {
        **told_by(bokeh, *BOKEH),
        "cluster_levels": bokeh.cluster_levels if bokeh.model == "CLUSTERED" else 0,
        "hardness": look.edge,
        "profile_strength": bokeh.profile_strength if lens else None,
        # As Aplanat told them before the iris was one of lens samples, too.
        **{name: iris[name] for name in ("iris_image", "blade_curvature")},
        "vignetting": bokeh.vignetting.lower(),
        "grain": look.grain.strength if look.grain else 0.0,
        "dust": look.grain.dust if look.grain else 0,
        "diffraction": look.diffraction.strength if look.diffraction else 0.0,
        "onion": look.onion.contrast if look.onion else 0.0,
    }


def _chromatic(data, lens):
    found, _ = read_chromatic(data, lens)
    if found is None:
        return None
    shortest, longest = found.wavelength_range
    return {
        "mode": found.mode.lower(),
        "axial": found.axial,
        "lateral_per_um": found.lateral,
        "axial_map": found.axial_map.text,
        "lateral_map": found.lateral_map.text,
        "wavelengths_nm": RGB_WAVELENGTHS_NM if found.mode == "RGB" else [shortest, longest],
        "focal_length_m": found.focal_length,
        # Of the shortest wavelength over the reference's, before the strength.
        "focal_ratio": float(found.dispersion.ratio(shortest, found.reference_nm)),
        "reference_nm": found.reference_nm,
        "of_lens": found.of_lens,
        "equalizer": (
            None
            if found.mode == "RGB" or found.equalizer.is_flat
            else [found.equalizer.wavelengths_nm, found.equalizer.weights]
        ),
    }


def work(statistics):
    """Return a render's `RenderStatistics` as numbers for JSON."""
    found = statistics.highlights
    return {
        "seconds": {stage: round(seconds, 6) for stage, seconds in statistics.seconds.items()},
        "lens_samples": statistics.lens_samples,
        "subsamples": statistics.subsamples,
        "subpixels": statistics.subpixels,
        "noise": _noise(statistics.noise),
        "draw_calls": statistics.draw_calls,
        "meshes_decimated": statistics.decimations,
        "levels_replayed": statistics.replays,
        "triangles_submitted": statistics.triangles_submitted,
        "triangles_full_detail": statistics.triangles_full_detail,
        "sprites_drawn": statistics.sprites_drawn,
        "sprites_copied": statistics.sprites_copied,
        "highlights_found": found["found"],
        "highlight_thresholds": statistics.thresholds,
        "highlights_clustered": found["clustered"],
        "highlights_culled": {
            "size": found["culled_size"],
            "occlusion": found["culled_occlusion"],
            "cone": found["culled_cone"],
        },
        "highlights_masked": found["masked"],
        "highlights_splatted": found["splatted"],
        "uploads": dict(statistics.uploads),
        "shaders_compiled": statistics.shaders_compiled,
        "texture_bytes": statistics.texture_bytes,
        "geometry_bytes": statistics.geometry_bytes,
    }


def _noise(report):
    if report is None:
        return None
    least, mean, most = report.samples
    return {
        "target": report.target,
        "error": report.error,
        "samples_least": least,
        "samples_mean": mean,
        "samples_most": most,
        "tiles": report.tiles,
        "tiles_above": report.above,
    }


def total_work(parts):
    """Add the statistics of several frames, key by key; maxima for keys that are no sums."""
    total = {}
    for part in parts:
        for key, value in part.items():
            if key == "noise":
                # That of the frame that was left with the largest error.
                worst = total.get(key)
                if worst is None or _error(value) > _error(worst):
                    total[key] = value
            elif isinstance(value, dict):
                total[key] = total_work([total.get(key, {}), value])
            elif key.endswith(("_bytes", "subpixels", "subsamples")):
                total[key] = max(total.get(key, 0), value)
            else:
                total[key] = total.get(key, 0) + value
    return total


def _error(noise):
    return (noise or {}).get("error") or 0.0


def machine():
    """Return versions, device and the process' peak memory."""
    return {
        "aplanat": version(),
        "blender": bpy.app.version_string,
        "gpu": device_name(),
        "peak_memory_bytes": peak_memory(),
    }


def peak_memory():
    """Return the peak memory of this process in bytes; None where the system has no figure."""
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024
