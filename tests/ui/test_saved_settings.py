"""Every setting of Aplanat survives saving and loading, and as a library override.

The properties are found by walking Blender's description of the groups, so that a new one is
tested without being named here.
"""

import pytest

# Computed from others, never stored.
COMPUTED = {"lens_choice", "zoom", "curve_text", "spectrum", "rna_type", "name"}
OWNERS = {
    "scenes": lambda bpy: bpy.context.scene,
    "cameras": lambda bpy: bpy.data.cameras.new("owner"),
    "lights": lambda bpy: bpy.data.lights.new("owner", "POINT"),
    "materials": lambda bpy: bpy.data.materials.new("owner"),
    "worlds": lambda bpy: bpy.data.worlds.new("owner"),
}
OVERRIDDEN = ("cameras", "lights", "materials", "worlds")


def settings_of(group, path=""):
    """Yield the group, description and path of each stored property, also of groups inside."""
    import bpy

    for name, kind in group.bl_rna.properties.items():
        if name in COMPUTED:
            continue
        value = getattr(group, name) if kind.type == "POINTER" else None
        if isinstance(value, bpy.types.PropertyGroup):
            yield from settings_of(value, f"{path}{name}.")
        else:
            yield group, kind, path + name


def another_value(bpy, group, kind):
    """Return a valid value that is not the default."""
    if kind.type == "BOOLEAN":
        return not kind.default
    if kind.type == "ENUM":
        return next(i.identifier for i in kind.enum_items if i.identifier != kind.default)
    if kind.type == "STRING":
        # Not the name of a lens: that would bring its own settings.
        return "F2" if kind.identifier == "glass" else "another"
    if kind.type in {"FLOAT", "INT"}:
        assert not kind.is_array
        ends = (kind.soft_min, kind.soft_max)
        value = ends[0] if kind.default != ends[0] else ends[1]
        return value if kind.type == "FLOAT" else int(value)
    assert kind.type == "POINTER"
    if kind.fixed_type.identifier == "Image":
        return bpy.data.images.new("iris", 4, 4)
    if kind.fixed_type.identifier == "Object":
        camera = bpy.data.objects.new("another", bpy.data.cameras.new("another"))
        bpy.context.scene.collection.objects.link(camera)
        return camera
    return bpy.data.node_groups.new("curves", "ShaderNodeTree")


def change_all(bpy, owner):
    """Set every property to another value and return what was set, by path."""
    values = {}
    for group, kind, _ in list(settings_of(owner.aplanat)):
        setattr(group, kind.identifier, another_value(bpy, group, kind))
    for group, kind, path in settings_of(owner.aplanat):
        values[path] = stored(group, kind)
    return values


def stored(group, kind):
    value = getattr(group, kind.identifier)
    return value.name if kind.type == "POINTER" and value is not None else value


def read_all(owner):
    return {path: stored(group, kind) for group, kind, path in settings_of(owner.aplanat)}


def defaults(owner):
    return {
        path: None if kind.type == "POINTER" else kind.default
        for _, kind, path in settings_of(owner.aplanat)
    }


def find(bpy, collection):
    if collection == "scenes":
        return bpy.context.scene
    return next(block for block in getattr(bpy.data, collection) if block.library is None)


@pytest.mark.parametrize("collection", [*OWNERS, "view_layers"])
def test_every_setting_is_saved(aplanat_bpy, tmp_path, collection):
    bpy = aplanat_bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    path = str(tmp_path / "saved.blend")
    if collection == "view_layers":
        wanted = change_all(bpy, bpy.context.view_layer)
    else:
        owner = OWNERS[collection](bpy)
        if collection != "scenes":
            owner.use_fake_user = True
        wanted = change_all(bpy, owner)
        assert all(wanted[name] != value for name, value in defaults(owner).items())
    assert wanted
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    is_layer = collection == "view_layers"
    found = read_all(bpy.context.view_layer if is_layer else find(bpy, collection))
    assert found == wanted


def linked_override(bpy, folder, collection):
    """Save a library whose data-block never used Aplanat's settings; return an override of it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    OWNERS[collection](bpy).use_fake_user = True
    library = str(folder / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=library)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(library, link=True) as (_, wanted):
        setattr(wanted, collection, ["owner"])
    made = getattr(bpy.data, collection)["owner"].override_create()
    # A user that the file keeps.
    keep_in_use(bpy, collection, made)
    return made


def keep_in_use(bpy, collection, block):
    scene = bpy.context.scene
    if collection == "worlds":
        scene.world = block
    elif collection == "materials":
        mesh = bpy.data.meshes.new("mesh")
        mesh.materials.append(block)
        scene.collection.objects.link(bpy.data.objects.new("object", mesh))
    else:
        scene.collection.objects.link(bpy.data.objects.new("object", block))


@pytest.mark.parametrize("collection", OVERRIDDEN)
def test_every_setting_is_kept_as_a_library_override(aplanat_bpy, tmp_path, collection):
    bpy = aplanat_bpy
    made = linked_override(bpy, tmp_path, collection)
    wanted = change_all(bpy, made)
    path = str(tmp_path / "user.blend")
    # Twice: what was loaded must be saved as well.
    for _ in range(2):
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        found = find(bpy, collection)
        assert found.override_library is not None
        assert read_all(found) == wanted


@pytest.mark.parametrize("collection", OVERRIDDEN)
def test_what_was_not_overridden_follows_the_library(aplanat_bpy, tmp_path, collection):
    bpy = aplanat_bpy
    made = linked_override(bpy, tmp_path, collection)
    group, kind, changed = list(settings_of(made.aplanat))[-1]
    setattr(group, kind.identifier, another_value(bpy, group, kind))
    mine = stored(group, kind)
    user, library = str(tmp_path / "user.blend"), str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=user)
    bpy.ops.wm.open_mainfile(filepath=library)
    theirs = change_all(bpy, getattr(bpy.data, collection)["owner"])
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=user)
    found = read_all(find(bpy, collection))
    assert found.pop(changed) == mine
    theirs.pop(changed)
    assert found == theirs
