"""The claim of each result in a report, and the check that the certificates establish exactly this claim.

The checker computes everything again from the declaration: the rows that must exclude each other, the terms that interval
arithmetic leaves open, the possible values of absent inputs, the admissible inputs. It computes the runs again, too.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

from safeloc.checker.answer import NO_PROOF, OPEN, WRONG, Answer, Check, Row, proven
from safeloc.checker.dag import INT, Dag, Rewriting
from safeloc.checker.instance import covered
from safeloc.checker.rules import Speaker, Terms, Theory
from safeloc.checker.run_checks import Occurrences
from safeloc.errors import InputError, StreamError
from safeloc.language.composition import Composition
from safeloc.language.expr import TRUE, Bool, Expr, Num, NumVar, Optional, Var, as_num, before_step, between, ite
from safeloc.language.machine import Machine, Transition
from safeloc.language.nodes import INT64_MAX, INT64_MIN, FloorDiv
from safeloc.language.ranges import beyond_int64
from safeloc.language.read_twice import other_value, read_alike, reads_while_absent
from safeloc.language.spec import Goal, Property, observe, reachable
from safeloc.language.system import Part, TransitionSystem, environment, in_range
from safeloc.language.terms import Substitution, in_order, variables
from safeloc.target import Target


class Goals:
    """Goals by machine ("" for the whole system) and name: those of properties, those of the machine's own properties for
    inherited ones, and goals about a single step on the way to an obligation."""

    def __init__(self, target: Target) -> None:
        self._system = target.system
        self._known: dict[tuple[str, str], list[Goal]] = {}
        self._steps: dict[tuple[str, str], list[Goal]] = {}
        for prop in target.properties:
            self._known.setdefault(("", prop.name), []).append(observe(target.system, prop))
            if prop.kept_by is not None:
                part, original = _keeper(target.system, prop), prop.kept_by[1]
                self._known.setdefault((part.name, original.name), []).append(observe(part.alone, original))

    def __call__(self, part: str, name: str) -> Sequence[Goal]:
        """Return all goals with this name; none if there is no such property or goal."""
        return [*self._known.get((part, name), ()), *self.of_a_step(part, name)]

    def of_a_step(self, part: str, name: str) -> Sequence[Goal]:
        """Return those of these goals that are about a single step, on the way to an obligation."""
        if (part, name) not in self._steps:
            try:
                term = self._asked(part, name)
            except IndexError:  # there are fewer rows, or terms
                term = None
            self._steps[part, name] = [] if term is None else [self._never(part, name, term)]
        return self._steps[part, name]

    def _asked(self, part: str, name: str) -> Bool | None:
        """Return the event that must not happen in a step: two rows enabled together, or a term beyond 64 bits."""
        if rows := re.fullmatch(r"overlap of rows (\d+) and (\d+)", name):
            machine = self._alone(part).machines[0]
            one, other = (machine.transitions[int(row) - 1] for row in rows.groups())
            return _enabled(machine, one) & _enabled(machine, other)
        if wide := re.fullmatch(r"overflow( of ghosts)? (\d+)", name):
            terms = beyond_int64(_hidden(self._system) if wide[1] else _computed(self._system))
            return ~between(INT64_MIN, terms[int(wide[2]) - 1], INT64_MAX)
        return None

    def _never(self, part: str, name: str, term: Bool) -> Goal:
        system = self._alone(part)
        twins: dict[Var, Expr] = {var: before_step(var) for var in system.state}
        asked = reachable(name, Substitution(twins).bool(term), unconditional="ghosts" not in name)
        return observe(system, asked)

    def _alone(self, part: str) -> TransitionSystem:
        return next((one.alone for one in self._system.parts if one.name == part), self._system)


def _keeper(system: TransitionSystem, prop: Property) -> Part:
    assert prop.kept_by is not None
    return next(part for part in system.parts if part.alone.machines[0] is prop.kept_by[0])


@dataclass(frozen=True, eq=False)
class Claims:
    """The claims about one target.

    theory   the conclusions of all its certificates
    runs     the evidence from its runs
    claimed  ids of all results of the target: a part with a result of its own is checked there
    """

    target: Target
    goals: Goals
    theory: Theory
    runs: Occurrences
    claimed: frozenset[str]

    def answer(self, row: Row) -> Answer:
        """Check a result; return the answer, with the reason if it is not confirmed."""
        claimed = ("proved",) if row["kind"] in ("lemma", "obligation") else ("proved", "violated")
        if row["verdict"] not in claimed or row["kind"] in ("test", "replay"):
            return NO_PROOF, f"{row['kind']}, {row['verdict']}: no proof is claimed"
        name = str(row["id"]).removeprefix(f"{self.target.name}/{row['kind']}/")
        checks = self._checks[row["kind"]].get(name, [])
        if row["kind"] == "obligation" and not checks:
            checks = list(self._settled_by_itself(name))
        if len(checks) != 1:
            return OPEN, f"there are {len(checks)} items of this name in the declaration that the checker knows"
        try:
            return checks[0](row)
        except (InputError, StreamError) as error:
            return WRONG, str(error)

    @cached_property
    def _checks(self) -> dict[str, dict[str, list[Check]]]:
        """The check of each result, by kind and name; two checks if two results have the same name."""
        found: dict[str, dict[str, list[Check]]] = {"property": {}, "lemma": {}, "obligation": {}}
        kinds = (self._properties(), self._lemmas(), self._obligations())
        for by_name, pairs in zip(found.values(), kinds, strict=True):
            for name, check in pairs:
                by_name.setdefault(name, []).append(check)
        return found

    # -------------------------------------------------------------- properties and lemmas

    def _properties(self) -> Iterator[tuple[str, Check]]:
        for prop in self.target.properties:
            yield prop.name, lambda row, prop=prop: self._property(row, prop)  # type: ignore[misc]

    def _property(self, row: Row, prop: Property) -> Answer:
        [goal] = self.goals("", prop.name)
        if (prop.kind == "reachable") == (row["verdict"] == "proved"):
            return self.runs.happens(row, goal)
        if row["verdict"] == "violated":
            return NO_PROOF, "a violation without a run"
        if prop.kept_by is None or self._proved(row, goal):
            lasts = prop.further_assumption is TRUE or self._goes_on(
                self.theory.together, goal.plain, lawful=not prop.unconditional
            )
            return proven(self._proved(row, goal) and lasts)
        return self._inherited(row, prop, goal)

    def _proved(self, row: Row, goal: Goal) -> bool:
        """Return whether files named by the result establish the goal for every run."""
        return goal in self.theory.proved and self.theory.proved[goal] <= {*row["certificates"]}

    def _inherited(self, row: Row, prop: Property, goal: Goal) -> Answer:
        part, system = _keeper(self.target.system, prop), self.target.system
        assert prop.kept_by is not None
        machine, original = prop.kept_by
        again = Composition(system, {machine: part.into}, {}).inherited(machine, original)
        if self._nodes(goal) != self._nodes(observe(system, replace(again, name=prop.name))):
            return WRONG, "it is not the machine's own property in the terms of the composition"
        free = original.unconditional and part.alone.ghosts.isdisjoint(variables([original.term]))
        if part.name not in self.theory.in_range or not (free or part.name in self.theory.contracts):
            return (
                WRONG,
                f"it is not shown that the inputs of {part.name} are in range and its assumption is discharged",
            )
        alone = next(one for one in self.goals(part.name, original.name) if one.prop is original)
        at_first = self.theory.at_first.get(goal)
        if alone.observers and not goal.observers and not (at_first and at_first <= {*row["certificates"]}):
            return WRONG, "it is not shown for the first state"
        speaker = self.theory.parts[part.name][1]
        lasts = original.further_assumption is TRUE or self._goes_on(
            speaker, alone.plain, lawful=not original.unconditional
        )
        return proven(self._proved(row, alone) and lasts)

    def _nodes(self, goal: Goal) -> list[object]:
        terms = [goal.good, goal.helper, goal.system.init, goal.system.assume, *goal.system.next.values()]
        return [*map(self.theory.write, terms), goal.prop.unconditional, goal.prop.kind]

    def _lemmas(self) -> Iterator[tuple[str, Check]]:
        for name, term in self.target.system.lemmas.items():
            yield name, lambda row, term=term: self._lemma(row, term)  # type: ignore[misc]
        for part in self.theory.parts:
            yield f"contract of {part} holds", lambda _, part=part: proven(part in self.theory.contracts)  # type: ignore[misc]

    def _lemma(self, row: Row, term: Bool) -> Answer:
        free = "for all inputs in range" in row["method"]
        return proven(self.theory.write.conjuncts([term]) <= self.theory.together.known(lawful=not free))

    # -------------------------------------------------------------- obligations

    def _obligations(self) -> Iterator[tuple[str, Check]]:
        system = self.target.system
        board, hidden = _computed(system), _hidden(system)
        divisors = [node.divisor for node in in_order([*board, *hidden]) if isinstance(node, FloorDiv)]
        yield "ranges", self._ranges
        yield "division", lambda _: proven(all(divisor > 0 for divisor in divisors))
        yield "overflow", lambda _: self._fits("overflow", board, lawful=False)
        yield "overflow of ghosts", lambda _: self._fits("overflow of ghosts", hidden, lawful=True)
        yield "overflow of first values", lambda _: proven(self._within("", [system.init]) <= self.theory.first_values)
        yield "absence", lambda _: proven(all(map(self._unread, [*self.theory.parts, ""])))
        yield "absence in claims", lambda _: proven(all(map(self._independent, self.target.properties)))
        yield "assumption", self.runs.kept_for_a_while
        yield "assumption lasts", self._lasts
        yield "dead ends", lambda _: proven(self._goes_on(self.theory.together, system, lawful=True))
        for var in system.state:
            yield f"range of {var.name}", lambda _, var=var: proven(self._in_range(var))  # type: ignore[misc]
        for machine in system.machines:
            yield f"overlap {machine.name}", lambda _, machine=machine: self._apart(machine)  # type: ignore[misc]
        yield from self.runs.checks()

    def _settled_by_itself(self, name: str) -> Iterator[Check]:
        """Yield the checks of goals about a step that were proved separately, since one query for all did not decide them."""
        asked = [("", name)]
        for machine in self.target.machines:
            if name.startswith(f"overlap {machine.name}: "):
                part = machine.name if self.theory.parts else ""
                asked.append((part, f"overlap of {name.removeprefix(f'overlap {machine.name}: ')}"))
        for goal in (goal for part, each in asked for goal in self.goals.of_a_step(part, each)):
            yield lambda row, goal=goal: proven(self._proved(row, goal))  # type: ignore[misc]

    def _in_range(self, var: Var) -> bool:
        """Return whether the range of a variable is proved: of on-board state for all inputs, of ghosts under the assumption."""
        known = self.theory.together.known(lawful=var in self.target.system.ghosts)
        return self.theory.write.conjuncts([in_range([var])]) <= known

    def _ranges(self, row: Row) -> Answer:
        counts = re.match(r"(\d+) of (\d+) ", row["statement"])
        numeric = [var for var in self.target.system.state if isinstance(var, NumVar)]
        known = sum(map(self._in_range, numeric))
        return proven(counts is not None and int(counts[1]) <= known and int(counts[2]) == len(numeric))

    def _has_its_own(self, obligation: str) -> bool:
        return f"{self.target.name}/obligation/{obligation}" in self.claimed

    def _within(self, name: str, terms: Sequence[Expr]) -> Terms:
        wide = enumerate(beyond_int64(terms), 1)
        left = [term for number, term in wide if not (name and self._has_its_own(f"{name} {number}"))]
        return self.theory.write.conjuncts(between(INT64_MIN, term, INT64_MAX) for term in left)

    def _fits(self, name: str, terms: Sequence[Expr], *, lawful: bool) -> Answer:
        """Check that terms fit 64 bits: the declared ranges are proved, and certificates prove what they leave open."""
        read = [var for var in self.target.system.state if lawful or var not in self.target.system.ghosts]
        if not all(map(self._in_range, read)):
            return WRONG, "it rests on ranges that are not proved"
        return proven(self._within(name, terms) <= self.theory.together.step(lawful=lawful))

    def _apart(self, machine: Machine) -> Answer:
        speaker = self.theory.speaker(machine.name if self.theory.parts else "")
        assert speaker is not None
        pairs = [
            ~(_enabled(machine, one) & _enabled(machine, other))
            for (row, one), (number, other) in combinations(enumerate(machine.transitions, 1), 2)
            if one.rank == other.rank and {*one.sources} & {*other.sources}
            if not self._has_its_own(f"overlap {machine.name}: rows {row} and {number}")
        ]
        return proven(self.theory.write.conjuncts(pairs) <= speaker.step(lawful=False))

    def _unread(self, part: str) -> bool:
        """Return whether no term of machine and world (for a composition: no wire) depends on the value of an absent
        optional input."""
        speaker = self.theory.speaker(part)
        assert speaker is not None
        system, composed = speaker.system, not part and self.theory.parts
        terms = list(_through_wires(system)) if composed else [*_on_board(system), *_in_the_world(system)]
        return all(self._unread_in(part, option, terms) for option in system.optionals)

    def _unread_in(self, part: str, option: Optional, terms: Sequence[Expr]) -> bool:
        write, dag = self.theory.write, self.theory.dag
        value, shown = write(option.value), self._shown_absent(part, option, lawful=False)
        absent = Rewriting(dag, {write(option.present): dag.truth[False]})
        other = Rewriting(dag, {value: write.named(option.value, f"{option.value.name} (other)")})
        return all(
            value not in dag.variables(write(term))
            or value not in dag.variables(absent(write(term)))
            or _alike(dag, write(term), other(write(term))) in shown
            for term in terms
        )

    def _shown_absent(self, part: str, option: Optional, *, lawful: bool) -> Terms:
        """Return the terms over a step that are established while the input is absent."""
        return self.theory.absent[part, option.value.name, lawful]

    def _independent(self, prop: Property) -> bool:
        """Return whether the property is the same whatever number is stored for an absent input; an inherited one on its machine."""
        part, prop = ("", prop) if prop.kept_by is None else (_keeper(self.target.system, prop).name, prop.kept_by[1])
        speaker = self.theory.speaker(part)
        assert speaker is not None
        return all(self._independent_of(part, speaker.system, prop, option) for option in speaker.system.optionals)

    def _independent_of(self, part: str, system: TransitionSystem, prop: Property, option: Optional) -> bool:
        if not reads_while_absent(prop, option):
            return True
        shown = self._shown_absent(part, option, lawful=False)
        if not prop.unconditional:
            shown |= self._shown_absent(part, option, lawful=True)
        return self.theory.write.conjuncts([read_alike(system, prop, option, other_value(option))]) <= shown

    def _lasts(self, row: Row) -> Answer:
        """Check that the assumption can be satisfied for ever: by the facts about every state, or by a run that returns to a
        state."""
        shown = self._goes_on(self.theory.together, self.target.system, lawful=True)
        return proven(True) if shown else self.runs.comes_round(row)

    def _goes_on(self, speaker: Speaker, system: TransitionSystem, *, lawful: bool) -> bool:
        """Return whether every reachable state has a next step that satisfies the assumption."""
        write, known = self.theory.write, speaker.known(lawful=lawful)
        asked = write.conjuncts([environment(system)])
        return covered(self.theory.dag, asked, map(write, system.inputs), known, self.theory.witnesses)


def _computed(system: TransitionSystem) -> list[Expr]:
    return [*_on_board(system), *system.outputs.values()]


def _hidden(system: TransitionSystem) -> list[Expr]:
    """Return the terms that only simulation and proofs compute: moves of ghosts, and the assumption."""
    return [*(system.next[var] for var in system.state if var in system.ghosts), system.assume]


def _on_board(system: TransitionSystem) -> list[Expr]:
    return [*(term for var, term in system.next.items() if var not in system.ghosts), *system.fired.values()]


def _in_the_world(system: TransitionSystem) -> Iterator[Expr]:
    """Yield the clauses of the worlds, and the moves of ghosts."""
    yield from (term for machine in system.machines for term in machine.world.terms.values())
    yield from (term for var, term in system.next.items() if var in system.ghosts)


def _through_wires(system: TransitionSystem) -> Iterator[Expr]:
    """Yield the term of each wire; a wire to an optional input counts while that input is present."""
    for part in system.parts:
        present: dict[Var, Bool] = {option.value: part.into.bool(option.present) for option in part.alone.optionals}
        for var in part.alone.inputs:
            wire = part.into(var)
            if not isinstance(wire, Var):
                yield _while(present[var], wire) if var in present else wire


def _alike(dag: Dag, one: int, other: int) -> int:
    """Return the node for the equality of two terms."""
    if dag.sort(one) == INT:
        return dag.make("=", [one, other])
    neither = [dag.make("not", [one]), dag.make("not", [other])]
    return dag.make("or", [dag.make("and", [one, other]), dag.make("and", neither)])


def _while(present: Bool, term: Expr) -> Expr:
    """Return the term while the input is present, else 0 or false."""
    if isinstance(term, Num):
        return ite(present, term, as_num(0, term.unit))
    assert isinstance(term, Bool)
    return present & term


def _enabled(machine: Machine, transition: Transition) -> Bool:
    return machine.mode.one_of(*transition.sources) & transition.when
