"""Soft edges behind the focus, as of an undercorrected portrait lens."""

import bpy

camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data
bokeh = camera.aplanat.bokeh

bokeh.hardness = -0.8
bokeh.profile_strength = 1.0
bokeh.blade_curvature = 1.0
bokeh.vignetting = "LENS"
bokeh.vignetting_strength = 0.3
bokeh.vignetting_softness = 0.0
bokeh.distortion_source = "NONE"
bokeh.distortion = -0.1
bokeh.grain = 0.0
bokeh.grain_size = 0.05
bokeh.dust = 0
bokeh.dust_size = 0.06
bokeh.dust_depth = 0.5
bokeh.texture_seed = 0
bokeh.diffraction = 0.0
bokeh.onion = 0.0
bokeh.onion_pitch = 0.045
bokeh.onion_irregularity = 0.5
