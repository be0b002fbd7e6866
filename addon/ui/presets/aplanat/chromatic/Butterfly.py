"""Axial colour as of a lens; lateral changes its direction from right to left."""

import bpy

camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data
chromatic = camera.aplanat.chromatic

chromatic.use = True
chromatic.mode = "SPECTRAL"
chromatic.axial = 1.0
chromatic.lateral = 1.0
chromatic.dispersion = "GLASS"
chromatic.glass = "N-BK7"
chromatic.wavelength_min = 380.0
chromatic.wavelength_max = 780.0
chromatic.use_equalizer = False
chromatic.axial_first = "IDENTITY"
chromatic.axial_then = "IDENTITY"
chromatic.lateral_first = "T_COS_THETA"
chromatic.lateral_then = "IDENTITY"
