"""For reviews: smooth but for the strongest blur."""

import bpy

scene = bpy.context.scene

scene.aplanat.method = "REFERENCE"
scene.aplanat.render_samples = 128
scene.aplanat.preview_samples = 64
scene.aplanat.pixel_filter = "BLACKMAN_HARRIS"
scene.render.filter_size = 1.5
