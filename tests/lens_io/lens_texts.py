"""Lens files of the tests: a singlet, and a zoom of two lenses with a moving distance."""

SINGLET = """\
format = "lens-description"
format_version = 1

[lens]
name = "Singlet"
focal_length_mm = 99.65
f_number = 4.0
half_field_deg = 6.0

[diaphragm]
blades = 6
blade_curvature = 0.5

[[surface]]
id = "S1"
radius_mm = inf
thickness_mm = 2.0
semi_diameter_mm = 12.4565
material = "air"
stop = true

[[surface]]
radius_mm = 51.5
thickness_mm = 3.6
semi_diameter_mm = 12.7
material = "N-BK7"
conic = -0.5
asphere = { a4_per_mm3 = 1e-9, a6_per_mm5 = 2e-12 }

[[surface]]
id = "BF"
radius_mm = inf
thickness_mm = 97.3
semi_diameter_mm = 12.7
material = "air"
"""

ZOOM = """\
format = "lens-description"
format_version = 1

[lens]
name = "Two lenses"
focal_length_mm = 54.0
f_number = 5.4
half_field_deg = 5.0

[[surface]]
radius_mm = 103.36
thickness_mm = 2.0
semi_diameter_mm = 12.0
material = { nd = 1.5168, vd = 64.2 }

[[surface]]
id = "D2"
radius_mm = -103.36
thickness_mm = 10.0
semi_diameter_mm = 12.0
material = "air"

[[surface]]
radius_mm = inf
thickness_mm = 1.0
semi_diameter_mm = 5.0
material = "air"
stop = true

[[surface]]
radius_mm = 103.36
thickness_mm = 2.0
semi_diameter_mm = 12.0
material = { nd = 1.5168, vd = 64.2 }

[[surface]]
id = "BF"
radius_mm = -103.36
thickness_mm = 50.0
semi_diameter_mm = 12.0
material = "air"

[[zoom]]
label = "wide"
focal_length_mm = 53.45
f_number = 4.8
half_field_deg = 5.0
thickness_mm = { D2 = 10.0, BF = 46.2 }

[[zoom]]
label = "long"
focal_length_mm = 59.8
f_number = 4.15
half_field_deg = 4.0
stop_semi_diameter_mm = 5.0
thickness_mm = { D2 = 30.0, BF = 39.9 }
"""


def changed(text, old, new, count=1):
    """Return the text with its first `old` replaced, which it must hold."""
    assert old in text, old
    return text.replace(old, new, count)
