"""A copy of a scene and its camera, to be rendered slice by slice; the scene itself stays as it is.

Objects, materials and all else are shared with the scene. What the copy changes is its own:
render settings, view layers' switches, and the camera with its lens.
"""

import math

import bpy

from ..errors import CameraError, InputError
from ..layers.layer_stack import LayerCamera
from ..layers.slices import MEASURED_SIDE
from ..sampling.thin_lens import aperture_radius
from ..scene.camera.camera import camera_place, check_kind, evaluated_camera, focus_distance
from ..scene.camera.lens_record import record_lens
from .kept_values import KeptValues

# Longest side of what Blender renders.
_MOST_PIXELS = 65536
_RENDER_RESULT = "Render Result"
# Where engines are told how many samples they take.
_SAMPLES = (("cycles", "samples"), ("eevee", "taa_render_samples"), ("aplanat", "render_samples"))
# Properties of a camera that are other ones in other words.
_DERIVED = {"angle", "angle_x", "angle_y"}


class ShotCopy:
    """A copy of a scene at a frame while a `with` block lasts.

    Parameters
    ----------
    scene : bpy.types.Scene
    frame : int
    settings : CaptureSettings

    Attributes
    ----------
    scene : bpy.types.Scene
        The copy.
    layer : str
        The view layer that is rendered.
    denoises : bool
        Whether Cycles denoises the pictures.
    stores_noise : bool
        Whether the picture before denoising is wanted, too.
    camera : LayerCamera
    clip : tuple of 2 float
        The camera's near and far plane, m.
    size, overscan : tuple of 2 int
        The picture's pixels, and those that it is larger on each side.
    warnings : list of str
        What of the scene is not in the picture.
    """

    def __init__(self, scene, frame, settings):
        self._original = scene
        self._frame = frame
        self._settings = settings
        self.warnings = []

    def __enter__(self):
        """Copy the scene.

        Raises
        ------
        InputError
            If it cannot be captured.
        """
        camera = self._camera_of_frame()
        self._had_result = _RENDER_RESULT in bpy.data.images
        self._kept = KeptValues()
        self._kept.__enter__()
        self._blocks = []
        try:
            self.scene = self._original.copy()
            self._blocks.append((bpy.data.scenes, self.scene))
            self._fill(camera)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        """Remove the copy, and restore what renders have changed of the scene."""
        for collection, block in reversed(self._blocks):
            try:
                collection.remove(block)
            # Whoever opens another file in between has removed it already.
            except ReferenceError:
                continue
        result = bpy.data.images.get(_RENDER_RESULT)
        if result is not None and not self._had_result:
            bpy.data.images.remove(result)
        self._kept.__exit__()

    def _fill(self, original):
        scene = self.scene
        # A marker would switch to the camera that is not the copy.
        for marker in scene.timeline_markers:
            marker.camera = None
        camera = original.copy()
        self._blocks.append((bpy.data.objects, camera))
        camera.data = original.data.copy()
        self._blocks.insert(1, (bpy.data.cameras, camera.data))
        scene.collection.objects.link(camera)
        scene.camera = camera
        scene.frame_set(self._frame)
        self._choose_layer()
        self._choose_engine()
        self._leave_out_fog()
        self._choose_picture()
        self._freeze_camera(camera)

    def aim(self, slice_):
        """Set the clip planes to a slice, and the film transparent.

        Parameters
        ----------
        slice_ : Slice
        """
        data = self.scene.camera.data
        data.clip_start, data.clip_end = slice_.clip_start, slice_.clip_end
        self._before_nothing()

    def aim_at_world(self):
        """Set the clip planes so that only the world is seen."""
        data = self.scene.camera.data
        # A sliver before the far plane, beyond which nothing is seen in any picture.
        data.clip_start, data.clip_end = self.clip[1] * (1.0 - 1e-4), self.clip[1]
        self.scene.render.film_transparent = False
        # It has no noise, and a denoiser has nothing that it could hold on to.
        self._denoise(False)

    def measure_depths(self, measures):
        """Switch between a small render of one sample, for depths, and the full render.

        Parameters
        ----------
        measures : bool
        """
        scene, render = self.scene, self.scene.render
        data = scene.camera.data
        data.clip_start, data.clip_end = self.clip
        self._before_nothing()
        long_side = max(render.resolution_x, render.resolution_y)
        share = min(1.0, MEASURED_SIDE / long_side) if measures else 1.0
        render.resolution_percentage = max(1, math.ceil(100.0 * share))
        for (owner, name), count in self._samples.items():
            setattr(getattr(scene, owner), name, 1 if measures else count)
        self._denoise(not measures and self.denoises)

    @property
    def has_world(self):
        """Whether the picture has the world in it."""
        return not self._transparent

    def _before_nothing(self):
        self.scene.render.film_transparent = True
        self._denoise(self.denoises)

    def _denoise(self, does):
        # Without the Cycles add-on there is no such setting.
        if self._has_cycles:
            self.scene.cycles.use_denoising = does

    def _camera_of_frame(self):
        scene = self._original
        camera = scene.camera
        markers = sorted((m for m in scene.timeline_markers if m.camera), key=lambda m: m.frame)
        # As Blender: the last marker that has come, or the first of all.
        for marker in reversed(markers):
            if marker.frame <= self._frame or marker is markers[0]:
                camera = marker.camera
                break
        if camera is None:
            raise CameraError(f"scene '{scene.name}' has no camera; add one, or set Scene > Camera")
        if camera.type != "CAMERA":
            raise CameraError(
                f"scene '{scene.name}' looks through '{camera.name}', which is no camera; set"
                " Scene > Camera"
            )
        # Before it is copied: a copy has another name.
        check_kind(camera)
        return camera

    def _warn(self, text):
        self.warnings.append(f"scene '{self._original.name}': {text}")

    def _choose_layer(self):
        layers = [layer for layer in self.scene.view_layers if layer.use]
        if not layers:
            raise InputError(
                f"scene '{self._original.name}': every view layer is switched off; switch one on"
                " (View Layer > Use for Rendering)"
            )
        self.layer = layers[0].name
        if len(layers) > 1:
            others = ", ".join(f"'{layer.name}'" for layer in layers[1:])
            self._warn(f"view layer '{self.layer}' is captured, not {others}")
        for layer in self.scene.view_layers:
            layer.use = layer.name == self.layer
        layers[0].use_pass_combined = layers[0].use_pass_z = True
        cycles = getattr(layers[0], "cycles", None)
        self.stores_noise = bool(cycles and cycles.denoising_store_passes)

    def _choose_engine(self):
        scene, render = self.scene, self.scene.render
        try:
            render.engine = self._settings.engine
        except TypeError as error:
            raise InputError(
                f"this Blender has no render engine {self._settings.engine}; choose another one"
            ) from error
        self._transparent = render.film_transparent
        self._has_cycles = hasattr(scene, "cycles")
        with_cycles = self._has_cycles and self._settings.engine == "CYCLES"
        self.denoises = with_cycles and scene.cycles.use_denoising
        if self._has_cycles and not self._transparent:
            # The world is a layer of its own, and seen through glass as in the picture.
            scene.cycles.film_transparent_glass = False
        self._samples = {
            (owner, name): getattr(getattr(scene, owner), name)
            for owner, name in _SAMPLES
            if hasattr(scene, owner)
        }
        # So that each slice has the same samples of a surface.
        scene.aplanat.method = "REFERENCE"
        # The scene is the same in all slices: only the camera's planes move.
        render.use_persistent_data = True
        left_out = {
            "the compositor": render.use_compositing and scene.compositing_node_group,
            "the video sequencer": render.use_sequencer
            and scene.sequence_editor
            and scene.sequence_editor.strips,
            "Freestyle": render.use_freestyle,
            "stereoscopy": render.use_multiview,
            "the render region": render.use_border,
            "motion blur": render.use_motion_blur,
        }
        for what, is_used in left_out.items():
            if is_used:
                self._warn(f"{what} is left out; layers show the whole picture of the 3D scene")
        render.use_compositing = render.use_sequencer = render.use_freestyle = False
        render.use_multiview = render.use_border = render.use_motion_blur = False

    def _leave_out_fog(self):
        """Give the copy a world without a volume: it has no end, and would fill every slice."""
        layer = self.scene.view_layers[self.layer]
        # A view layer may have a world of its own.
        owner, name = (layer, "world_override") if layer.world_override else (self.scene, "world")
        world = getattr(owner, name)
        tree = world and world.node_tree
        if tree is None or not any(_fog_of(tree)):
            return
        clear = world.copy()
        self._blocks.append((bpy.data.worlds, clear))
        for fog in list(_fog_of(clear.node_tree)):
            clear.node_tree.links.remove(fog)
        setattr(owner, name, clear)
        self._warn(
            f"the volume of world '{world.name}' is left out, since it would hide what is behind"
            " the first layer; add fog by depth afterwards"
        )

    def _choose_picture(self):
        render, settings = self.scene.render, self._settings
        size = settings.resolution or tuple(
            max(1, side * render.resolution_percentage // 100)
            for side in (render.resolution_x, render.resolution_y)
        )
        self.size = size
        self.overscan = tuple(math.ceil(side * settings.overscan) for side in size)
        whole = [s + 2 * o for s, o in zip(size, self.overscan, strict=True)]
        if max(whole) > _MOST_PIXELS:
            raise InputError(
                f"picture and overscan have {whole[0]} x {whole[1]} pixels; Blender renders"
                f" {_MOST_PIXELS} a side at most: choose a smaller resolution or overscan"
            )
        # Blender renders no side of less than 4 pixels.
        render.resolution_x, render.resolution_y = (max(4, side) for side in whole)
        if (render.resolution_x, render.resolution_y) != tuple(whole):
            raise InputError(
                f"a picture of {size[0]} x {size[1]} pixels is too small; choose a larger"
                " resolution"
            )
        render.resolution_percentage = 100
        image = render.image_settings
        image.media_type = "MULTI_LAYER_IMAGE"
        image.file_format = "OPEN_EXR_MULTILAYER"
        image.color_mode, image.color_depth, image.exr_codec = "RGBA", "32", "ZIP"
        image.use_exr_interleave = image.use_preview = False
        image.color_management = "FOLLOW_SCENE"
        render.use_file_extension = render.use_overwrite = True
        render.use_placeholder = False

    def _freeze_camera(self, camera):
        """Read the camera as it is in the frame, and widen the copy's picture by the overscan."""
        scene, render = self.scene, self.scene.render
        depsgraph = scene.view_layers[self.layer].depsgraph
        seen = evaluated_camera(depsgraph, camera)
        self.camera = self._read_camera(depsgraph, seen)
        self.clip = seen.data.clip_start, seen.data.clip_end
        if not self.clip[0] < self.clip[1]:
            raise CameraError(
                f"camera '{seen.name}' clips at {self.clip[0]:g} m and {self.clip[1]:g} m; set End"
                " beyond Start (Camera > Lens)"
            )
        data, values = camera.data, _values(seen.data)
        # What is animated or driven is the value of this frame now.
        data.animation_data_clear()
        for name, value in values.items():
            setattr(data, name, value)
        data.dof.use_dof = False
        data.aplanat.bokeh.use = data.aplanat.chromatic.use = False
        sensor, filled, _, _ = self._filled_side(data)
        whole = render.resolution_x * render.pixel_aspect_x
        data.sensor_fit = "HORIZONTAL"
        # A sensor of less than 1 mm is none to Blender.
        scale = max(1.0, 1.0 / (sensor * whole / filled))
        data.sensor_width = sensor * whole / filled * scale
        data.lens *= scale
        data.ortho_scale *= whole / filled
        data.shift_x *= filled / whole
        data.shift_y *= filled / whole

    def _read_camera(self, depsgraph, seen):
        data, dof, render = seen.data, seen.data.dof, self.scene.render
        projection = seen.calc_matrix_camera(
            depsgraph,
            x=self.size[0],
            y=self.size[1],
            scale_x=render.pixel_aspect_x,
            scale_y=render.pixel_aspect_y,
        )
        orthographic = data.type == "ORTHO"
        f_stop = dof.aperture_fstop
        return LayerCamera(
            projection=_rows(projection),
            orthographic=orthographic,
            f_stop=f_stop,
            focus_distance=focus_distance(depsgraph, seen),
            focal_length_mm=data.lens,
            # As Cycles: a parallel projection has no focal length, and 1 m instead.
            aperture_radius=aperture_radius(1.0, f_stop) if orthographic else None,
            blades=dof.aperture_blades,
            blade_rotation=dof.aperture_rotation,
            aperture_ratio=dof.aperture_ratio,
            view=_rows(camera_place(seen).inverted()),
            sensor_mm=None if orthographic else self._sensor(data),
            unit_scale=self.scene.unit_settings.scale_length,
            lens_settings=record_lens(data),
        )

    def _filled_side(self, data):
        """Return the side of the sensor that the picture fills, mm, and the picture's sides.

        Returns
        -------
        side : float
        filled, width, height : float
            Of the picture: the side that fills it, and both.
        """
        render = self.scene.render
        width = self.size[0] * render.pixel_aspect_x
        height = self.size[1] * render.pixel_aspect_y
        fit = data.sensor_fit
        if fit == "VERTICAL":
            return data.sensor_height, height, width, height
        across = fit == "HORIZONTAL" or width >= height
        return data.sensor_width, width if across else height, width, height

    def _sensor(self, data):
        """Return width and height of the part of the sensor that the picture fills, mm."""
        side, filled, width, height = self._filled_side(data)
        return side * width / filled, side * height / filled


def _fog_of(tree):
    """Return the links to the volume of a world's outputs."""
    outputs = (node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    return (link for node in outputs for link in node.inputs["Volume"].links)


def _rows(matrix):
    return tuple(tuple(float(value) for value in row) for row in matrix)


def _values(data):
    """Return the numbers and choices of an evaluated camera."""
    found = {}
    for prop in data.bl_rna.properties:
        simple = prop.type in {"FLOAT", "INT", "BOOLEAN", "ENUM"}
        is_set = simple and not prop.is_readonly and prop.identifier not in _DERIVED
        if is_set and not getattr(prop, "is_array", False):
            found[prop.identifier] = getattr(data, prop.identifier)
    return found
