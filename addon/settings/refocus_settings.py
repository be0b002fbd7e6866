"""Settings of a scene's refocused picture: files, focus, f-number, whose lens."""

from .scene_settings import MAX_SAMPLES
from .setting import Item, Section, Setting

_PLACE = "Image Editor > Sidebar > Aplanat > Refocus"

# A table: what belongs to a setting stands together.
# fmt: off
REFOCUS = Section("Refocused picture", _PLACE, (
    Setting("path", "", "Depth Layers", "The captured file, or any EXR picture with a depth pass;"
            " #### is the number of the scene's frame", subtype="FILE_PATH"),
    Setting("image", None, "Image", "The image that shows the captured picture through the lens"),
    Setting("camera", None, "Camera", "Whose focus, f-number and lens may be used; without one,"
            " the scene's camera"),
    Setting("focus_from", "OWN", "Focus", "Where the focus distance comes from", items=(
            Item(0, "OWN", "Distance", "Focus at the distance below, which can be keyframed and"
                 " picked in the image"),
            Item(1, "CAMERA", "Camera", "Focus as the camera does"),
    )),
    Setting("focus_distance", 10.0, "Focus Distance", "Distance of the plane in focus from the"
            " lens, along the optical axis", limits=(1e-5, None), soft=(0.01, 1000.0),
            step=10, precision=3, subtype="DISTANCE"),
    Setting("fstop_from", "OWN", "F-Stop", "Where the f-number comes from", items=(
            Item(0, "OWN", "Number", "The f-number below, which can be keyframed"),
            Item(1, "CAMERA", "Camera", "The camera's f-number"),
    )),
    Setting("fstop", 2.8, "F-Stop", "F-number of the lens: smaller numbers blur more",
            limits=(0.001, None), soft=(0.1, 128.0), step=10, precision=2),
    Setting("use_camera_lens", True, "Camera's Lens", "Use lens, iris, fringes and bokeh of the"
            " camera (Camera Properties); off: a thin lens with the iris of the capture"),
    Setting("samples", 128, "Samples", "Places on the lens from which the layers are seen. More"
            " make blurred parts smoother; the amount of blur stays the same",
            limits=(1, MAX_SAMPLES), soft=(16, 1024)),
    Setting("output", "//refocused_####.exr", "Picture File", "Where refocused pictures are"
            " written: .exr (float, scene linear) or .png (as displayed); #### is the frame's"
            " number", subtype="FILE_PATH"),
))

DEPTH_PASS = Section("Pictures with a depth pass", f"{_PLACE} > Depth Pass", (
    Setting("depth_channel", "", "Depth Channel", "Name of the channel that has the depth; empty:"
            " the one with a usual name"),
    Setting("color_layer", "", "Color Layer", "What stands before .R in the names of the channels"
            " that have the colors; empty: the usual ones"),
    Setting("depth_values", "AUTO", "Values", "What the values of the depth stand for", items=(
            Item(0, "AUTO", "Guess", "Meters, unless they look as if they were normalized"),
            Item(1, "SCALED", "Scaled", "Meters after a multiplication"),
            Item(2, "NORMALISED", "Normalized", "0 and 1 stand for the depths below"),
    )),
    Setting("depth_scale", 1.0, "Scale", "Meters in a unit of the depth", limits=(1e-6, None),
            soft=(0.001, 1000.0)),
    Setting("depth_near", 0.1, "Near", "The nearer depth that normalized values stand for",
            limits=(0.0, None), soft=(None, 1000.0), subtype="DISTANCE"),
    Setting("depth_far", 100.0, "Far", "The farther depth that normalized values stand for",
            limits=(1e-6, None), soft=(None, 10000.0), subtype="DISTANCE"),
    Setting("use_inverted_depth", False, "Inverted", "Normalized values are 1 at the near end;"
            " others are one over the depth"),
    Setting("use_ray_depth", False, "Ray Depth", "Depth is the distance from the lens, not the one"
            " along the optical axis"),
))
