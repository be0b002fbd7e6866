"""Bokeh profiles in EXR files, with what they were made from.

Parts of the file, all in single precision:

- ``rays.0``, ``rays.1``, ...: the ray map of each focus state, channel ``Y``; rows are value,
  wavelength and vergence (in this order, the last fastest), columns the share of the pupil.
- ``table`` (if it was asked for): the paper's table, one row for each plane, columns over radius,
  channel ``Y`` or ``R``, ``G``, ``B``. Values are energy per area in units of the row's extent:
  with n columns, ``sum_j value_j pi ((j + 1)^2 - j^2) / n^2`` is 1 in each row and channel.
- ``table.rows``: one column for each row of the table, channels ``plane_mm`` (from surface 1),
  ``image_distance_mm`` (from H') and ``extent_mm``.
- further parts that a caller adds (the off-axis pupil).

The first header says in plain attributes what the file is (format, version, lens, zoom position,
hash of the prescription, wavelengths, units), and in ``profile``, as JSON with all digits, the
numbers of the profile besides the arrays. ``checksum`` is that of attributes and arrays.
"""

import hashlib
import json
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path

import numpy as np

from ..errors import InputError, UnfinishedFileError
from ..files.whole_file import whole_file
from ..lens_bokeh.tables.focus_state import FocusState
from ..lens_bokeh.tables.profile import LensProfile, ProfileTable
from ..lens_bokeh.tables.ray_map import RayMap
from ..optics.paraxial import FirstOrder

FORMAT = "aplanat-bokeh-profile"
FORMAT_VERSION = 1
_CHANNELS = {1: "Y", 3: "RGB"}
_ROW_CHANNELS = ("plane_mm", "image_distance_mm", "extent_mm")
_RAYS, _TABLE, _TABLE_ROWS = "rays.", "table", "table.rows"
_ARRAYS = ("values", "limits")
# Words of the file that belong to the EXR part, and the checksum itself.
_NOT_CHECKED = {"name", "type", "channelOrder", "checksum"}


@dataclass(frozen=True)
class StoredProfile:
    """The contents of a profile file.

    Parameters
    ----------
    profile : LensProfile or None
        None in a file that holds further parts only.
    table : ProfileTable or None
    words : dict of str to str
        Attributes of the file, those of a caller among them.
    pictures : dict of str to ndarray
        Further parts, float32, shape (height, width, channels).
    """

    profile: LensProfile | None
    table: ProfileTable | None = None
    words: dict[str, str] = field(default_factory=dict)
    pictures: dict[str, np.ndarray] = field(default_factory=dict)


def save_profile(path, stored, *, lens_id="", content_hash=""):
    """Write a profile; the file is there whole or not at all.

    Parameters
    ----------
    path : Path
    stored : StoredProfile
        `words` are added to the attributes.
    lens_id, content_hash : str
        Of the lens; see `profile_cache.content_hash`.

    Raises
    ------
    UnfinishedFileError
        If the file cannot be written.
    """
    import OpenEXR

    pictures, words = {}, {"format": FORMAT, "formatVersion": str(FORMAT_VERSION)}
    words |= {"lensId": lens_id, "lensHash": content_hash, "units": "mm, nm, energy 1 a row"}
    if stored.profile:
        pictures |= _profile_pictures(stored.profile)
        words |= _profile_words(stored.profile)
    if stored.table:
        pictures |= _table_pictures(stored.table)
        words["objectDistance_mm"] = repr(float(stored.table.object_distance))
    pictures |= stored.pictures
    words = stored.words | words
    words["checksum"] = _checksum(words, pictures)
    # All parts of a file share one display window.
    size = np.max([pixels.shape[1::-1] for pixels in pictures.values()], axis=0)
    window = (np.zeros(2, np.int32), (size - 1).astype(np.int32))
    parts = []
    for name, pixels in pictures.items():
        header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
        header["displayWindow"] = window
        header |= {} if parts else words
        header["channelOrder"] = ",".join(_names(name, pixels.shape[2]))
        channels = {
            channel: np.ascontiguousarray(pixels[..., i], np.float32)
            for i, channel in enumerate(_names(name, pixels.shape[2]))
        }
        parts.append(OpenEXR.Part(header, channels, name))
    with whole_file(path) as place:
        try:
            OpenEXR.File(parts).write(place)
        except RuntimeError as error:
            raise UnfinishedFileError(f"cannot write '{path}': {error}") from error


def load_profile(path):
    """Read a profile file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    StoredProfile

    Raises
    ------
    InputError
        If it is no profile of a version that is known here, or damaged.
    """
    if not Path(path).is_file():
        raise InputError(f"there is no file '{path}'")
    try:
        words, pictures = _read(path)
    except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"'{path}' cannot be read as an EXR file: {error}") from error
    if words.get("format") != FORMAT:
        raise InputError(f"'{path}' is not a bokeh profile; make one with 'aplanat lens bake'")
    if words.get("formatVersion") != str(FORMAT_VERSION):
        raise InputError(
            f"'{path}' has version {words.get('formatVersion')} of the profile format; this "
            f"Aplanat reads version {FORMAT_VERSION}: bake the lens again"
        )
    if words.get("checksum") != _checksum(words, pictures):
        raise InputError(f"'{path}' is damaged: its checksum is wrong; bake the lens again")
    try:
        profile = _profile(words, pictures) if "profile" in words else None
        table = _table(words, pictures) if _TABLE in pictures else None
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"'{path}' is damaged ({error}); bake the lens again") from error
    own = {name for name in pictures if name in (_TABLE, _TABLE_ROWS) or name.startswith(_RAYS)}
    rest = {name: pixels for name, pixels in pictures.items() if name not in own}
    return StoredProfile(profile, table, words, rest)


def _read(path):
    import OpenEXR

    pictures, words = {}, {}
    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            if not words:
                words = {k: v for k, v in part.header.items() if isinstance(v, str)}
            channels = part.channels
            order = part.header["channelOrder"].split(",")
            pixels = [np.asarray(channels[name].pixels, np.float32) for name in order]
            pictures[part.name()] = np.stack(pixels, axis=-1)
    return words, pictures


def _names(part, count):
    if part == _TABLE_ROWS:
        return _ROW_CHANNELS
    return tuple(_CHANNELS.get(count) or (f"c{i:03d}" for i in range(count)))


def _checksum(words, pictures):
    told = {name: word for name, word in words.items() if name not in _NOT_CHECKED}
    digest = hashlib.sha256(json.dumps(told, sort_keys=True).encode())
    for name in sorted(pictures):
        pixels = np.ascontiguousarray(pictures[name], np.float32)
        digest.update(f"{name} {pixels.shape} ".encode())
        digest.update(pixels.tobytes())
    return digest.hexdigest()


def _profile_pictures(profile):
    pictures = {}
    for i, state in enumerate(profile.states):
        values = state.ray_map.values
        pictures[f"{_RAYS}{i}"] = values.reshape(-1, values.shape[-1], 1)
    return pictures


def _profile_words(profile):
    numbers = {
        "name": profile.name,
        "label": profile.label,
        "f_number": profile.f_number,
        "wavelengths_nm": profile.wavelengths_nm.tolist(),
        "nearness": profile.nearness.tolist(),
        "color": profile.color.tolist(),
        "states": [_state_numbers(state) for state in profile.states],
    }
    return {
        "lens": profile.name,
        "zoom": profile.label or "",
        "wavelengths_nm": ", ".join(f"{w:g}" for w in profile.wavelengths_nm),
        "focalLength_mm": repr(float(profile.states[0].first_order.efl)),
        "profile": json.dumps(numbers),
    }


def _state_numbers(state):
    ray_map = state.ray_map
    numbers = {"shape": list(ray_map.values.shape), "limits": ray_map.limits.tolist()}
    for each in fields(RayMap):
        if each.name not in _ARRAYS:
            numbers[each.name] = np.asarray(getattr(ray_map, each.name)).tolist()
    order = asdict(state.first_order)
    return {"first_order": order, "last_vertex": state.last_vertex, "ray_map": numbers}


def _profile(words, pictures):
    numbers = json.loads(words["profile"])
    states = []
    for i, told in enumerate(numbers["states"]):
        rays = dict(told["ray_map"])
        values = pictures[f"{_RAYS}{i}"][..., 0].reshape(rays.pop("shape"))
        scalars = {name: rays.pop(name) for name in ("plane", "pupil", "pupil_radius")}
        arrays = {name: np.array(value, dtype=np.float64) for name, value in rays.items()}
        ray_map = RayMap(values=values, **scalars, **arrays)
        states.append(FocusState(FirstOrder(**told["first_order"]), told["last_vertex"], ray_map))
    return LensProfile(
        numbers["name"],
        numbers["label"],
        numbers["f_number"],
        np.array(numbers["wavelengths_nm"]),
        np.array(numbers["nearness"]),
        tuple(states),
        np.array(numbers["color"]),
    )


def _table_pictures(table):
    rows = np.stack([table.planes, table.image_distances, table.extents], axis=-1)
    return {_TABLE: table.density, _TABLE_ROWS: rows[None].astype(np.float32)}


def _table(words, pictures):
    rows = pictures[_TABLE_ROWS][0].astype(np.float64)
    density = pictures[_TABLE]
    if len(rows) != len(density):
        raise ValueError("rows of the table and their list differ")
    return ProfileTable(float(words["objectDistance_mm"]), *rows.T, density)
