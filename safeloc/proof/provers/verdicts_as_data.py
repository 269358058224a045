"""Verdicts and findings as plain data, to be sent between processes.

Terms are graphs too deep to pickle: they are sent as flat lists, parts before wholes. Traces are sent as first state and
inputs; the receiver makes the runs again. Certificates that both processes have are sent by name.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, assert_never

from safeloc.language.expr import TRUE, Bool, Expr, Var
from safeloc.language.interpret import taken
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, first_without_the_world
from safeloc.language.terms import in_order
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Vacuous, Verdict, Violated
from safeloc.proof.drawn_runs.quick import Again
from safeloc.proof.provers.facts import Fact
from safeloc.proof.provers.implication import Failure
from safeloc.proof.provers.proved_base import Base

Flat = tuple[Any, ...]


@dataclass(frozen=True)
class _Part:
    """A reference to an earlier node of a flat term."""

    index: int


def pack_term(term: Expr) -> Flat:
    """Return the nodes of the term as a flat list; variables by name, parts by index."""
    nodes = in_order([term])
    place: dict[Expr, _Part] = {node: _Part(index) for index, node in enumerate(nodes)}
    return tuple(node.name if isinstance(node, Var) else (type(node), _packed_fields(node, place)) for node in nodes)


def _packed_fields(node: Expr, place: Mapping[Expr, _Part]) -> tuple[Any, ...]:
    values = (getattr(node, field.name) for field in fields(node))  # type: ignore[arg-type] # nodes are dataclasses
    return tuple(
        place[value]
        if isinstance(value, Expr)
        else tuple(place[part] for part in value)
        if isinstance(value, tuple)
        else value
        for value in values
    )


def unpack_term(flat: Flat, system: TransitionSystem) -> Bool:
    """Return the term over the system's variables."""
    nodes: list[Expr] = []
    for packed in flat:
        if isinstance(packed, str):
            nodes.append(system.variable(packed))
        else:
            kind, values = packed
            nodes.append(kind(*(_unpacked_field(value, nodes) for value in values)))
    assert isinstance(nodes[-1], Bool)
    return nodes[-1]


def _unpacked_field(value: Any, nodes: list[Expr]) -> Any:
    if isinstance(value, _Part):
        return nodes[value.index]
    return tuple(nodes[part.index] for part in value) if isinstance(value, tuple) else value


@dataclass(frozen=True)
class PackedTrace:
    """First state and inputs of every step; `part` names the machine of a composition if the run is of that machine
    alone.
    """

    initial: Mapping[str, Value]
    stream: tuple[Mapping[str, Value], ...]
    part: str = ""


def pack_trace(trace: Trace | None) -> PackedTrace | None:
    """Pack the data that are needed to run the trace again."""
    if trace is None:
        return None
    part = trace.system.machines[0].name if trace.system.composition else ""
    return PackedTrace(trace.initial, tuple(step.inputs for step in trace.steps), part)  # a shared step is sent once


def unpack_trace(packed: PackedTrace | None, system: TransitionSystem, again: Again | None = None) -> Trace | None:
    """Return the run, made again; a run of one machine alone is made without its assumption."""
    if packed is None:
        return None
    of = _by_itself(packed.part, system) if packed.part else system
    return (again or Again())(of, packed.stream, first=packed.initial)


@lru_cache(maxsize=32)
def _by_itself(name: str, system: TransitionSystem) -> TransitionSystem:
    alone = next(part.alone for part in system.parts if part.name == name)
    return replace(alone, assume=TRUE, init=first_without_the_world(alone))


def _unpack_escape(packed: PackedTrace | None, system: TransitionSystem) -> Trace | None:
    """Return the run from any state, made again by the interpreter."""
    if packed is None:
        return None
    of = _by_itself(packed.part, system) if packed.part else system
    state = {var: packed.initial[var.name] for var in of.state}
    return Trace(of, packed.initial, tuple(one for one, _ in taken(of, state, packed.stream)))


_HELD: dict[str, tuple[int, str]] = {}
"""Certificates by the names of their files, each with the process that holds it for those that it forks."""


def hold_for_forked(certificates: Mapping[str, str]) -> None:
    """Remember certificates that no process which this one forks from now on has to send back: each proof has those of the base."""
    _HELD.update({file: (os.getpid(), text) for file, text in certificates.items()})


def _packed_texts(certificates: Mapping[str, str]) -> dict[str, str | None]:
    return {file: None if _is_held_before(file, text) else text for file, text in certificates.items()}


def _is_held_before(file: str, text: str) -> bool:
    """Return whether the process that forked this one, or one before that, holds this very text."""
    process, held = _HELD.get(file, (os.getpid(), ""))
    return process != os.getpid() and held is text


def _unpacked_texts(packed: Mapping[str, str | None]) -> dict[str, str]:
    return {file: _HELD[file][1] if text is None else text for file, text in packed.items()}


Packed = tuple[Any, ...]


def pack(verdict: Verdict) -> Packed:
    """Return the verdict as plain data."""
    match verdict:
        case Proved(invariant, engine, depth, rechecked, certificates, witness, by_construction):
            term = None if invariant is None else pack_term(invariant)
            run_ = pack_trace(witness)
            return ("proved", term, engine, depth, rechecked, _packed_texts(certificates), run_, by_construction)
        case Violated(trace, engine, reason):
            return ("violated", pack_trace(trace), engine, reason)
        case Unknown(reason, depth, escape):
            return ("unknown", reason, depth, pack_trace(escape))
        case Vacuous(reason, trace):
            return ("vacuous", reason, pack_trace(trace))
        case _:
            assert_never(verdict)


def unpack(packed: Packed, system: TransitionSystem, observed: TransitionSystem, again: Again | None = None) -> Verdict:
    """Rebuild the verdict: traces are runs of `system`, invariants read the variables of `observed`.

    again  makes the runs of several verdicts, each step only once
    """
    match packed:
        case ("proved", term, engine, depth, rechecked, certificates, witness, by_construction):
            invariant = None if term is None else unpack_term(term, observed)
            run_ = unpack_trace(witness, system, again)
            texts = _unpacked_texts(certificates)
            return Proved(invariant, engine, depth, rechecked, texts, run_, by_construction)
        case ("violated", trace, engine, reason):
            return Violated(unpack_trace(trace, system, again), engine, reason)
        case ("unknown", reason, depth, escape):
            return Unknown(reason, depth, _unpack_escape(escape, system))
        case ("vacuous", reason, trace):
            return Vacuous(reason, unpack_trace(trace, system, again))
        case _:
            raise AssertionError(packed)


def steps_of(packed: Packed) -> int:
    """Return the number of steps of a packed verdict's run; 0 without a run."""
    return max((len(part.stream) for part in packed if isinstance(part, PackedTrace)), default=0)


def pack_base(known: Base) -> Packed:
    """Return a proved base as plain data: facts by key, the rest unchanged."""
    always, facts = tuple(known.always), tuple(known.facts)
    return (
        always,
        facts,
        dict(known.refuted),
        dict(known.certificates),
        known.seconds,
        tuple(known.kept),
        tuple(known.in_range),
    )


def unpack_base(packed: Packed, terms: Mapping[Fact, Bool]) -> Base:
    """Rebuild the base from the terms of its facts."""
    always, facts, certificates = packed[0], packed[1], packed[3]
    refuted: Mapping[Fact, Failure] = packed[2]
    always_, facts_, kept = ({key: terms[key] for key in keys} for keys in (always, facts, packed[5]))
    return Base(always_, facts_, refuted, certificates, packed[4], kept, packed[6])
