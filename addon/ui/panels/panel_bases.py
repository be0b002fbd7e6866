"""What the panels of the properties editor have in common."""

from ...engine.refocus.scene_refocus import refocus_camera
from ...engine.render_engine import ENGINE_ID
from ..presets.preset_menus import PRESET_CLASSES


class EnginePanel:
    """A panel of the properties editor that is shown while Aplanat is the render engine."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = frozenset({ENGINE_ID})

    @classmethod
    def poll(cls, context):
        """Whether Aplanat is the render engine."""
        return context.engine in cls.COMPAT_ENGINES

    def column(self):
        """Return a column that is laid out as Blender lays out properties."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout.column()


class SwitchHeader:
    """A header with a switch.

    Attributes
    ----------
    switch : str
        Name of the setting.
    """

    switch = "use"

    def owner(self, context):
        """Return the data-block that has the settings: the scene, unless a panel says otherwise."""
        return context.scene.aplanat

    def draw_header(self, context):
        """Draw the switch."""
        self.layout.prop(self.owner(context), self.switch, text="")


class PresetsHeader:
    """A header with presets.

    Attributes
    ----------
    presets : str
        Their kind, out of `ui.presets.preset_menus.KINDS`.
    """

    presets = ""

    def draw_header_preset(self, _context):
        """Draw the button of the presets."""
        _, listing = PRESET_CLASSES[self.presets]
        listing.draw_panel_header(self.layout)


def is_refocused(context):
    """Whether a captured picture is seen through the camera in the editor, whatever the engine."""
    own, chosen = context.scene.aplanat.refocus, refocus_camera(context.scene)
    shown = bool(own.path) and own.use_camera_lens and chosen is not None
    return shown and chosen.data == context.camera


class CameraPanel(EnginePanel):
    """A panel of the camera in the editor.

    Attributes
    ----------
    group : str
        Name of its group of settings.
    """

    bl_context = "data"
    group = ""

    @classmethod
    def poll(cls, context):
        """Whether the editor shows a camera, of Aplanat or of the scene's refocused picture."""
        if context.camera is None:
            return False
        return super().poll(context) or is_refocused(context)

    def owner(self, context):
        """Return the settings of the camera."""
        return getattr(context.camera.aplanat, self.group)

    def begin(self, context):
        """Return the settings and a column for them, dimmed where the camera does not use them."""
        settings, column = self.owner(context), self.column()
        column.active = settings.use
        column.use_property_decorate = True
        return settings, column
