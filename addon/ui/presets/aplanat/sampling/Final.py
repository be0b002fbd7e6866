"""For delivery: strong blur and small bright lights are smooth."""

import bpy

scene = bpy.context.scene

scene.aplanat.method = "ADAPTIVE"
scene.aplanat.use_target_error = True
scene.aplanat.render_error = 0.003
scene.aplanat.preview_error = 0.01
scene.aplanat.render_min_samples = 16
scene.aplanat.preview_min_samples = 16
scene.aplanat.render_max_samples = 4096
scene.aplanat.preview_max_samples = 1024
scene.aplanat.render_samples = 1024
scene.aplanat.preview_samples = 256
scene.aplanat.subsamples = 4
scene.aplanat.use_sharing = True
scene.aplanat.sharing_cells = 2
scene.aplanat.pixel_filter = "BLACKMAN_HARRIS"
scene.render.filter_size = 1.5
