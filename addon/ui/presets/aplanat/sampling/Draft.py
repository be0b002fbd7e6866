"""For blocking: noise is visible in strong blur."""

import bpy

scene = bpy.context.scene

scene.aplanat.method = "ADAPTIVE"
scene.aplanat.use_target_error = True
scene.aplanat.render_error = 0.03
scene.aplanat.preview_error = 0.08
scene.aplanat.render_min_samples = 16
scene.aplanat.preview_min_samples = 16
scene.aplanat.render_max_samples = 512
scene.aplanat.preview_max_samples = 256
scene.aplanat.render_samples = 32
scene.aplanat.preview_samples = 16
scene.aplanat.subsamples = 4
scene.aplanat.use_sharing = True
scene.aplanat.sharing_cells = 2
scene.aplanat.pixel_filter = "BLACKMAN_HARRIS"
scene.render.filter_size = 1.5
