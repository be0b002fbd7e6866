"""Lateral colour is strongest in the middle."""

import bpy

camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data
chromatic = camera.aplanat.chromatic

chromatic.use = True
chromatic.mode = "SPECTRAL"
chromatic.axial = 1.0
chromatic.lateral = 0.5
chromatic.dispersion = "GLASS"
chromatic.glass = "N-BK7"
chromatic.wavelength_min = 380.0
chromatic.wavelength_max = 780.0
chromatic.use_equalizer = False
chromatic.axial_first = "T3"
chromatic.axial_then = "IDENTITY"
chromatic.lateral_first = "ONE_MINUS"
chromatic.lateral_then = "EXP"
