"""What a JavaScript machine needs to explain a step: the parts of its guards, its named terms and its laws, with their values.

Guards are the machine's own, over its own variables. In a composition each part is therefore evaluated as it reads in a step of the
whole: a wired input is a term over earlier machines, mostly the value of one of their variables after the step, which `o` has.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from safeloc.codegen.javascript_code import input_names, state_names, values_of
from safeloc.codegen.stages import is_cut
from safeloc.language.machine import Machine
from safeloc.language.nodes import And, Bool, ChooseBool, Compare, Expr, Lit, Not, Num, Or, Var
from safeloc.language.render import infix
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Sharing, Substitution, variables
from safeloc.language.units import Enumeration

LONGEST = 200
"""Most characters of a part."""
MOST_VALUES = 12
"""Most variables of a comparison whose values are shown."""

_LEAF, _NOT, _AND, _OR, _CHOICE = range(5)


@dataclass(frozen=True, eq=False)
class Member:
    """One machine of the system, and how its terms read in a step of the whole. `prefix` begins its names in the whole."""

    machine: Machine
    prefix: str
    in_a_step: Callable[[Expr], Expr]
    wired: tuple[Var, ...] = ()


def members(system: TransitionSystem) -> list[Member]:
    """Return the machines of the system in the order of the step."""
    if not system.parts:
        return [Member(machine, "", lambda term: term) for machine in system.machines]
    own = {*system.state, *system.inputs}
    return [
        Member(
            part.machine,
            f"{part.name}.",
            part.in_a_step,
            tuple(var for var in part.alone.inputs if part.in_a_step(var) not in own),
        )
        for part in system.parts
    ]


def laws(system: TransitionSystem) -> dict[str, Bool]:
    """Return the laws of the world that a step has to keep, each with its machine; none where the system has no ghosts."""
    if not system.ghosts:
        return {}
    if not system.parts:
        [machine] = system.machines
        return {f"{machine.name}: {name}": term for name, term in machine.world.terms.items()}
    return {f"{part.name}: {name}": term for part in system.parts for name, term in part.assumed.items()}


class Parts:
    """Parts of terms, collected with places in one list of values, which one function of the text computes.

    texts   every text once; nodes refer to it by its place
    labels  the members of every enumeration once
    nodes   parts as [kind, text, place of the value, ...]: of a leaf the values that it reads as [text, place, labels], and
            how many more; of others the parts in it, and 1 if it is shown by a name
    """

    def __init__(self, system: TransitionSystem) -> None:
        self.texts: dict[str, int] = {}
        self.labels: dict[tuple[str, ...], int] = {}
        self.nodes: list[list[Any]] = []
        self._values: dict[Expr, int] = {}
        self._share = Sharing()
        self._twins = {var: replace(var, name=f"{var.name} after") for var in system.state}
        moved = reversed(list(system.next.items()))
        self._cut = Substitution({}, [(term, self._twins[var]) for var, term in moved if is_cut(var, term)])
        self._names = {**state_names(system), **input_names(system)}
        self._names |= {self._twins[var]: place for var, place in state_names(system, "o").items()}

    def place(self, term: Expr) -> int:
        """Return the place of the value of a term over the state before the step and the inputs."""
        return self._values.setdefault(self._share(self._cut(term)), len(self._values))

    def knows(self, term: Expr) -> bool:
        """Return whether the term has a value in this system: on board no term over ghosts has."""
        return all(var in self._names for var in variables([self._cut(term)]))

    def function(self) -> str:
        """Return the text of the function (s, i, o) that computes all values."""
        return f"(s,i,o)=>{values_of(list(self._values), self._names)}"

    def text(self, text: str) -> int:
        """Return the place of a text."""
        return self.texts.setdefault(text, len(self.texts))

    def kind(self, term: Expr) -> int:
        """Return the place of the labels of an enumeration; -1 for any other term."""
        if isinstance(term, Num) and isinstance(term.unit, Enumeration):
            return self.labels.setdefault(term.unit.members, len(self.labels))
        return -1


class Guards:
    """The parts of one machine's guards."""

    def __init__(self, parts: Parts, member: Member) -> None:
        self._parts, self._member = parts, member
        self._names = {term: name for name, term in member.machine.definitions.items()}
        self._made: dict[Expr, int] = {}

    def part(self, term: Expr, *, is_whole: bool = False) -> int:
        """Return the place of the term among the nodes, with the parts in it before it.

        is_whole  it is a whole guard, which is shown even if it is a negation
        """
        if term not in self._made:
            node = self._node(term, is_whole=is_whole)
            self._made[term] = len(self._parts.nodes)
            self._parts.nodes.append(node)
        node = self._parts.nodes[self._made[term]]
        if is_whole and node[1] < 0:
            node[1] = self._text(term)
        return self._made[term]

    def _node(self, term: Expr, *, is_whole: bool) -> list[Any]:
        named = [1] if term in self._names else []
        match term:
            case Not(inner):
                return [_NOT, self._text(term) if is_whole else -1, self._place(term), [self.part(inner)]]
            case And(parts) | Or(parts):
                kind = _AND if isinstance(term, And) else _OR
                return [kind, self._text(term), self._place(term), [self.part(part) for part in parts], *named]
            case ChooseBool(condition, then, other):
                inside = [self.part(part) for part in (condition, then, other)]
                return [_CHOICE, self._text(term), self._place(term), inside, *named]
            case Compare():
                read, left_out = self._reads(term)
                return [_LEAF, self._text(term), self._place(term), read, *([left_out] if left_out else [])]
            case _:
                return [_LEAF, self._text(term), self._place(term), []]

    def _reads(self, term: Compare) -> tuple[list[list[int]], int]:
        """Return the values of the two sides, and of the variables in them, and how many more there are."""
        sides = [side for side in (term.left, term.right) if not isinstance(side, Lit)]
        plain = [side for side in sides if side not in self._names]
        read: dict[int, Expr] = {self._text(one): one for one in dict.fromkeys([*sides, *variables(plain)])}
        few = list(read.items())[:MOST_VALUES]
        return [[text, self._place(one), self._parts.kind(one)] for text, one in few], len(read) - len(few)

    def _text(self, term: Expr) -> int:
        return self._parts.text(infix(term, LONGEST, self._names))

    def _place(self, term: Expr) -> int:
        return self._parts.place(self._member.in_a_step(term))
