"""The permitted deviations of a tube's streams from the given one: widths, missing values, late values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.errors import InputError
from safeloc.language.expr import BoolVar, NumVar
from safeloc.language.renamed import hint
from safeloc.language.system import TransitionSystem
from safeloc.language.units import Enumeration
from safeloc.language.written_claims import inputs_of

PARTS = 1000
"""A factor on all widths is a whole number of these parts."""


@dataclass(frozen=True)
class Channel:
    """Inputs that are lost or late together, since they come in one message.

    drops  how many messages of the recording may never come, in the whole stream
    delay  how many cycles late a message may come
    """

    names: tuple[str, ...]
    drops: int = 0
    delay: int = 0

    @property
    def name(self) -> str:
        """The names as the command line takes them."""
        return "+".join(self.names)


@dataclass(frozen=True)
class Deviations:
    """Widths by name, in the unit of each input, and the channels on which values may be lost or late."""

    widths: Mapping[str, int]
    channels: tuple[Channel, ...] = ()

    def scaled(self, parts: int) -> Deviations:
        """Return the same with so many PARTS of each width, in whole units, rounded down; losses and delays stay as they are."""
        return replace(self, widths={name: width * parts // PARTS for name, width in self.widths.items()})

    def told(self, system: TransitionSystem) -> str:
        """Return the deviations in words."""
        widths = [f"{name} ± {width}{_unit(system, name)}" for name, width in self.widths.items()]
        lost = [f"{one.name}: {_values(one.drops)} missing" for one in self.channels if one.drops]
        late = [f"{one.name}: up to {_cycles(one.delay)} late" for one in self.channels if one.delay]
        return ", ".join([*widths, *lost, *late]) or "no deviation"


def _unit(system: TransitionSystem, name: str) -> str:
    var = system.variable(name)
    return f" {var.unit.name}" if isinstance(var, NumVar) and var.unit.name != "1" else ""


def _values(number: int) -> str:
    return "1 value" if number == 1 else f"up to {number} values"


def _cycles(number: int) -> str:
    return "1 cycle" if number == 1 else f"{number} cycles"


def deviations(
    system: TransitionSystem,
    widths: Mapping[str, int],
    drops: Mapping[str, int],
    delays: Mapping[str, int],
) -> Deviations:
    """Return the deviations that a user asks for; the keys of drops and delays are names joined by `+`.

    InputError for an unknown name, with candidates, and for a deviation that the input cannot have.
    """
    for name in widths:
        _check_width(system, name)
    together = {tuple(key.split("+")) for key in (*drops, *delays)}
    channels = [Channel(names, drops.get("+".join(names), 0), delays.get("+".join(names), 0)) for names in together]
    channels.sort(key=lambda one: one.names)
    for channel in channels:
        _check_channel(system, channel)
    _refuse_overlap(channels)
    return Deviations(dict(widths), tuple(channels))


def _check_width(system: TransitionSystem, name: str) -> None:
    inputs, ghosts = inputs_of(system), {var.name: var for var in system.ghosts}
    var = {**ghosts, **inputs}.get(name)
    if var is None:
        raise _unknown(system, "--within", name)
    if isinstance(var, BoolVar):
        raise InputError(
            f"--within {name}: it is true or false and has no width; take it out, or try --delay {name}=1."
        )
    if isinstance(var.unit, Enumeration):
        raise InputError(
            f"--within {name}: it is one of {', '.join(var.unit.members)} and has no width; take it out, or try --delay {name}=1."
        )


def _unknown(system: TransitionSystem, option: str, name: str) -> InputError:
    inputs = inputs_of(system)
    near = hint(name, [*inputs])
    if not near and option == "--within":
        near = hint(name, [var.name for var in system.ghosts])
    other = next((one.name for one in system.state if one.name == name), None)
    what = "a state variable, no input" if other else "no output counts, only inputs" if name in system.outputs else ""
    return InputError(
        f"{option}: {system.name} has no input {name!r}{f' (it is {what})' if what and other else ''}; "
        f"it has {', '.join(inputs)}.{near}"
    )


def _check_channel(system: TransitionSystem, channel: Channel) -> None:
    option = "--drop" if channel.drops else "--delay"
    inputs, optional = inputs_of(system), {one.value.name for one in system.optionals}
    for name in channel.names:
        if name not in inputs:
            raise _unknown(system, option, name)
    if len(set(channel.names)) < len(channel.names):
        raise InputError(f"{option} {channel.name}: an input is named twice.")
    never_absent = [name for name in channel.names if name not in optional]
    if channel.drops and never_absent:
        raise InputError(f"--drop {channel.name}: {never_absent[0]} is never absent, so no value of it can be missing.")
    if never_absent and len(never_absent) < len(channel.names):
        raise InputError(
            f"--delay {channel.name}: {never_absent[0]} is never absent and the others may be, so they come in no one message; "
            "give each a --delay of its own."
        )


def _refuse_overlap(channels: Sequence[Channel]) -> None:
    owner: dict[str, Channel] = {}
    for channel in channels:
        for name in channel.names:
            if name in owner:
                raise InputError(
                    f"{name} is lost or late both with {owner[name].name} and with {channel.name}; name the inputs of one message "
                    "in the same way in --drop and --delay."
                )
            owner[name] = channel
