"""Slightly bright edges, curved blades, soft cat's eyes, a barrel, some grain and dust."""

import bpy

camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data
bokeh = camera.aplanat.bokeh

bokeh.hardness = 0.4
bokeh.profile_strength = 1.0
bokeh.blade_curvature = 0.4
bokeh.vignetting = "ANALYTIC"
bokeh.vignetting_strength = 0.45
bokeh.vignetting_softness = 0.5
bokeh.distortion_source = "DIVISION"
bokeh.distortion = -0.03
bokeh.grain = 0.08
bokeh.grain_size = 0.04
bokeh.dust = 14
bokeh.dust_size = 0.05
bokeh.dust_depth = 0.4
bokeh.texture_seed = 3
bokeh.diffraction = 0.0
bokeh.onion = 0.0
bokeh.onion_pitch = 0.045
bokeh.onion_irregularity = 0.5
