"""For blocking: noise is visible in strong blur."""

import bpy

scene = bpy.context.scene

scene.aplanat.method = "REFERENCE"
scene.aplanat.render_samples = 32
scene.aplanat.preview_samples = 16
scene.aplanat.pixel_filter = "BLACKMAN_HARRIS"
scene.render.filter_size = 1.5
