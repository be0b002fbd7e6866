"""What a setting is: one declaration, from which everything that knows of it follows.

From the sections of this room follow Blender's properties and what is stored in a file
(`ui.properties`), fields of the snapshot that take a setting as it is (`scene`), bounds of the
command line, what statistics tell, what presets keep, and the page docs/reference/settings.md.
Where a setting is drawn is decided by the panels; a test holds them to draw every one.
"""

from collections.abc import Mapping
from dataclasses import dataclass

# The largest whole number of a Blender property.
MOST_WHOLE = 2**31 - 1


@dataclass(frozen=True)
class Item:
    """One choice of a setting.

    Parameters
    ----------
    number : int
        What Blender files store. It never changes, and that of an item that was dropped is never
        given to another.
    identifier : str
        What Python, presets and snapshots call it.
    label, description : str
        For people.
    """

    number: int
    identifier: str
    label: str
    description: str


@dataclass(frozen=True)
class Setting:
    """One setting.

    Parameters
    ----------
    name : str
        Of the property. Files are read by it: what is meant differently gets another name.
    default : bool, int, float, str or None
        Tells the type, too; None is a pointer to a data-block.
    label, description : str
        For people; Blender ends the tooltip with a dot.
    limits : tuple of two numbers or None
        The smallest and the largest value; None has no limit.
    soft : tuple of two numbers or None
        The same for dragging with the mouse, where it is narrower.
    step : int or float or None
        Of dragging, in hundredths.
    precision : int or None
        Digits that are shown.
    subtype : str
        Blender's, such as ``"FACTOR"``.
    items : tuple of Item
        What a setting of type str can be; empty for free text.
    field : str
        The field of the snapshot's value that takes the setting as it is; empty if what is
        read of it is decided by more than one setting.
    told : str
        Key in the statistics that tells the setting, or what came of it, with the key of the object
        that it stands in: ``"bokeh.gain"``; empty for none.
    kept : bool
        Presets keep it; of a camera's settings, so does the memory of each real lens.
    """

    name: str
    default: bool | int | float | str | None
    label: str
    description: str
    limits: tuple = (None, None)
    soft: tuple = (None, None)
    step: float | None = None
    precision: int | None = None
    subtype: str = ""
    items: tuple[Item, ...] = ()
    field: str = ""
    told: str = ""
    kept: bool = False

    @property
    def words(self):
        """The choices as the command line and statistics call them, a tuple of str."""
        return tuple(told(item.identifier) for item in self.items)

    def identifier(self, word):
        """Return the identifier of the choice that `words` calls so.

        Raises
        ------
        KeyError
        """
        return dict(zip(self.words, (item.identifier for item in self.items), strict=True))[word]


@dataclass(frozen=True)
class Section:
    """Settings that stand together, in the order in which people meet them.

    Parameters
    ----------
    title : str
    place : str
        Where Blender shows them.
    settings : tuple of Setting
    """

    title: str
    place: str
    settings: tuple[Setting, ...]


def settings_of(*sections):
    """Return the settings of sections by name.

    Parameters
    ----------
    *sections : Section

    Returns
    -------
    dict of str to Setting
    """
    return {setting.name: setting for section in sections for setting in section.settings}


def kept_names(*sections):
    """Return the names of the settings that presets keep, as a tuple of str."""
    return tuple(name for name, setting in settings_of(*sections).items() if setting.kept)


def fields_of(group, *sections):
    """Return the fields of a snapshot's value that take settings as they are.

    Parameters
    ----------
    group : object
        Has an attribute for each setting, as Blender's property groups have.
    *sections : Section

    Returns
    -------
    dict of str
    """
    return {
        setting.field: getattr(group, name)
        for name, setting in settings_of(*sections).items()
        if setting.field
    }


def told_by(value, *sections):
    """Return the statistics of a snapshot's value, by key: choices as words in lower case.

    Parameters
    ----------
    value : object
        Has the fields that `fields_of` named.
    *sections : Section

    Returns
    -------
    dict of str
    """
    return {
        setting.told.rpartition(".")[2]: told(getattr(value, setting.field))
        for setting in settings_of(*sections).values()
        if setting.field and setting.told
    }


def told(value):
    """Return a value as statistics tell it: a choice as words in lower case."""
    return value.lower().replace("_", "-") if isinstance(value, str) else value


def changed(settings: Mapping[str, Setting], names, **values):
    """Return values by name: defaults, but for those that are given.

    Parameters
    ----------
    settings : mapping of str to Setting
    names : sequence of str
        Whose values are wanted.
    **values
        Other values than the default.
    """
    unknown = set(values) - set(names)
    if unknown:
        raise KeyError(f"no such settings: {sorted(unknown)}")
    return {name: values.get(name, settings[name].default) for name in names}
