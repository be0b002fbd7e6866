"""For reviews: smooth but for the strongest blur."""

import bpy

scene = bpy.context.scene

scene.aplanat.method = "ADAPTIVE"
scene.aplanat.use_target_error = True
scene.aplanat.render_error = 0.01
scene.aplanat.preview_error = 0.03
scene.aplanat.render_min_samples = 16
scene.aplanat.preview_min_samples = 16
scene.aplanat.render_max_samples = 2048
scene.aplanat.preview_max_samples = 1024
scene.aplanat.render_samples = 128
scene.aplanat.preview_samples = 64
scene.aplanat.subsamples = 4
scene.aplanat.use_sharing = True
scene.aplanat.sharing_cells = 2
scene.aplanat.pixel_filter = "BLACKMAN_HARRIS"
scene.render.filter_size = 1.5
