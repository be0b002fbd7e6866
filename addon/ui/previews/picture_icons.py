"""Icons made of pictures: nothing is made before a panel is drawn."""

import bpy.utils.previews
import numpy as np


class PictureIcons:
    """Icons by name, each with what its picture was made of.

    Attributes
    ----------
    shown : dict
        By name: the inputs of the picture that the icon shows.
    """

    def __init__(self):
        self.shown = {}
        self._collection = None

    def icon_id(self, name):
        """Return the number of an icon; 0 while there is no picture."""
        icon = self._collection.get(name) if self._collection else None
        return icon.icon_id if icon else 0

    def reserved_id(self, name):
        """Return the number of an icon that stays; it is empty while there is no picture.

        A popup asks for numbers once, and shows pictures that come while it is open.
        """
        self._made(name)
        return self.icon_id(name)

    def _made(self, name):
        if self._collection is None:
            self._collection = bpy.utils.previews.new()
        return self._collection.get(name) or self._collection.new(name)

    def show(self, name, inputs, picture):
        """Give an icon its picture.

        Parameters
        ----------
        name : str
        inputs : object
            What the picture was made of.
        picture : ndarray of shape (height, width, 4)
            float32, display referred with alpha, bottom row first.
        """
        icon = self._made(name)
        height, width, _ = picture.shape
        icon.image_size = width, height
        icon.image_pixels_float.foreach_set(np.ascontiguousarray(picture).ravel())
        self.shown[name] = inputs

    def icon_ids(self, name, inputs, pictures, count):
        """Return the numbers of icons that are made at once when their inputs have changed.

        Parameters
        ----------
        name : str
        inputs : object
        pictures : callable
            Returns the pictures, as for `show`.
        count : int
            Of the pictures.

        Returns
        -------
        tuple of int
            0 in a Blender without windows.
        """
        if bpy.app.background:
            return (0,) * count
        names = [f"{name}:{number}" for number in range(count)]
        if self.shown.get(names[0]) != inputs:
            for each, picture in zip(names, pictures(), strict=True):
                self.show(each, inputs, picture)
        return tuple(map(self.icon_id, names))

    def register(self):
        """Nothing is made before a panel is drawn."""

    def unregister(self):
        """Free the icons."""
        if self._collection is not None:
            bpy.utils.previews.remove(self._collection)
            self._collection = None
        self.shown.clear()
