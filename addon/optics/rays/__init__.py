"""Ray tracing through a lens: trace, aiming, pupils, vignetting, aberrations."""
