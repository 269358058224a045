"""Mutants of the wires of a composition: crossed, cut, constant, late by a cycle, or reading the truth; and wrong terms and outputs on them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from safeloc.assurance.mutation.delay import neutral
from safeloc.assurance.mutation.glue import Wire, glue_edits
from safeloc.assurance.mutation.members import Composed
from safeloc.assurance.mutation.mutants import LONGEST, Mutant, numbered
from safeloc.assurance.mutation.places import Places
from safeloc.language.expr import TRUE, BoolVar, Expr, Lit, Num, NumVar, Optional, Var, ite
from safeloc.language.machine import Machine
from safeloc.language.render import infix
from safeloc.language.system import canonical

_CROSSED = "another wire of the same unit"
_CUT = "wire cut"
_CONSTANT = "wire constant"
_LATE = "wire late by a cycle"
_TRUTH = "wire reads the truth"
_Wires = Mapping[Var, Expr]
_Inputs = tuple[Var, ...]


@dataclass(frozen=True, eq=False)
class WireEdit:
    """A wrong wire: its mutant, and all wires of the composition with the change.

    late        the wired inputs that get the values of the step before
    to_a_ghost  the wire leads to a ghost: machine and outputs stay the same, and the truth is wrong
    """

    mutant: Mutant
    wires: _Wires
    late: _Inputs = ()
    to_a_ghost: bool = False


def wire_edits(composed: Composed, places: Places) -> list[WireEdit]:
    """Return all wrong wires, machine by machine, then the wrong terms on them. On wires to ghosts no term is changed."""
    wires = composed.plan.wires
    made = [edit for machine in composed.plan.machines for edit in _of_machine(composed, machine)]
    wired = [
        Wire(machine, var, wires[var]) for machine in composed.plan.machines for var in _inputs(machine) if var in wires
    ]
    made += [WireEdit(mutant, changed) for mutant, changed in glue_edits(composed, places, wired)]
    named = numbered(edit.mutant for edit in made)
    return [replace(edit, mutant=mutant) for mutant, edit in zip(named, made, strict=True)]


def _of_machine(composed: Composed, machine: Machine) -> Iterator[WireEdit]:
    own = _Wrong(composed, machine)
    for inputs in (_inputs(machine), list(machine.world.choices)):
        yield from own.crossed([var for var in inputs if var in composed.plan.wires])
    yield from own.cut()
    yield from own.constant()
    yield from own.late()
    yield from own.reading_the_truth()


def _inputs(machine: Machine) -> list[Var]:
    return [
        part for one in machine.inputs for part in ((one.value, one.present) if isinstance(one, Optional) else (one,))
    ]


@dataclass(frozen=True, eq=False)
class _Wrong:
    """Makes the wires of one machine wrong."""

    composed: Composed
    machine: Machine

    def crossed(self, wired: list[Var]) -> Iterator[WireEdit]:
        """Yield each wired input with the wire of the next one of its unit and range."""
        wires = self.composed.plan.wires
        for var, other in _next_of_unit(wired).items():
            if wires[var] is not wires[other]:
                yield self._edit(_CROSSED, f"{var.name} gets the value of {other.name}", var, {var: wires[other]})

    def cut(self) -> Iterator[WireEdit]:
        """Yield each cut: an optional input is absent, any other one always has a neutral value; so has the truth."""
        for one in (*self._wired(), *self._wired_ghosts()):
            changed = {var: neutral(var) for var in one}
            yield self._edit(_CUT, f"the wire to {one[-1].name} is cut", one[-1], changed)

    def constant(self) -> Iterator[WireEdit]:
        """Yield each wire with the other end of its range: a set flag, the greatest number; of an optional input, while it is there."""
        for one in self._wired():
            var, other = one[0], _other_end(one[0])
            if len(one) == 2:
                assert isinstance(other, Lit)
                assert isinstance(var, NumVar)
                there = self.composed.plan.wires[one[1]]
                assert not isinstance(there, Num)
                other = ite(there, other, Lit(canonical(var), var.unit))
            if infix(other, LONGEST) != infix(self.composed.plan.wires[var], LONGEST):
                yield self._edit(
                    _CONSTANT, f"{var.name} is always {infix(_other_end(var), LONGEST)}", var, {var: other}
                )

    def late(self) -> Iterator[WireEdit]:
        """Yield each wire late by a cycle; an optional input with its flag of presence."""
        for one in self._wired():
            words = f"{one[0].name} has the value of the cycle before"
            yield self._edit(_LATE, words, one[0], {}, late=one)

    def reading_the_truth(self) -> Iterator[WireEdit]:
        """Yield each wire to an on-board input with the first ghost of the same unit that an earlier machine has."""
        earlier = self.composed.plan.machines[: list(self.composed.plan.machines).index(self.machine)]
        for one in self._wired():
            ghosts = (ghost for machine in earlier for ghost in machine.world.variables if _fits(ghost, one[0]))
            ghost = next(ghosts, None)
            if ghost is not None:
                yield self._edit(_TRUTH, f"{one[0].name} gets the ghost {ghost.name}", one[0], {one[0]: ghost})

    def _wired(self) -> Iterator[_Inputs]:
        """Yield each wired on-board input; an optional one with its flag, if both are wired."""
        wires = self.composed.plan.wires
        for one in self.machine.inputs:
            parts = (one.value, one.present) if isinstance(one, Optional) else (one,)
            if all(part in wires for part in parts):
                yield parts

    def _wired_ghosts(self) -> Iterator[_Inputs]:
        yield from ((var,) for var in self.machine.world.choices if var in self.composed.plan.wires)

    def _edit(self, kind: str, words: str, var: Var, changed: _Wires, late: _Inputs = ()) -> WireEdit:
        right = self.composed.plan.wires
        becomes = f"{infix(right[var], LONGEST)}, a cycle ago" if late else infix(changed[var], LONGEST)
        mutant = Mutant(
            machine=self.composed.target.name,
            kind=kind,
            words=words,
            term=infix(right[var], LONGEST),
            becomes=becomes,
            where=(f"wire to {var.name} of {self.machine.name}",),
            alone=lambda of: of,
        )
        return WireEdit(mutant, {**right, **changed}, late, var in set(self.machine.world.choices))


def _next_of_unit(wired: list[Var]) -> dict[Var, Var]:
    """Return for each wired input the next one of the same unit and range; a value of another range could be inadmissible."""
    alike: dict[object, list[Var]] = defaultdict(list)
    for var in wired:
        alike[(var.unit, var.low, var.high) if isinstance(var, NumVar) else bool].append(var)
    found: dict[Var, Var] = {}
    for group in alike.values():
        if len(group) > 1:
            found |= dict(zip(group, [*group[1:], group[0]], strict=True))
    return found


def _other_end(var: Var) -> Expr:
    """Return the constant that is farthest from the neutral one, or the greatest number."""
    if not isinstance(var, NumVar):
        return TRUE
    return Lit(var.high, var.unit)


def _fits(ghost: Var, var: Var) -> bool:
    if isinstance(var, BoolVar) or isinstance(ghost, BoolVar):
        return isinstance(ghost, BoolVar) and isinstance(var, BoolVar)
    return ghost.unit.same(var.unit)
