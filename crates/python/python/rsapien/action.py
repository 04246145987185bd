"""Actions built in code.

An :class:`Action` is a text in the action language; its methods write that text. Blocks are ``with``
statements::

    greet = Action("greet", description="Waves and nods.", tags=["greeting"])
    greet.parameter("rounds", 2)
    greet.do("right-arm-up", "right-hand-open")
    with greet.repeat("rounds"):
        greet.do("right-arm-front", ms=650)
        greet.do("right-arm-up", ms=700)
    greet.play("nod", mirrored=True)

What is wrong with it is told by :meth:`Action.check`, as for an action that was written by hand.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import Any, Iterator, Mapping, Optional, Sequence, Union

from rsapien import _rsapien

__all__ = ["Action"]

Time = Union[int, str]
"""Milliseconds, or the name of a parameter."""
Number = Union[int, float, str]
"""A number, or the name of a parameter."""


class Action:
    """One action, as text in the action language."""

    def __init__(self, name: str, *, description: str = "", tags: Sequence[str] = ()) -> None:
        self._name = name
        self._parameters: list[str] = []
        self._head: list[str] = []
        self._body: list[str] = []
        self._depth = 1
        self._source: Optional[str] = None
        if description:
            self._head.append(f"description {_quoted(description)}")
        if tags:
            self._head.append(f"tags {', '.join(tags)}")

    @classmethod
    def parse(cls, text: str) -> Action:
        """The action of a text; the text is kept as it is, with its comments.

        Raises ``ActionRefused`` where it cannot be read or holds another number of actions than one.
        """
        action = cls(_rsapien.action_name(text))
        action._source = text
        return action

    @classmethod
    def load(cls, name: str, registry: Optional[_rsapien.Registry] = None) -> Action:
        """A stored action (without a registry: one of those that come with the robot)."""
        found = registry if registry is not None else _rsapien.Registry.in_memory()
        return cls.parse(found.text(name))

    @property
    def name(self) -> str:
        """The name it is played by."""
        return self._name

    @property
    def text(self) -> str:
        """The text in the action language."""
        if self._source is not None:
            return self._source
        parameters = f"({', '.join(self._parameters)})" if self._parameters else ""
        lines = [f"action {self._name}{parameters} {{"]
        lines += [f"    {line}" for line in self._head]
        lines += self._body
        return "\n".join([*lines, "}"]) + "\n"

    def parameter(self, name: str, default: Number, *, ms: bool = False) -> Action:
        """A parameter with its default: a number, or with ``ms=True`` a time in milliseconds."""
        value = _time(default) if ms else _number(default)
        self._own_text()
        self._parameters.append(f"{name} = {value}")
        return self

    def allow(self, rule: str, reason: str) -> Action:
        """Silences a rule of the checker, and says why."""
        self._own_text()
        self._head.append(f"allow {rule} {_quoted(reason)}")
        return self

    def do(self, *primitives: Union[str, int], ms: Optional[Time] = None) -> Action:
        """Motion primitives that start together; without ``ms`` for as long as their joints need."""
        duration = "" if ms is None else f" for {_time(ms)}"
        return self._add(f"do {' + '.join(str(primitive) for primitive in primitives)}{duration}")

    def wait(self, ms: Time) -> Action:
        """Nothing new; joints under way keep travelling."""
        return self._add(f"wait {_time(ms)}")

    def wait_for(self, *bumpers: str, at_most_ms: Time, otherwise: str = "go-on") -> Action:
        """Stands until a bumper is pressed; ``otherwise`` is ``go-on``, ``end`` or ``play NAME``."""
        ending = "" if otherwise == "go-on" else f" else {otherwise}"
        return self._add(f"wait for {', '.join(bumpers)} at most {_time(at_most_ms)}{ending}")

    def play(
        self,
        action: str,
        *,
        times: Number = 1,
        speed: Number = 1,
        mirrored: bool = False,
        arguments: Optional[Mapping[str, Union[Number, str]]] = None,
        **more: Union[Number, str],
    ) -> Action:
        """Another action. Values of its parameters are given by name, with ``_`` for ``-``, or in ``arguments``
        where a parameter is called like something here (``times``).

        Times are given as in the language (``"650ms"``), numbers as numbers.
        """
        text = f"play {action}"
        values = _arguments({**(arguments or {}), **more})
        if values:
            text += f"({', '.join(f'{name} = {value}' for name, value in values.items())})"
        text += " mirrored" if mirrored else ""
        text += "" if speed == 1 else f" at {_number(speed)}"
        text += "" if times == 1 else f" times {_number(times)}"
        return self._add(text)

    def on(self, *bumpers: str, then: str) -> Action:
        """What is done when a bumper is met, to the end of the block: ``end``, ``go-on`` or ``play NAME``."""
        return self._add(f"on {', '.join(bumpers)} {then}")

    def label(self, name: str) -> Action:
        """A place with a name."""
        return self._add(f"label {name}")

    def repeat(self, count: Number) -> Any:
        """``with action.repeat(3):`` repeats what is added within."""
        return self._block(f"repeat {_number(count)}")

    def mirror(self) -> Any:
        """``with action.mirror():`` left for right."""
        return self._block("mirror")

    def speed(self, factor: Number) -> Any:
        """``with action.speed(0.8):`` slower or faster."""
        return self._block(f"speed {_number(factor)}")

    def together(self) -> Any:
        """``with action.together():`` what its tracks hold runs side by side."""
        return self._block("together")

    def track(self) -> Any:
        """``with action.track():`` one of the rows of a ``together``."""
        return self._block("track")

    def check(self, registry: Optional[_rsapien.Registry] = None) -> list[_rsapien.Finding]:
        """Everything that the checker finds; empty where all is well."""
        return (registry or _rsapien.Registry.in_memory()).check(self.text)

    def timeline(
        self, registry: Optional[_rsapien.Registry] = None, **arguments: Union[Number, str]
    ) -> _rsapien.Timeline:
        """The joints over time; in a notebook it is shown as a picture."""
        return (registry or _rsapien.Registry.in_memory()).timeline(self, arguments=_arguments(arguments))

    def _add(self, line: str) -> Action:
        self._own_text()
        self._body.append("    " * self._depth + line)
        return self

    def _own_text(self) -> None:
        if self._source is not None:
            raise ValueError(f"the action {self._name!r} was read from a text: change that, or build a new one")

    @contextmanager
    def _block(self, head: str) -> Iterator[Action]:
        self._add(f"{head} {{")
        self._depth += 1
        try:
            yield self
        finally:
            self._depth -= 1
            self._add("}")

    def _repr_svg_(self) -> Optional[str]:
        try:
            return self.timeline().svg()
        except _rsapien.RsapienError:
            # What cannot be compiled by itself has no picture; the text is shown instead.
            return None

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"Action({self._name!r})"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{escaped}"'


def _time(value: Time) -> str:
    return f"{value}ms" if isinstance(value, int) else str(value)


def _number(value: Number) -> str:
    if isinstance(value, float):
        return f"{value:.3f}".rstrip("0").rstrip(".")
    return str(value)


def _arguments(arguments: dict[str, Union[Number, str]]) -> dict[str, str]:
    return {name.replace("_", "-"): _number(value) for name, value in arguments.items()}
