"""What a panel draws, told by a layout that notes it instead of drawing."""

from types import MethodType, SimpleNamespace


class Layout:
    """Stands for every layout inside a panel; notes properties, operators and labels."""

    def __init__(self):
        self.drawn = []
        self.operators = []
        self.labels = []

    def prop(self, owner, name, **_):
        self.drawn.append((type(owner).__name__, name))

    def template_ID(self, owner, name, **_):
        self.drawn.append((type(owner).__name__, name))

    template_icon_view = template_ID

    def operator(self, name, text="", **_):
        self.operators.append(SimpleNamespace(operator=name, text=text))
        return self.operators[-1]

    def label(self, text="", **_):
        self.labels.append(text)

    def panel(self, *_, **__):
        return self, self

    def __getattr__(self, name):
        # Rows, columns, labels and all else that only arranges.
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
