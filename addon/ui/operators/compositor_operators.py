"""Operators of the compositor: node groups, wiring of a scene, and the sprite of a lens."""

from pathlib import Path

import bpy

from ...compositor.asset_library import add_library, bundled_folder, known_library
from ...compositor.node_groups import FRINGE, GROUPS, MIX, SPRITE, node_group
from ...compositor.sprite_image import (
    LEAST,
    MOST,
    camera_sprite,
    fill_empty_groups,
    sprite_group,
    store_sprite,
)
from ...compositor.wiring import wire_picture, wire_render
from ...errors import AplanatError
from ...files.frame_path import frame_path


def is_compositor(context):
    """Whether the current space edits a compositing node group."""
    space = context.space_data
    return (
        space is not None
        and space.type == "NODE_EDITOR"
        and space.tree_type == "CompositorNodeTree"
        and space.edit_tree is not None
    )


class _NodeAdder:
    """Adds a group node to the edited tree and lets it follow the pointer, as Blender's own do."""

    @classmethod
    def poll(cls, context):
        """Whether there is a tree to add to."""
        if not is_compositor(context):
            cls.poll_message_set("Open a compositing node group in the Compositor")
            return False
        return context.space_data.edit_tree.is_editable

    def invoke(self, context, event):
        """Add the node where the pointer is, and move it."""
        space = context.space_data
        if context.region is not None and context.region.type == "WINDOW":
            space.cursor_location_from_region(event.mouse_region_x, event.mouse_region_y)
        if "FINISHED" not in self.execute(context):
            return {"CANCELLED"}
        if context.region is not None and context.region.type == "WINDOW":
            bpy.ops.node.translate_attach_remove_on_cancel("INVOKE_DEFAULT")
        return {"FINISHED"}

    def add_node(self, context, group):
        """Add a node of a group, selected and active."""
        space = context.space_data
        tree = space.edit_tree
        for node in tree.nodes:
            node.select = False
        node = tree.nodes.new("CompositorNodeGroup")
        node.node_tree = group
        node.width = 200.0
        node.location = space.cursor_location
        tree.nodes.active = node


class APLANAT_OT_add_node_group(_NodeAdder, bpy.types.Operator):
    """Add one of Aplanat's node groups to the compositor."""

    bl_idname = "node.aplanat_add_group"
    bl_label = "Add Aplanat Node Group"
    bl_options = {"REGISTER", "UNDO"}

    group: bpy.props.EnumProperty(
        name="Group",
        items=[(name, name, GROUPS[name].description) for name in (MIX, FRINGE)],
        default=MIX,
    )

    @classmethod
    def description(cls, _context, properties):
        """Return the tooltip of this entry."""
        return GROUPS[properties.group].description

    def execute(self, context):
        """Add it."""
        self.add_node(context, node_group(self.group))
        return {"FINISHED"}


class _SpriteMaker:
    """What the operators that draw a sprite share."""

    field: bpy.props.FloatVectorProperty(
        name="Place",
        description="Place of the point in the picture: 0 is the middle, 1 the edge to the right"
        " and the upper one",
        size=2,
        default=(0.0, 0.0),
        soft_min=-1.0,
        soft_max=1.0,
    )
    side: bpy.props.EnumProperty(
        name="Depth",
        items=(
            ("BEHIND", "Behind the Focus", "A point at infinity"),
            ("FRONT", "In Front of the Focus", "A point at half the focus distance"),
        ),
        default="BEHIND",
    )
    size: bpy.props.IntProperty(
        name="Size",
        description="Pixels along a side. Convolve's disc has this size; Bokeh Blur has its own",
        min=LEAST,
        max=MOST,
        default=256,
    )

    def draw_sprite(self, context):
        """Draw the sprite into the camera's image.

        Returns
        -------
        bpy.types.Image or None
            None where there is none, which is reported.
        """
        camera = context.scene.camera
        depsgraph = context.evaluated_depsgraph_get()
        behind = self.side == "BEHIND"
        try:
            light = camera_sprite(depsgraph, camera, tuple(self.field), behind, self.size)
        except AplanatError as error:
            self.report({"ERROR"}, f"camera '{camera.name}': {error}")
            return None
        return store_sprite(f"Bokeh of {camera.name}", light)


def _has_camera(cls, context):
    camera = context.scene.camera if context.scene else None
    if camera is None or camera.type != "CAMERA":
        cls.poll_message_set("The scene has no camera")
        return False
    return True


class APLANAT_OT_bokeh_image(_SpriteMaker, bpy.types.Operator):
    """Draw the disc of the camera's lens into an image, or draw it anew."""

    bl_idname = "image.aplanat_bokeh_image"
    bl_label = "Bokeh Sprite of Camera"
    bl_description = (
        "Draw the disc that the scene's camera makes of a point out of focus into an image, for"
        " the nodes Bokeh Blur and Convolve. Nodes that have the image show the new disc"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        """Whether there is a camera."""
        return _has_camera(cls, context)

    def execute(self, context):
        """Draw it, and show it where images are shown."""
        image = self.draw_sprite(context)
        if image is None:
            return {"CANCELLED"}
        fill_empty_groups(image)
        if context.space_data is not None and context.space_data.type == "IMAGE_EDITOR":
            context.space_data.image = image
        self.report({"INFO"}, f"Drew image '{image.name}'")
        return {"FINISHED"}


class APLANAT_OT_add_bokeh_sprite(_SpriteMaker, _NodeAdder, bpy.types.Operator):
    """Add a node that gives the disc of the camera's lens to Bokeh Blur and Convolve."""

    bl_idname = "node.aplanat_add_bokeh_sprite"
    bl_label = SPRITE
    bl_description = GROUPS[SPRITE].description
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        """Whether there are a camera and a tree to add to."""
        return super().poll(context) and _has_camera(cls, context)

    def execute(self, context):
        """Draw the disc, and add the node."""
        image = self.draw_sprite(context)
        if image is None:
            return {"CANCELLED"}
        self.add_node(context, sprite_group(image))
        return {"FINISHED"}


class APLANAT_OT_wire_compositor(bpy.types.Operator):
    """Put Aplanat into the scene's compositing nodes; what is there stays."""

    bl_idname = "scene.aplanat_wire_compositor"
    bl_label = "Set Up Aplanat Compositing"
    bl_options = {"REGISTER", "UNDO"}

    source: bpy.props.EnumProperty(
        name="Picture",
        items=(
            (
                "RENDER",
                "Render",
                "Send the render through Aplanat Mix, with the passes Defocus and Bokeh switched"
                " on. Nodes that took the picture from Render Layers take it from there",
            ),
            (
                "REFOCUSED",
                "Refocused",
                "Take the picture that the Refocus panel has written, in place of the render",
            ),
        ),
        default="RENDER",
    )

    @classmethod
    def description(cls, _context, properties):
        """Return the tooltip of this button."""
        return cls.bl_rna.properties["source"].enum_items[properties.source].description

    @classmethod
    def poll(cls, context):
        """Whether there is a scene whose nodes may be changed."""
        scene = context.scene
        if scene is None or not scene.is_editable:
            return False
        tree = scene.compositing_node_group
        if tree is not None and not tree.is_editable:
            cls.poll_message_set("The scene's compositing nodes are linked from another file")
            return False
        return True

    def execute(self, context):
        """Wire the scene."""
        scene = context.scene
        if self.source == "RENDER":
            changed, notes = wire_render(scene, context.view_layer)
        else:
            written = scene.aplanat.refocus.output
            is_sequence = "#" in Path(written).name
            first = scene.frame_start if is_sequence else scene.frame_current
            path = str(frame_path(Path(bpy.path.abspath(written)), first))
            try:
                changed, notes = wire_picture(scene, path, is_sequence)
            except RuntimeError:
                self.report(
                    {"ERROR"},
                    f"there is no picture '{path}'; write it first (Image Editor > Sidebar >"
                    " Aplanat > Refocus > Output)",
                )
                return {"CANCELLED"}
        for note in notes:
            self.report({"WARNING"}, note)
        if not changed and not notes:
            self.report({"INFO"}, "The compositing nodes are set up already")
        return {"FINISHED"}


class APLANAT_OT_add_asset_library(bpy.types.Operator):
    """Add Aplanat's node groups to the asset libraries of the preferences."""

    bl_idname = "preferences.aplanat_add_asset_library"
    bl_label = "Add Aplanat's Asset Library"
    bl_description = (
        "Show Aplanat's node groups in the asset browser of all files. Adds an entry to Preferences"
        " > File Paths > Asset Libraries, where it can be removed"
    )

    @classmethod
    def poll(cls, _context):
        """Whether there is such a library that is not among the user's."""
        folder = bundled_folder()
        if folder is None:
            cls.poll_message_set("Only the built extension has an asset library")
            return False
        return known_library(folder) is None

    def execute(self, _context):
        """Add it."""
        add_library(bundled_folder())
        self.report({"INFO"}, "Added asset library 'Aplanat'")
        return {"FINISHED"}


class APLANAT_MT_compositor_add(bpy.types.Menu):
    """Add > Aplanat in the compositor."""

    bl_label = "Aplanat"

    def draw(self, _context):
        """Draw an entry for each group."""
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        for name in (MIX, FRINGE):
            layout.operator(APLANAT_OT_add_node_group.bl_idname, text=name).group = name
        layout.operator(APLANAT_OT_add_bokeh_sprite.bl_idname)


def _draw_menu(self, context):
    if is_compositor(context):
        self.layout.menu(APLANAT_MT_compositor_add.__name__)


CLASSES = (
    APLANAT_OT_add_node_group,
    APLANAT_OT_bokeh_image,
    APLANAT_OT_add_bokeh_sprite,
    APLANAT_OT_wire_compositor,
    APLANAT_OT_add_asset_library,
    APLANAT_MT_compositor_add,
)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Register the operators, and put the groups into the Add menu."""
    _register()
    bpy.types.NODE_MT_add.append(_draw_menu)


def unregister():
    """Undo `register`."""
    bpy.types.NODE_MT_add.remove(_draw_menu)
    _unregister()
