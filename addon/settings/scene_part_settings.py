"""Settings of what stands in a scene: lenses of cameras, materials, lights, the world."""

from .setting import Item, Section, Setting

_HIGHLIGHTS = (
    Item(0, "AUTOMATIC", "Automatic", "Where it is bright and blurred enough"),
    Item(1, "NEVER", "Never", "It is sampled as everything else, however bright it is"),
)

# A table: what belongs to a setting stands together.
# fmt: off
LENS = Section("Real lens", "Camera Properties > Lens > Real Lens", (
    Setting("lens", "", "Lens", "Name of a lens of the library; empty for a thin lens. The lens"
            " limits the f-number. It never changes the focal length by itself", told="lens"),
    Setting("zoom_label", "", "Zoom Position", "Name of the position of a zoom lens; empty for"
            " its first one", told="zoom_position"),
    Setting("exposure", "EVEN", "Exposure", "What becomes of the light that the lens takes away"
            " towards the picture's corners: by its rims, by the angle of the rays, by its pupil."
            " With depth of field only", told="lens_exposure", items=(
            Item(0, "EVEN", "Even", "The picture keeps its brightness everywhere"),
            Item(1, "LENS", "As the Lens", "Light is lost as in a photograph; the middle keeps"
                 " its brightness"),
    )),
    Setting("use_breathing", False, "Focus Breathing", "The nearer the focus, the larger the"
            " picture, as with most lenses: by the focal length of a thin lens, or by the focus"
            " group of a real one. With depth of field only", told="breathing"),
))

_STRENGTH = {"limits": (-100.0, 100.0), "soft": (-10.0, 10.0), "step": 10, "precision": 2}

ABERRATIONS = Section("Aberrations", "Camera Properties > Lens > Aberrations", (
    Setting("spherical", 0.0, "Spherical", "How far the rim of the iris misses: positive makes"
            " discs behind the focus soft and those in front of it outlined, negative the other way"
            " round. 1 is a hundredth of half the picture's diagonal at f/2; stopped down it"
            " vanishes first", field="spherical", told="aberrations.spherical", kept=True,
            **_STRENGTH),
    Setting("coma", 0.0, "Coma", "Tails of points towards the corners: positive points outwards."
            " 1 is as of Spherical, in the corner", field="coma", told="aberrations.coma",
            kept=True, **_STRENGTH),
    Setting("astigmatism", 0.0, "Astigmatism", "Towards the corners, lines that run away from the"
            " middle and lines around it are in focus at different distances. 1 is as of"
            " Spherical, in the corner", field="astigmatism", told="aberrations.astigmatism",
            kept=True, **_STRENGTH),
    Setting("field_curvature", 0.0, "Field Curvature", "The focus bends towards the corners:"
            " positive is nearer to the camera. 1 is as of Spherical, in the corner",
            field="field_curvature", told="aberrations.field_curvature", kept=True, **_STRENGTH),
    Setting("swirl", 0.0, "Swirl", "Blur towards the corners is narrower along the direction away"
            " from the middle, so that it runs round the middle: by that share of its width in the"
            " corner", limits=(0.0, 1.0), subtype="FACTOR", field="swirl",
            told="aberrations.swirl", kept=True),
))

DISTORTION = Section("Distortion", "Camera Properties > Lens > Real Lens > Distortion", (
    Setting("distortion", "NONE", "Distortion", "How the lens bends straight lines: of the whole"
            " picture, in all its passes, with and without depth of field. The middle of the"
            " picture keeps its scale", told="distortion.source", items=(
            Item(0, "NONE", "None", "Straight lines stay straight"),
            Item(1, "DIVISION", "Division Model", "By one number"),
            Item(2, "LENS", "Real Lens", "As the real lens does: the curve of its traced chief"
                 " rays"),
    )),
    Setting("distortion_k", -0.1, "K", "Coefficient of the division model, for distances as shares"
            " of that from the middle of the picture to its corner: negative is a barrel, which"
            " shows more of the scene than the frame holds, positive a pincushion",
            limits=(-0.5, 0.25), step=1, precision=3, told="distortion.terms"),
))

MATERIAL = Section("Material", "Material Properties > Settings", (
    Setting("highlights", "AUTOMATIC", "Highlights", "Whether the light of surfaces with this"
            " material is drawn as bokeh where it is brighter than the camera's threshold",
            items=_HIGHLIGHTS),
))

LAMP = Section("Light", "Light Properties > Bokeh", (
    Setting("highlights", "AUTOMATIC", "Highlights", "Whether what surfaces reflect of this light"
            " is drawn as bokeh where it is brighter than the camera's threshold",
            items=_HIGHLIGHTS),
))

WORLD = Section("World", "World Properties > Whites", (
    Setting("amplification", 0.0, "Amplify Whites", "How much brighter white is taken to be in a"
            " world image that holds nothing brighter (8 bits a channel), as background and as"
            " light: 100 to 200 makes lamps out of its white spots, 0 changes nothing. What is"
            " brighter than white grows by as much as white does", limits=(0.0, 10000.0),
            soft=(None, 200.0), step=100, precision=1, told="amplify_whites"),
))
# fmt: on
