"""A corrected lens: a thin fringe, which most viewers feel more than see."""

import bpy

camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data
chromatic = camera.aplanat.chromatic

chromatic.use = True
chromatic.mode = "SPECTRAL"
chromatic.axial = 0.2
chromatic.lateral = 0.05
chromatic.dispersion = "GLASS"
chromatic.glass = "N-BK7"
chromatic.wavelength_min = 380.0
chromatic.wavelength_max = 780.0
chromatic.use_equalizer = False
chromatic.axial_first = "IDENTITY"
chromatic.axial_then = "IDENTITY"
chromatic.lateral_first = "IDENTITY"
chromatic.lateral_then = "IDENTITY"
