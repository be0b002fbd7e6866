"""For delivery: strong blur and small bright lights are smooth."""

import bpy

scene = bpy.context.scene

scene.aplanat.method = "REFERENCE"
scene.aplanat.render_samples = 1024
scene.aplanat.preview_samples = 256
scene.aplanat.pixel_filter = "BLACKMAN_HARRIS"
scene.render.filter_size = 1.5
