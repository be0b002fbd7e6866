"""Pictures that are kept up to date while somebody looks at them, and their owner."""


class LivePictures:
    """The live pictures of scenes, which share a session; used by the main thread.

    Parameters
    ----------
    open_session : callable
        Returns a new `RenderSession`.
    """

    def __init__(self, open_session):
        self._open_session = open_session
        self._session = None
        self._pictures = {}
        self._held = set()

    @property
    def session(self):
        """The `RenderSession` of the pictures: opened with the first use, closed with the last."""
        if self._session is None:
            self._session = self._open_session()
        return self._session

    def __len__(self):
        """Return the number of pictures."""
        return len(self._pictures)

    def __iter__(self):
        """Iterate over the pictures."""
        return iter(list(self._pictures.values()))

    def find(self, scene):
        """Return the picture of a scene; None if there is none.

        Parameters
        ----------
        scene : bpy.types.Scene
            Pictures are kept by its `session_uid`.
        """
        return self._pictures.get(scene.session_uid)

    def begin(self, scene, make):
        """Return the picture of a scene; without one it is made by `make` of the session."""
        if self.find(scene) is None:
            self._pictures[scene.session_uid] = make(self.session)
        return self.find(scene)

    def hold(self, scene):
        """End the picture of a scene until `let_go`."""
        self._held.add(scene.session_uid)
        self.keep_only(uid for uid in list(self._pictures) if uid != scene.session_uid)

    def is_held(self, scene):
        """Whether the picture of a scene is held."""
        return scene.session_uid in self._held

    def let_go(self, scene):
        """Undo `hold`."""
        self._held.discard(scene.session_uid)

    def keep_only(self, uids):
        """End all pictures but those of some scenes.

        Parameters
        ----------
        uids : iterable of int
            Their `session_uid`.
        """
        for uid in set(self._pictures) - set(uids):
            self._pictures.pop(uid).close()
        if not self._pictures and self._session is not None:
            self._session.close()
            self._session = None

    def close(self):
        """End all pictures; holds are forgotten."""
        self.keep_only(())
        self._held.clear()
