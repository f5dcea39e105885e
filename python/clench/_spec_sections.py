"""Parts of a model that is built in Python: adding sections and their elements, and finding elements by name."""

from __future__ import annotations

from clench._document import Document, Value, check_kind, written
from clench._element import SpecElement
from clench._state import State


class SpecSections:
    """The elements of a `ModelSpec`, by section and by name."""

    __slots__ = ()

    _document: Document

    @property
    def world(self) -> SpecElement:
        """The world, to which bodies and static objects are added."""
        return self.section("worldbody")

    def section(self, tag: str) -> SpecElement:
        """Returns a section of the document, such as "option", "default" or "contact"; creates it if there is none.

        Parameters
        ----------
        tag : str
            MJCF's name of the section.

        Returns
        -------
        SpecElement

        Raises
        ------
        LoadError
            If MJCF does not have the section.
        """
        node = self._document.root.find(tag)
        if node is None:
            return SpecElement(self._document, self._document.root, ()).add(tag)
        return SpecElement(self._document, node, ())

    def add_actuator(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds an actuator: "motor", "position", "general" and so on.

        Parameters
        ----------
        tag : str
            MJCF's name of the actuator type.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have the tag or an attribute, a value is invalid, or a name is undefined.
        """
        return self.section("actuator").add(tag, **attributes)

    def add_sensor(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds a sensor: "jointpos", "gyro", "touch" and so on.

        Parameters
        ----------
        tag : str
            MJCF's name of the sensor type.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have the tag or an attribute, a value is invalid, or a name is undefined.
        """
        return self.section("sensor").add(tag, **attributes)

    def add_equality(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds an equality constraint: "weld", "connect", "joint" or "tendon".

        Parameters
        ----------
        tag : str
            MJCF's name of the constraint type.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have the tag or an attribute, a value is invalid, or a name is undefined.
        """
        return self.section("equality").add(tag, **attributes)

    def add_tendon(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds a tendon, "fixed" or "spatial"; its path is added to it.

        Parameters
        ----------
        tag : str
            MJCF's name of the tendon type.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have the tag or an attribute, a value is invalid, or a name is undefined.
        """
        return self.section("tendon").add(tag, **attributes)

    def add_keyframe(self, state: State | None = None, /, **attributes: Value) -> SpecElement:
        """Adds a keyframe.

        Parameters
        ----------
        state : State, optional
            A state of a simulation of this model, such as ``sim.state``; by default the attributes define the keyframe.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If the state is that of a batch, since a keyframe is of one environment, or another keyframe has the name.
        LoadError
            If MJCF does not have an attribute, or a value is invalid.

        Examples
        --------
        >>> spec = clench.ModelSpec.from_xml(
        ...     "<mujoco><worldbody><body><joint type='slide'/><geom size='1'/></body></worldbody></mujoco>")
        >>> sim = clench.Sim(spec.build())
        >>> sim.qpos[0] = 0.25
        >>> spec.add_keyframe(sim.state, name="here")["qpos"]
        '0.25'
        """
        kept: dict[str, Value] = {}
        if state is not None:
            if state.qpos.ndim != 1:
                raise ValueError("a keyframe is the state of one environment: use that of batch.sim(env)")
            fields = {"mpos": state.mocap_pos, "mquat": state.mocap_quat}
            fields.update({name: getattr(state, name) for name in ("time", "qpos", "qvel", "act", "plastic", "ctrl")})
            kept = {name: values for name, values in fields.items() if values.size}
        return self.section("keyframe").add("key", **{**kept, **attributes})

    def add_asset(self, tag: str, /, data: bytes | None = None, **attributes: Value) -> SpecElement:
        """Adds an asset: "mesh", "hfield", "material" and so on.

        Parameters
        ----------
        tag : str
            MJCF's name of the asset type.
        data : bytes, optional
            The contents of its ``file``, if that is not on the disk.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If `data` has no name of a file, or another asset of its kind has the name.
        LoadError
            If MJCF does not have the tag or an attribute, a value is invalid, or a name is undefined.
        """
        if data is not None:
            if "file" not in attributes:
                raise ValueError("data needs the name of a file")
            self._document.add_files({written(attributes["file"]): data})
        return self.section("asset").add(tag, **attributes)

    def names(self, kind: str) -> list[str]:
        """Returns the names of all elements of a kind, in the order of the document, without unnamed ones.

        Parameters
        ----------
        kind : str
            "body", "joint", "geom", "site", "actuator", "sensor" and so on.

        Returns
        -------
        list of str

        Raises
        ------
        ValueError
            If there is no such kind.
        """
        check_kind(kind)
        return [name for node in self._document.elements(kind) if (name := SpecElement(self._document, node).name)]

    def find(self, kind: str, name: str) -> SpecElement:
        """Returns the element with this kind and name.

        Parameters
        ----------
        kind : str
            "body", "joint", "geom", "site", "camera", "tendon", "actuator", "sensor", "equality", "keyframe", "frame", "mesh" and so on.
        name : str

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If there is no such kind, or no element has the name.
        """
        found = self._document.find(kind, name)
        if found is None:
            known = ", ".join(self.names(kind)[:10])
            raise ValueError(f'there is no {kind} "{name}"' + (f": there are {known}" if known else ""))
        return SpecElement(*found)

    def body(self, name: str) -> SpecElement:
        """Returns the body with this name; "world" is the world.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If no element has the name.
        """
        return self.world if name == "world" else self.find("body", name)

    def joint(self, name: str) -> SpecElement:
        """Returns the joint with this name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If no element has the name.
        """
        return self.find("joint", name)

    def geom(self, name: str) -> SpecElement:
        """Returns the geom with this name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If no element has the name.
        """
        return self.find("geom", name)

    def site(self, name: str) -> SpecElement:
        """Returns the site with this name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If no element has the name.
        """
        return self.find("site", name)

    def actuator(self, name: str) -> SpecElement:
        """Returns the actuator with this name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If no element has the name.
        """
        return self.find("actuator", name)

    def sensor(self, name: str) -> SpecElement:
        """Returns the sensor with this name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If no element has the name.
        """
        return self.find("sensor", name)

    def keyframe(self, name: str) -> SpecElement:
        """Returns the keyframe with this name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If no element has the name.
        """
        return self.find("keyframe", name)
