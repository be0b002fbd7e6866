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
