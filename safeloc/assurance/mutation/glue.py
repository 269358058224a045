"""Mutants of what stands on the wires of a composition: a term between two machines, such as a gate or an offset, and a wrong output.

A term counts as one if one expression wrote it, as in a machine: a gate on three wires is made wrong on all of them. Terms of the
machines themselves are not changed here.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from safeloc.assurance.mutation.kinds import changes
from safeloc.assurance.mutation.members import Composed
from safeloc.assurance.mutation.mutants import LONGEST, Mutant, place_text, written_at
from safeloc.assurance.mutation.places import Places
from safeloc.assurance.mutation.same import Forms
from safeloc.assurance.source_places import Place
from safeloc.language.absence import stand_in_of
from safeloc.language.expr import Expr, Lit, Num, Var
from safeloc.language.machine import Machine
from safeloc.language.nodes import Choose
from safeloc.language.render import infix
from safeloc.language.terms import Substitution, children, in_order

_OUTPUT = "another output of the machine"
Wires = Mapping[Var, Expr]
_Key = tuple[Place | None, int]
"""Place and form of a term."""


@dataclass(frozen=True, eq=False)
class Wire:
    """A wired input of a machine, and the term on its wire."""

    machine: Machine
    to: Var
    term: Expr

    def __str__(self) -> str:
        return f"wire to {self.to.name} of {self.machine.name}"


def glue_edits(composed: Composed, places: Places, wired: list[Wire]) -> Iterator[tuple[Mutant, Wires]]:
    """Yield each wrong term between machines, then each wrong output, with all wires of the composition."""
    yield from _wrong_terms(composed, places, wired)
    yield from _wrong_outputs(composed, wired)


# ------------------------------------------------------------------ terms between machines


def _wrong_terms(composed: Composed, places: Places, wired: list[Wire]) -> Iterator[tuple[Mutant, Wires]]:
    forms, right = Forms(places), composed.plan.wires
    for place, nodes, at in _terms(composed, places, forms, wired):
        seen = {forms.of(nodes[0])}
        for change in changes(nodes[0], lambda _: None):
            wrong = change.make(children(nodes[0]))
            if forms.of(wrong) in seen:
                continue
            seen.add(forms.of(wrong))
            exchanged = Substitution({}, [(node, change.make(children(node))) for node in nodes])
            made = Mutant(
                machine=composed.target.name,
                kind=change.kind,
                words=change.words,
                place=place_text(place),
                source=written_at(place),
                term=infix(nodes[0], LONGEST),
                becomes=infix(wrong, LONGEST),
                where=tuple(map(str, at)),
                alone=lambda of: of,
            )
            yield made, {**right, **{wire.to: exchanged(wire.term) for wire in at}}


def _terms(
    composed: Composed, places: Places, forms: Forms, wired: list[Wire]
) -> Iterator[tuple[Place | None, list[Expr], list[Wire]]]:
    """Yield each term between machines: its place, its nodes, and the wires on which it stands."""
    own, shown = frozenset(in_order(_outputs(composed))), _shown(composed)
    nodes: dict[_Key, dict[Expr, None]] = defaultdict(dict)
    at: dict[_Key, dict[Wire, None]] = defaultdict(dict)
    for wire in wired:
        for node in in_order([wire.term], own):
            if children(node) and _value(node) not in shown:
                key = (places.of(node), forms.of(node))
                nodes[key][node], at[key][wire] = None, None
    for key, found in nodes.items():
        yield key[0], [*found], [*at[key]]


def _shown(composed: Composed) -> frozenset[tuple[Expr, Expr]]:
    """Return condition and value of each output that may be absent: a wire carries 0 for it while it is, which nobody wrote."""
    absent = [one for one in _outputs(composed) if isinstance(one, Choose) and stand_in_of(one) is not None]
    return frozenset((one.condition, one.then) for one in absent)


def _outputs(composed: Composed) -> list[Expr]:
    return [term for machine in composed.plan.machines for term in machine.outputs.values()]


def _value(node: Expr) -> tuple[Expr, Expr] | None:
    """Return condition and value of a term that is 0 otherwise."""
    if isinstance(node, Choose) and isinstance(node.other, Lit) and node.other.value == 0:
        return node.condition, node.then
    return None


# ------------------------------------------------------------------ outputs


def _wrong_outputs(composed: Composed, wired: list[Wire]) -> Iterator[tuple[Mutant, Wires]]:
    right, shown = composed.plan.wires, _shown(composed)
    every = _outputs(composed)
    kept = [(term, term) for term in every]
    for wire in wired:
        read = _read(wire.term, frozenset(every), shown)
        for machine in composed.plan.machines:
            for name, other in _next_alike(machine).items():
                term, meant = machine.outputs[name], machine.outputs[other]
                if term not in read or not children(term):
                    continue
                made = Mutant(
                    machine=composed.target.name,
                    kind=_OUTPUT,
                    words=f"{machine.name}.{name} becomes {machine.name}.{other}",
                    term=infix(term, LONGEST),
                    becomes=infix(meant, LONGEST),
                    where=(str(wire),),
                    alone=lambda of: of,
                )
                yield made, {**right, wire.to: Substitution({}, [*kept, (term, meant)])(wire.term)}


def _read(term: Expr, outputs: frozenset[Expr], shown: frozenset[tuple[Expr, Expr]]) -> set[Expr]:
    """Return the outputs that the term reads as a whole, not as a part of another one."""
    if term in outputs:
        return {term}
    found = set[Expr]()
    for node in in_order([term], outputs):
        if _value(node) not in shown:
            found |= {part for part in children(node) if part in outputs}
    return found


def _next_alike(machine: Machine) -> dict[str, str]:
    """Return for each output the next one of the same unit; outputs that may be absent stand on no wire as they are."""
    alike: dict[object, list[str]] = defaultdict(list)
    for name, term in machine.outputs.items():
        if stand_in_of(term) is None:
            alike[term.unit if isinstance(term, Num) else bool].append(name)
    found: dict[str, str] = {}
    for group in alike.values():
        if len(group) > 1:
            found |= dict(zip(group, [*group[1:], group[0]], strict=True))
    return found
