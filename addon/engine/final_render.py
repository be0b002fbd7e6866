"""A final render: one view layer, from Blender's scene to its render result.

The same code runs in the background and in the user interface; `gpu_thread` decides where the GPU
work is done. The thread that renders reads the scene, talks to Blender's render job and hands the
GPU work on in pieces.
"""

import time
from contextlib import contextmanager
from functools import partial

import bpy

from ..device import context
from ..device.shaders import compiled_count
from ..levels.choosing import meshes_with_levels
from ..snapshot.render_passes import render_pass
from .frame.pacing import Pacer
from .frame.pipeline import FrameRenderer
from .frame.render_passes import cryptomatte_metadata, fill_layer
from .gpu_thread import gpu_of_render
from .outcome import LayerPicture, PassPicture
from .planning.plan import plan_frame
from .report import frame_report
from .views import views_of

# Seconds between updates of the shown picture, and the largest share of the time that they take.
_SHOW_SECONDS = 0.5
_SHOW_SHARE = 0.1


def render_view_layer(engine, depsgraph, session):
    """Render the view layer of a dependency graph into its render result.

    Parameters
    ----------
    engine : bpy.types.RenderEngine
    depsgraph : bpy.types.Depsgraph
    session : RenderSession
        Its outcome gets the result: error, warnings, statistics, pictures.

    Raises
    ------
    AplanatError
        `RenderCancelledError` if the user stopped the render.
    """
    if bpy.app.background:
        # The extractor asks for the device's limits before anything has opened a context.
        context.ensure_context()
    extractor = session.extractor(
        largest_image=context.max_texture_size(), in_main_thread=partial(_in_main_thread, engine)
    )
    for view in views_of(engine, depsgraph.scene):
        if view is not None:
            view.activate()
        _render_view(engine, depsgraph, session, extractor, view)


def _render_view(engine, depsgraph, session, extractor, view):
    heard = session.outcome
    statistics = heard.statistics
    with statistics.timed("extract"):
        snapshot = extractor.extract(depsgraph, engine.frame_set, view)
    _show_report(engine, session, depsgraph.scene, frame_report(snapshot))
    heard.check_strict()
    with statistics.timed("plan"):
        plan = plan_frame(snapshot)
    levels = _make_levels(engine, plan, snapshot, session)
    compiled_before = compiled_count()
    slice_seconds = depsgraph.scene.aplanat.chunk_milliseconds / 1000.0
    with gpu_of_render(engine.test_break, slice_seconds, bpy.app.background) as gpu:
        statistics.device = gpu.call(_open_device)
        with statistics.timed("upload"):
            renderer = gpu.run(_prepare(plan, snapshot, session, levels))
        try:
            with _result(engine, snapshot, view) as result:
                _draw(engine, gpu, renderer, result, heard)
                pictures = _finish(gpu, renderer, result, heard)
        finally:
            statistics.lens_samples += renderer.samples_done
            statistics.subsamples = max(statistics.subsamples, float(plan.subsample_counts.mean()))
            statistics.note_noise(renderer.sampling)
            statistics.subpixels = max(statistics.subpixels, plan.subpixels)
            counts = renderer.counts
            statistics.draw_calls += counts.draw_calls
            statistics.triangles_submitted += counts.triangles
            statistics.triangles_full_detail += counts.triangles_full_detail
            statistics.sprites_drawn += counts.sprites_drawn
            statistics.sprites_copied += counts.sprites_copied
            session.note_picture(depsgraph.scene, renderer)
            _show_report(engine, session, depsgraph.scene, frame_report(snapshot, renderer))
            if renderer.highlights:
                for name, number in vars(renderer.highlights).items():
                    statistics.highlights[name] += number
            statistics.note_thresholds(renderer.thresholds)
            statistics.shaders_compiled += compiled_count() - compiled_before
            statistics.texture_bytes = max(statistics.texture_bytes, renderer.texture_bytes())
            statistics.geometry_bytes = max(statistics.geometry_bytes, renderer.geometry_bytes())
            gpu.release(renderer.release)
    metadata = cryptomatte_metadata(snapshot)
    for key, value in metadata.items():
        engine.get_result().stamp_data_add_field(key, value)
    if heard.keeps_pictures:
        picture = _layer_picture(depsgraph.scene, snapshot, view, pictures, metadata)
        heard.layers.append(picture)


def _show_report(engine, session, scene, lines):
    for line in session.report(lines):
        engine.report({"WARNING"}, line)
    session.note_findings(scene, "render", session.warnings)


def _in_main_thread(engine, work):
    """Run a function in the main thread, which may choose a movie's frame; return its result."""
    with gpu_of_render(engine.test_break, 0.0, bpy.app.background) as gpu:
        return gpu.call(work)


def _open_device():
    context.ensure_context()
    return context.device_name()


def _make_levels(engine, plan, snapshot, session):
    """Return the levels of detail that the frame draws, by mesh, waiting until they are made."""
    statistics, content = session.outcome.statistics, snapshot.content
    wanted = meshes_with_levels(content, plan)
    with statistics.timed("levels"):

        def progress(done, total):
            engine.update_stats("", f"Levels of detail: {done:,} of {total:,} triangles")

        with session.open_levels() as levels:
            levels.request([content.meshes[uid] for uid in wanted], plan.least_triangles)
            try:
                return levels.finish(progress, engine.test_break)
            finally:
                statistics.decimations += levels.work.decimations
                statistics.replays += levels.work.replays


def _prepare(plan, snapshot, session, levels):
    statistics, buffers = session.outcome.statistics, session.buffers()
    yield from buffers.update_steps(snapshot.content)
    for uid, meshes in levels.items():
        buffers.add_levels(uid, meshes)
        yield
    renderer = FrameRenderer(plan, snapshot, buffers)
    for kind, count in buffers.uploads.items():
        statistics.uploads[kind] = statistics.uploads.get(kind, 0) + count
    return renderer


@contextmanager
def _result(engine, snapshot, view):
    _, _, width, height = snapshot.film.region
    name = view.name if view else ""
    result = engine.begin_result(0, 0, width, height, layer=snapshot.layer_name, view=name)
    try:
        yield result
    finally:
        # A stopped render keeps what was drawn so far.
        engine.end_result(result)


def _draw(engine, gpu, renderer, result, heard):
    pacer = Pacer(gpu.slice_seconds)
    start = shown = time.perf_counter()
    pause = _SHOW_SECONDS
    while not renderer.finished():
        with heard.statistics.timed("draw"):
            gpu.call(partial(pacer.advance, renderer))
        now = time.perf_counter()
        if renderer.is_late(now - start):
            renderer.stop()
        _show_progress(engine, heard, renderer, now - start)
        if now - shown > pause and not renderer.finished():
            fill_layer(result.layers[0], {"Combined": gpu.call(renderer.read_image)})
            engine.update_result(result)
            shown = time.perf_counter()
            pause = max(_SHOW_SECONDS, (shown - now) / _SHOW_SHARE)


def _show_progress(engine, heard, renderer, seconds):
    done, total = renderer.samples_done, renderer.samples_expected
    megabytes = (renderer.texture_bytes() + renderer.geometry_bytes()) / 2**20
    text = f"Sample {done}/{total} | {seconds:.1f} s | GPU {megabytes:.0f} MB"
    if renderer.sampling.text:
        text += f" | {renderer.sampling.text}"
    engine.update_progress(done / total)
    engine.update_stats("", text)
    if heard.progress is not None:
        heard.progress(done / total, text)


def _finish(gpu, renderer, result, heard):
    pictures = {}
    with heard.statistics.timed("read_back"):
        # Group by group: reading all passes of a large picture at once would need twice the memory.
        for names in renderer.pass_groups():
            found = gpu.call(partial(renderer.read_passes, names))
            fill_layer(result.layers[0], found)
            if heard.keeps_pictures:
                pictures.update(found)
    return {name: pictures[name] for name in renderer.plan.passes if name in pictures}


def _layer_picture(scene, snapshot, view, pictures, metadata):
    film = snapshot.film
    return LayerPicture(
        scene=scene.name,
        layer=snapshot.layer_name,
        view=view.name if view else "",
        region=film.region,
        size=(film.width, film.height),
        passes={
            name: PassPicture(render_pass(name).channels, pixels)
            for name, pixels in pictures.items()
        },
        metadata=metadata,
    )
