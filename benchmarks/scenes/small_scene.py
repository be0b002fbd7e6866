"""The small scene of the command line's tests: glowing planes and two cameras."""

from .materials import emission

SIZE = (48, 32)


def build_scene(bpy):
    """Make the current file a glowing, textured-looking plane behind a smaller one, in focus."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    for name, distance, size, color in (
        ("Far", 8.0, 6.0, (0.1, 0.2, 0.6)),
        ("Near", 4.0, 1.0, (0.9, 0.4, 0.1)),
    ):
        bpy.ops.mesh.primitive_plane_add(size=size, location=(0.0, 0.0, -distance))
        plane = bpy.context.object
        plane.name = name
        plane.data.materials.append(emission(bpy, name, color))
    for name in ("Camera", "Second"):
        camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        scene.collection.objects.link(camera)
        camera.data.dof.focus_distance = 4.0
        camera.data.dof.aperture_fstop = 0.5
        camera.data.dof.use_dof = True
    scene.camera = scene.objects["Camera"]
    render = scene.render
    render.resolution_x, render.resolution_y = SIZE
    render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.aplanat.method = "REFERENCE"
    scene.aplanat.render_samples = 4
    return scene
