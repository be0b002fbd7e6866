"""Camera > Lens: the chooser of a real lens, what it does and what it is; the iris."""

import math

import bpy

from ...engine.shared_resources import real_lens_of, resources, shelf
from ...optics.lens_facts import lens_facts, squeeze
from ...scene.camera.bokeh import corner_tangent
from ...scene.camera.camera import sensor_diagonal
from ...scene.camera.distortion import read_distortion
from ...scene.camera.irises import read_opening
from ..jobs import background
from ..operators.lens_import import APLANAT_OT_import_lens
from ..operators.lens_operators import (
    APLANAT_OT_background_work,
    APLANAT_OT_choose_lens,
    APLANAT_OT_edit_lens,
    APLANAT_OT_match_zoom,
    APLANAT_OT_reload_lenses,
    APLANAT_OT_remove_lens,
    APLANAT_OT_use_focal_length,
    APLANAT_OT_use_iris,
)
from .panel_bases import CameraPanel, EnginePanel
from .sentences import draw_alert, draw_sentences, letters_across

# In units of Blender's buttons.
_CHOSEN_SCALE, _POPUP_SCALE = 9.0, 6.0
# A smaller difference of focal lengths, as a share, is that of engraved and computed ones: nobody
# sees it in the framing.
_SAME_LENGTH = 0.02
_MOST_FINDINGS = 8
# Share of the width that the names of facts take.
_FACT_NAMES = 0.38


class APLANAT_MT_lens(bpy.types.Menu):
    """Menu of operators on lens files."""

    bl_label = "Lens File"

    def draw(self, _context):
        """Draw the operators."""
        layout = self.layout
        layout.operator(APLANAT_OT_import_lens.bl_idname, text="Import...", icon="IMPORT")
        layout.operator(APLANAT_OT_reload_lenses.bl_idname, icon="FILE_REFRESH")
        layout.separator()
        layout.operator(APLANAT_OT_edit_lens.bl_idname, icon="TEXT")
        layout.operator(APLANAT_OT_remove_lens.bl_idname, icon="TRASH")


class KnownLensPanel(CameraPanel):
    """A panel below that of the real lens, of a camera that has one."""

    bl_parent_id = "APLANAT_CAMERA_PT_lens"

    @classmethod
    def poll(cls, context):
        """Whether the camera has a lens that can be used."""
        return super().poll(context) and real_lens_of(context.camera) is not None


class APLANAT_CAMERA_PT_lens(CameraPanel, bpy.types.Panel):
    """The real lens of the camera: chooser, zoom position, focal length, f-stop."""

    bl_label = "Real Lens"
    bl_parent_id = "DATA_PT_lens"

    def draw(self, context):
        """Draw the chooser, and what the lens does to the camera."""
        camera = context.camera
        settings = camera.aplanat
        column = self.column()
        column.template_icon_view(
            settings,
            "lens_choice",
            show_labels=True,
            scale=_CHOSEN_SCALE,
            scale_popup=_POPUP_SCALE,
        )
        row = column.row(align=True)
        row.use_property_split = False
        row.prop(settings, "lens", text="", placeholder="Thin Lens")
        row.operator("camera.aplanat_browse_lenses", text="", icon="IMGDISPLAY")
        row.operator(APLANAT_OT_import_lens.bl_idname, text="", icon="FILE_FOLDER")
        row.menu("APLANAT_MT_lens", text="", icon="DOWNARROW_HLT")
        letters = letters_across(context)
        if settings.lens:
            _draw_state(column, camera, letters)
        else:
            text = "Thin Lens: ideal, of any focal length and f-number, without a prescription."
            draw_sentences(column, text, letters, icon="INFO")
        exposure = column.column()
        exposure.active = camera.dof.use_dof and bool(settings.lens)
        exposure.prop(settings, "exposure")
        breathing = column.column()
        breathing.active = camera.dof.use_dof and camera.type == "PERSP"
        breathing.prop(settings, "use_breathing", text="Breathing")
        _draw_work(column)


def _draw_state(column, camera, letters):
    settings = camera.aplanat
    found = shelf().find(settings.lens)
    if shelf().is_out_of_date(settings.lens):
        row = column.row()
        row.label(text="The file has changed", icon="INFO")
        row.operator(APLANAT_OT_reload_lenses.bl_idname, text="Reload", icon="FILE_REFRESH")
    if found is None:
        _draw_missing(column, settings.lens, letters)
    elif found.lens is None:
        _draw_findings(column, found, letters)
    elif camera.type != "PERSP":
        draw_alert(column, "A real lens needs a perspective camera.", letters)
    else:
        _draw_use(column, camera, letters)


def _draw_missing(column, lens_id, letters):
    draw_alert(column, f"'{lens_id}' is not in the library: a thin lens is drawn.", letters)
    draw_sentences(column, "Import its file, or choose another lens.", letters)
    for near in shelf().near_ids(lens_id):
        operator = column.operator(
            APLANAT_OT_choose_lens.bl_idname, text=f"Use '{near}'", icon="VIEWZOOM"
        )
        operator.lens = near


def _draw_findings(column, found, letters):
    draw_alert(column, f"{found.path.name} cannot be used: a thin lens is drawn.", letters)
    findings = found.error.findings
    box = column.box().column(align=True)
    for finding in findings[:_MOST_FINDINGS]:
        row = box.row()
        row.alert = True
        row.label(text=f"{finding.code}  {finding.path}")
        draw_sentences(box, finding.message, letters - 4)
    if len(findings) > _MOST_FINDINGS:
        box.label(text=f"and {len(findings) - _MOST_FINDINGS} more")
    column.operator(APLANAT_OT_edit_lens.bl_idname, icon="TEXT")


def _draw_use(column, camera, letters):
    lens = real_lens_of(camera)
    settings = camera.aplanat
    facts = lens_facts(lens.prescription, lens.label)
    if lens.label is not None:
        row = column.row(align=True)
        row.prop(settings, "zoom")
        row.operator(APLANAT_OT_match_zoom.bl_idname, text="", icon="ZOOM_SELECTED")
        if settings.zoom_label not in ("", lens.label):
            draw_alert(
                column, f"No position '{settings.zoom_label}': '{lens.label}' is used.", letters
            )
    asked = camera.dof.aperture_fstop
    if camera.dof.use_dof and lens.limits(asked):
        text = f"f/{asked:.3g} asked, the lens opens to f/{lens.f_number:.3g}."
        draw_sentences(column, text, letters, icon="INFO")
    if abs(facts.focal_length / camera.lens - 1.0) >= _SAME_LENGTH:
        text = f"The camera has {camera.lens:.4g} mm, the lens {facts.focal_length:.4g} mm."
        draw_sentences(column, text, letters, icon="INFO")
        column.operator(APLANAT_OT_use_focal_length.bl_idname)


def _draw_work(column):
    work = background.progress()
    if work is not None:
        row = column.row(align=True)
        left = f" ({work.left} left)" if work.left > 1 else ""
        row.progress(text=work.label + left, factor=work.share)
        row.operator(APLANAT_OT_background_work.bl_idname, text="", icon="X").stop = True
    elif background.is_stopped():
        row = column.row(align=True)
        row.label(text="Pictures of lenses are stopped")
        row.operator(APLANAT_OT_background_work.bl_idname, text="Go On", icon="PLAY").stop = False


class APLANAT_CAMERA_PT_lens_distortion(CameraPanel, bpy.types.Panel):
    """Distortion: how the lens bends straight lines."""

    bl_label = "Distortion"
    bl_parent_id = "APLANAT_CAMERA_PT_lens"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the choice, and warnings about what cannot be met."""
        camera = context.camera
        column = self.column()
        column.prop(camera.aplanat, "distortion")
        if camera.aplanat.distortion == "DIVISION":
            column.prop(camera.aplanat, "distortion_k")
        tangent = corner_tangent(camera, context.scene)
        _, problems = read_distortion(camera, real_lens_of(camera), tangent)
        for problem in problems:
            draw_alert(column, f"{problem[0].upper()}{problem[1:]}.", letters_across(context))


class APLANAT_CAMERA_PT_lens_facts(KnownLensPanel, bpy.types.Panel):
    """Facts of the lens: design, source, figures."""

    bl_label = "Facts"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw facts and warnings."""
        camera = context.camera
        lens = real_lens_of(camera)
        letters = letters_across(context)
        column = self.layout.column(align=True)
        for name, value in _facts(lens, camera, context.scene):
            _draw_fact(column, name, value, letters)
        iris = lens.prescription.diaphragm
        if _differs_from_iris(camera, iris, squeeze(lens.prescription, lens.label)):
            self.layout.operator(APLANAT_OT_use_iris.bl_idname)
        found = shelf().find(lens.id)
        if found is not None and found.lens is not None and found.lens.warnings:
            self._draw_warnings(found.lens.warnings, letters)

    def _draw_warnings(self, warnings, letters):
        header, body = self.layout.panel("APLANAT_lens_warnings", default_closed=True)
        header.label(text=f"{len(warnings)} Warnings" if len(warnings) > 1 else "1 Warning")
        if body is None:
            return
        column = body.column(align=True)
        for warning in warnings:
            draw_sentences(column, f"{warning.code}  {warning.message}", letters)


def _facts(lens, camera, scene):
    prescription = lens.prescription
    facts = lens_facts(prescription, lens.label)
    yield "Name", prescription.name
    made = ", ".join(str(part) for part in (prescription.designer, prescription.year) if part)
    if made:
        yield "Design", made
    if prescription.source:
        yield "Source", prescription.source
    length = f"{facts.focal_length:.4g} mm"
    if facts.horizontal_focal_length is not None:
        length += f" high, {facts.horizontal_focal_length:.4g} mm wide"
    yield "Focal Length", length
    if facts.horizontal_focal_length is not None:
        yield "Squeeze", f"{squeeze(prescription, lens.label):.3g}"
    yield "Opens to", f"f/{facts.f_number:.3g}"
    yield "Covers", f"{2.0 * math.degrees(facts.half_field):.3g}\N{DEGREE SIGN}"
    yield "Image Circle", _circle(facts.image_circle_diameter, sensor_diagonal(camera, scene))
    fisheye = prescription.projection == "fisheye"
    yield "Projection", "Fisheye (drawn rectilinear)" if fisheye else "Rectilinear"
    yield "Glass", f"{facts.elements} elements in {facts.groups} groups"
    group = prescription.focus
    yield "Focusing", f"Surfaces {group.first} to {group.last}" if group else "Whole lens moves"
    iris = prescription.diaphragm
    yield "Iris", _blades(iris)


def _blades(iris):
    if not iris.blades:
        return "Round"
    bend = f"curvature {iris.blade_curvature:.3g}" if iris.blade_curvature else "straight"
    return f"{iris.blades} blades, {bend}"


def _circle(diameter, diagonal):
    verdict = "covers" if diameter >= diagonal else "is smaller than"
    return f"{diameter:.3g} mm, {verdict} the sensor's {diagonal:.3g} mm"


def _differs_from_iris(camera, iris, ratio):
    dof = camera.dof
    if dof.aperture_blades != min(iris.blades, 16) or abs(dof.aperture_ratio - ratio) > 1e-3:
        return True
    turn = math.remainder(dof.aperture_rotation - math.radians(iris.rotation_deg), math.tau)
    bend = camera.aplanat.bokeh.blade_curvature - iris.blade_curvature
    return iris.blades > 0 and max(abs(turn), abs(bend)) > 1e-4


def _draw_fact(column, name, value, letters):
    split = column.split(factor=_FACT_NAMES)
    left = split.row()
    left.alignment = "RIGHT"
    left.active = False
    left.label(text=name)
    draw_sentences(split.column(align=True), value, int((1.0 - _FACT_NAMES) * letters) - 1)


class APLANAT_CAMERA_PT_iris(CameraPanel, bpy.types.Panel):
    """The iris: curvature of its blades, the round stop in front of them, or an image."""

    bl_label = "Iris"
    bl_parent_id = "DATA_PT_lens"
    bl_options = {"DEFAULT_CLOSED"}
    group = "bokeh"

    def draw(self, context):
        """Draw the settings, and what is wrong with an image."""
        camera = context.camera
        settings, column = self.owner(context), self.column()
        column.use_property_decorate = True
        lens, letters = real_lens_of(camera), letters_across(context)
        blades = column.column()
        blades.active = settings.iris_image is None and camera.dof.aperture_blades > 2
        blades.prop(settings, "blade_curvature", text="Curvature", slider=True)
        stop = blades.column()
        stop.active = blades.active and lens is not None
        stop.prop(settings, "use_round_stop")
        image = column.column()
        image.use_property_decorate = False
        image.template_ID(settings, "iris_image", open="image.open", text="Image")
        notes = column.column(align=True)
        text = "Blades, rotation and ratio (anamorphic): Depth of Field > Aperture."
        draw_sentences(notes, text, letters, icon="INFO")
        if camera.dof.use_dof:
            opening, problems = read_opening(camera, lens, resources().panels.sources.irises)
            for problem in problems:
                draw_alert(notes, f"{problem[0].upper()}{problem[1:]}.", letters)
            if not problems and getattr(opening, "closing", None) and opening.is_round:
                text = f"Round at f/{lens.f_number:.3g}: the blades show when it is stopped down."
                draw_sentences(notes, text, letters, icon="INFO")


def _draw_clamp(panel, context):
    """Show in Blender's Aperture panel that the lens limits the f-stop."""
    if context.engine not in EnginePanel.COMPAT_ENGINES:
        return
    camera = context.camera
    lens = real_lens_of(camera)
    if lens and lens.limits(camera.dof.aperture_fstop):
        text = f"The lens opens to f/{lens.f_number:.3g}."
        draw_sentences(panel.layout.column(), text, letters_across(context), icon="INFO")


CLASSES = (
    APLANAT_MT_lens,
    APLANAT_CAMERA_PT_lens,
    APLANAT_CAMERA_PT_lens_distortion,
    APLANAT_CAMERA_PT_lens_facts,
    APLANAT_CAMERA_PT_iris,
)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Register the panels; Blender's Aperture panel gets a line."""
    _register()
    bpy.types.DATA_PT_camera_dof_aperture.append(_draw_clamp)


def unregister():
    """Undo `register`."""
    bpy.types.DATA_PT_camera_dof_aperture.remove(_draw_clamp)
    _unregister()
