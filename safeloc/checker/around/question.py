"""The certificate of a proof around a stream, and the question that it answers: machine, stream, deviations and claims.

Everything but the hand-over sets is made anew from the declaration and the stream beside the certificate.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from safeloc.checker.loading import declared
from safeloc.errors import InputError
from safeloc.language.expr import TRUE, BoolVar, NumVar, Var, all_of
from safeloc.language.interpret import Values, read_inputs, start, step
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, first_without_the_world, without_ghosts
from safeloc.language.units import Enumeration
from safeloc.language.written_claims import read_claim
from safeloc.runtime.streams.steps import StepStream, read_steps
from safeloc.target import Target

CERTIFICATE, SCHEMA = "around.json", "safeloc-around/1"


@dataclass(frozen=True)
class Channel:
    """Inputs of one message; `drops` messages may never come, `delay` is how many cycles late they may come."""

    names: tuple[str, ...]
    drops: int
    delay: int


@dataclass(frozen=True, eq=False)
class Claim:
    """A claim and the cycles in which it is judged. there: the condition under which it says something; None: always."""

    prop: Property
    first: int
    last: int | None
    there: Any = None

    def cycles(self, length: int) -> range:
        """Return the cycles in which the claim is judged; 0 is the first state."""
        return range(self.first, (length if self.last is None else min(self.last, length)) + 1)


@dataclass(frozen=True, eq=False)
class Given:
    """The stream that is given, run: inputs on board, and if it holds the truth the choices and ghosts of the world.

    board   the states on board, the first one included
    ghosts  the ghosts after each cycle, those of the first state included
    """

    rows: Sequence[Values]
    board: Sequence[Values]
    choices: Sequence[Values]
    ghosts: Sequence[Values]


@dataclass(frozen=True, eq=False)
class Question:
    """A question that a certificate answers.

    system  the machine with its world, without the laws that are left out
    data    the certificate as it was read
    """

    folder: Path
    data: Mapping[str, Any]
    target: Target
    system: TransitionSystem
    given: Given
    widths: Mapping[str, int]
    channels: Sequence[Channel]

    @property
    def length(self) -> int:
        """The number of cycles."""
        return len(self.given.rows)

    def claim(self, row: Mapping[str, Any]) -> Claim:
        """Return the claim of a row; InputError if the declaration has none of this name, or it is never judged."""
        name, first, last = str(row["claim"]), int(row["first"]), row["last"]
        if not 0 <= first <= (self.length if last is None else int(last)) <= self.length:
            raise InputError(f"{name}: the stream has the cycles 1 to {self.length}")
        if row["written"]:
            read = read_claim(self.target.system, name)
            return Claim(read.prop, first, last, read.there)
        known = [prop for prop in self.target.properties if prop.name == name and prop.kind != "reachable"]
        if len(known) != 1 or first or last is not None:
            raise InputError(f"{self.target.name} declares no one property {name!r} that is judged in every cycle")
        return Claim(known[0], 0, None)

    def way(self, claims: Sequence[Claim], *, lawful: bool) -> TransitionSystem:
        """Return the system that is run for these claims: on board without the world, or with what they assume of it."""
        if not lawful:
            return without_ghosts(self.system)
        assumed = {(one.prop.unconditional, one.prop.further_assumption) for one in claims}
        if len(assumed) != 1:
            raise InputError("claims of other assumptions are run together")
        [(unconditional, further)] = assumed
        system = self.system
        if unconditional:
            system = replace(system, assume=TRUE, init=first_without_the_world(system))
        return system if further is TRUE else replace(system, assume=all_of([system.assume, further]))


def read_question(folder: Path) -> Question:
    """Read the certificate in a folder, the declaration and the stream that it names. InputError if one is not what it was."""
    path = folder / CERTIFICATE
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data["schema"] != SCHEMA:
            raise InputError(f"{path}: schema {data['schema']!r}; this version reads {SCHEMA!r}.")
        stream = _stream(folder, data["stream"])
        target = declared(data)
        widths = {str(name): int(width) for name, width in data["within"].items()}
        channels = [Channel(tuple(one["names"]), int(one["drops"]), int(one["delay"])) for one in data["channels"]]
        system = _without(target.system, data["without"])
    except (OSError, KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"{path}: not the certificate of a proof around a stream ({type(error).__name__}: {error})."
        ) from error
    _check_deviations(target.system, widths, channels)
    return Question(folder, data, target, system, given(target.system, stream), widths, channels)


def _stream(folder: Path, said: Mapping[str, Any]) -> StepStream:
    path = folder / str(said["file"])
    if path.parent != folder:
        raise InputError(f"{path}: the stream of a certificate stands beside it")
    if hashlib.sha256(path.read_bytes()).hexdigest() != said["digest"]:
        raise InputError(f"{path}: it is another stream than the one of the certificate")
    return read_steps(path)


def _without(system: TransitionSystem, names: Sequence[str]) -> TransitionSystem:
    """Return the system without these laws, each named alone or with its machine; InputError for one that it does not assume."""
    if not names:
        return system
    if system.parts:
        raise InputError("--without: laws that are left out of a composition cannot be checked")
    [machine] = system.machines
    terms = {name: term for name, term in machine.world.terms.items()}
    plain = {name.removeprefix(f"{machine.name}: ") for name in names}
    if not plain <= terms.keys():
        raise InputError(f"{machine.name} assumes no law {sorted(plain - terms.keys())}")
    return replace(system, assume=all_of(term for name, term in terms.items() if name not in plain))


def _check_deviations(system: TransitionSystem, widths: Mapping[str, int], channels: Sequence[Channel]) -> None:
    flags = {option.present for option in system.optionals}
    known = {var.name: var for var in (*system.inputs, *system.ghosts) if var not in flags}
    for name, width in widths.items():
        var = known.get(name)
        if not isinstance(var, NumVar) or isinstance(var.unit, Enumeration) or width < 0:
            raise InputError(f"{name!r} is no input or ghost that has a width")
    named = [name for one in channels for name in one.names]
    inputs = set(system.inputs) - system.ghosts
    board = {name for name, var in known.items() if var in inputs}
    optional = {option.value.name for option in system.optionals}
    if len({*named}) < len(named) or not {*named} <= board or any(one.drops < 0 or one.delay < 0 for one in channels):
        raise InputError("an input of a channel is no input on board, or has two channels")
    for one in channels:
        absent = optional.intersection(one.names)
        if (absent and len(absent) < len(one.names)) or (one.drops and not absent):
            raise InputError(f"{'+'.join(one.names)}: some are never absent")


# ------------------------------------------------------------------ the stream, run


def given(system: TransitionSystem, stream: StepStream) -> Given:
    """Return the stream with its states on board, and with its ghosts if it holds the truth."""
    board = without_ghosts(system)
    rows = [read_inputs(board, _of(board, record)) for record in stream.steps]
    choices = {var.name for var in system.inputs if var in system.ghosts}
    first = {name: value for name, value in stream.first.items() if name in {var.name for var in board.state}}
    states = _states(board, start(board, first), rows)
    if not stream.steps or not choices <= set(stream.steps[0]):
        return Given(rows, states, [], [])
    full = [read_inputs(system, _of(system, record)) for record in stream.steps]
    truth = _states(system, start(system, stream.first), full)
    return Given(rows, states, full, truth)


def _of(system: TransitionSystem, record: Mapping[str, Any]) -> dict[str, Any]:
    names = {var.name for var in system.inputs}
    return {name: value for name, value in record.items() if name in names}


def _states(system: TransitionSystem, first: Values, rows: Sequence[Values]) -> list[Values]:
    states = [first]
    for row in rows:
        states.append(step(system, states[-1], row)[0])
    return states


def bounds_of(var: Var) -> tuple[int, int] | None:
    """Return the declared range of a number; None for a truth value."""
    return None if isinstance(var, BoolVar) else (var.low, var.high)
