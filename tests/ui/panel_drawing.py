"""What a panel draws, told by a layout that notes it instead of drawing."""

from types import MethodType, SimpleNamespace


class Layout:
    """Stands for every layout inside a panel; notes properties, operators and labels.

    Attributes
    ----------
    texts : list of (str, str, float)
        Labels with their icons, and the share of the panel's width that is theirs.
    names : list of (str, str, float)
        Names of properties, their type, and the share that is the name's.
    """

    def __init__(self):
        self.drawn = []
        self.operators = []
        self.labels = []
        self.texts = []
        self.names = []
        self.use_property_split = False
        self._share, self._parts = 1.0, ()

    def prop(self, owner, name, text=None, expand=False, **_):
        self.drawn.append((type(owner).__name__, name))
        share, prop = self._next_share(), owner.bl_rna.properties[name]
        if expand:
            return
        if self.use_property_split:
            # As Blender divides a line.
            share *= 0.6 if prop.type == "BOOLEAN" else 0.4
        self.names.append((prop.name if text is None else text, prop.type, share))

    def template_ID(self, owner, name, **_):
        self.drawn.append((type(owner).__name__, name))

    template_icon_view = template_ID

    def operator(self, name, text="", **_):
        self.operators.append(SimpleNamespace(operator=name, text=text))
        return self.operators[-1]

    def label(self, text="", icon="NONE", **_):
        self.labels.append(text)
        self.texts.append((text, icon, self._next_share()))

    def panel(self, *_, **__):
        return self, self

    def split(self, factor=0.5, **_):
        return self._part(self._next_share(), (factor, 1.0 - factor))

    def _next_share(self):
        return self._share * next(self._parts) if self._parts else self._share

    def _part(self, share, parts=()):
        part = Layout()
        part.drawn, part.operators = self.drawn, self.operators
        part.labels, part.texts, part.names = self.labels, self.texts, self.names
        part.use_property_split = self.use_property_split
        part._share, part._parts = share, iter(parts) if parts else ()
        return part

    def _inner(self, *_, **__):
        return self._part(self._next_share())

    row = column = box = _inner

    def __getattr__(self, name):
        # All else that only arranges.
        return lambda *_, **__: self


def draw(panel, context, header=False):
    """Draw a panel, if it is shown at all; return its layout.

    Parameters
    ----------
    panel : type
    context : object
        Has what the panel reads of Blender's context.
    header : bool
        Draw its header, too.
    """
    layout = Layout()
    if not getattr(panel, "poll", lambda _: True)(context):
        return layout

    class Drawing:
        def __getattr__(self, name):
            found = getattr(panel, name)
            return MethodType(found, self) if callable(found) else found

    drawing = Drawing()
    drawing.layout = layout
    for name in ("draw_header", "draw") if header else ("draw",):
        if hasattr(panel, name):
            getattr(panel, name)(drawing, context)
    return layout


def panels_of(modules, editors):
    """Return the panels of modules in editors, but for those of presets."""
    panels = [cls for module in modules for cls in getattr(module, "CLASSES", ())]
    panels = [cls for cls in panels if "_PT_" in cls.__name__ and "presets" not in cls.__name__]
    return [cls for cls in panels if cls.bl_space_type in editors]


def states(context):
    """Go through the choices on which it depends what a panel shows.

    Parameters
    ----------
    context : object
        Of the fixture `context`.
    """
    own, settings = context.camera.aplanat, context.scene.aplanat
    yield
    settings.use_target_error = False
    own.bokeh.model, own.bokeh.vignetting = "CLUSTERED", "ANALYTIC"
    own.distortion, own.chromatic.dispersion = "DIVISION", "GLASS"
    yield
    own.lens, own.compared_lens = "zoom-36-69mm-f3.5", "tessar-50mm-f2.8"
    settings.method = "REFERENCE"
    yield
    settings.method = "LAYERED"
    own_refocus = settings.refocus
    own_refocus.path, own_refocus.depth_values = "layers.exr", "SCALED"
    yield
    own_refocus.depth_values = "NORMALISED"
    yield
