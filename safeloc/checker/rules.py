"""Rules for certificates: facts are collected one by one, each only from facts established before it.

A certificate establishes the conclusion of its rule, if the rule allows all its hypotheses. So no circular proof is
possible, whatever basis the certificates name. A certificate may omit allowed hypotheses.

    layer, induction, invariant         terms over state that hold in the first state and after every step: facts, properties
    wires, contract, overlap, overflow  terms over a step, from facts about the states before and after it
    implied, first state                properties that follow from facts; properties in the first state
    absence, absence under the assumption, lasts, overflow of first values    obligations with hypotheses of their own
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from safeloc.checker.dag import Dag, Rewriting
from safeloc.checker.former import without_rule
from safeloc.checker.terms import Translation
from safeloc.checker.text import Certificate
from safeloc.language.nodes import Var
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem, environment, in_range

Terms = frozenset[int]
Files = frozenset[str]
_LAWFUL = ("facts", "contract", "overflow of ghosts")  # layers and rules that rest on the assumption
_STEPS = ("wires", "contract", "overlap", "overflow", "overflow of ghosts")
_ROLES = {"layer": ("start", "step"), "induction": ("start", "step"), "invariant": ("start", "step", "implies")}
_FACTS_FIRST = ("layer", *_STEPS)


class RefusedError(Exception):
    """A certificate does not establish the conclusion of its rule; the message gives the reason."""


@dataclass(frozen=True)
class Frame:
    """The hypotheses that a certificate of an induction may use, and the moves of the system.

    first   hypotheses on the first state
    known   hypotheses on every state
    step    further hypotheses on every step
    over    the variables that a conclusion may read: state only, since an input differs from step to step; in a conclusion
            for all inputs no ghosts
    """

    first: Terms
    known: Terms
    step: Terms
    moves: Mapping[int, int]
    inputs: Mapping[int, Var]
    over: Terms

    def inductive(self, write: Translation, starts: Sequence[Certificate], step: Certificate) -> Terms:
        """Return the terms that hold in the first k states, and in every state after k states in which they hold.

        The goal is the same term as the hypothesis, with the values after the steps substituted for variables. Each of the
        first states has a goal of its own, since a run may end there. RefusedError if a certificate uses other hypotheses.
        """
        k, conjuncts, (states, allowed) = len(starts), write.dag.conjuncts, self.unrolled(write, len(starts))
        early, late = [conjuncts(start.goals) for start in starts], conjuncts(step.goals)
        kept = frozenset(
            one
            for one in early[0]
            if write.dag.variables(one) <= self.over
            and all(state.all([one]) <= shown for state, shown in zip(states, [*early, late], strict=True))
        )
        known = [self.known, *(state.all(self.known) for state in states[1:k])]
        for number, start in enumerate(starts):
            _only(start, self.first.union(*known[: number + 1], *allowed[:number]))
        _only(step, frozenset().union(*known, *allowed, *(state.all(kept) for state in states[:k])))
        return kept

    def unrolled(self, write: Translation, k: int) -> tuple[list[Rewriting], list[Terms]]:
        """Return the rewritings to state 0 and the k states after it, and the hypotheses of each step; its inputs are x@j."""
        moves, states, allowed = self.moves, [Rewriting(write.dag, {}), Rewriting(write.dag, self.moves)], [self.step]
        for number in range(1, k):
            inputs = {node: write.named(var, f"{var.name}@{number}") for node, var in self.inputs.items()}
            if not {*inputs.values()}.isdisjoint({*self.moves, *self.inputs}):
                raise RefusedError("a variable has the name of an input of a later step")
            step = Rewriting(write.dag, {**moves, **inputs})
            allowed.append(step.all(self.step))
            moves = {var: step(term) for var, term in self.moves.items()}
            states.append(Rewriting(write.dag, moves))
        return states, allowed


class Speaker:
    """A system as nodes, and the facts about it that are established so far.

    always  state terms that hold for all inputs in range
    facts   state terms that hold under the assumption, those of `always` included
    free    terms over a step that hold for all inputs in range
    lawful  terms over a step that hold under the assumption, those of `free` included
    """

    def __init__(self, system: TransitionSystem, write: Translation) -> None:
        self.system, self.write, self.dag = system, write, write.dag
        self.state, self.ghosts = frozenset(map(write, system.state)), frozenset(map(write, system.ghosts))
        self.ranges = write.conjuncts([in_range(system.state)])
        self.inputs = {assume: write.conjuncts([environment(system, assume=assume)]) for assume in (False, True)}
        self.moves = {write(var): write(term) for var, term in system.next.items()}
        self.after = Rewriting(self.dag, self.moves)
        self.always, self.facts, self.free, self.lawful = Terms(), Terms(), Terms(), Terms()

    def first(self, system: TransitionSystem, *, lawful: bool) -> Terms:
        """Return the facts about the first state; unless `lawful`, without conditions that relate on-board state to ghosts."""
        begins = self.write.conjuncts([system.init, in_range(system.state)])
        return begins if lawful else frozenset(one for one in begins if not self._ties(one))

    def _ties(self, term: int) -> bool:
        read = self.dag.variables(term)
        return not (read <= self.ghosts or read.isdisjoint(self.ghosts))

    def add(self, terms: Iterable[int], *, lawful: bool) -> None:
        """Add established state terms."""
        self.facts |= frozenset(terms)
        self.always |= frozenset() if lawful else frozenset(terms)

    def add_step(self, terms: Iterable[int], *, lawful: bool) -> None:
        """Add established terms over a step."""
        self.lawful |= frozenset(terms)
        self.free |= frozenset() if lawful else frozenset(terms)

    def known(self, *, lawful: bool) -> Terms:
        """Return the established state terms."""
        return self.facts if lawful else self.always

    def step(self, *, lawful: bool) -> Terms:
        """Return the facts about a step: its inputs, the state before it, and the step itself."""
        return self.inputs[lawful] | self.known(lawful=lawful) | (self.lawful if lawful else self.free)

    def frame(self, system: TransitionSystem, further: Terms, *, lawful: bool) -> Frame:
        """Return the frame for this system, or for the same system with observers; `further` are hypotheses on a step."""
        write = self.write
        return Frame(
            self.first(system, lawful=lawful),
            self.known(lawful=lawful),
            self.step(lawful=lawful) | further,
            {
                **self.moves,
                **{write(var): write(term) for var, term in system.next.items() if write(var) not in self.moves},
            },
            {write(var): var for var in system.inputs},
            frozenset(map(write, system.state)),
        )

    def facts_frame(self, *, lawful: bool) -> Frame:
        """Return the frame for facts about this system itself; facts for all inputs must not read ghosts."""
        frame = self.frame(self.system, Terms(), lawful=lawful)
        return frame if lawful else replace(frame, over=frame.over - self.ghosts)


def _only(certificate: Certificate, allowed: Terms) -> None:
    """Raise RefusedError if the certificate has a hypothesis that is not allowed."""
    strange = certificate.hypotheses - allowed
    if strange:
        raise RefusedError(f"{len(strange)} of its hypotheses are not allowed by its rule")


class Theory:
    """Everything that the certificates of one target establish.

    goals      returns the goals by machine ("" for the whole system) and name
    in_range   machines whose wired inputs are proved to be in range
    contracts  machines whose assumption is discharged as well
    proved     goals that hold in every run, with the files that prove it
    at_first   goals that hold in the first state, with the files that prove it
    absent     terms over a step with an absent input, by machine, input, and whether the assumption is needed
    further    facts that were proved on the way to an obligation
    witnesses  terms proposed for inputs; nothing relies on them without a check
    """

    def __init__(self, system: TransitionSystem, goals: Callable[[str, str], Sequence[Goal]]) -> None:
        self.write = Translation(Dag())
        self.dag, self.goals = self.write.dag, goals
        self.together = Speaker(system, self.write)
        self.parts = {part.name: (part, Speaker(part.alone, self.write)) for part in system.parts}
        self._into = {
            name: Rewriting(self.dag, {self.write(var): self.write(part.into(var)) for var in part.alone.state})
            for name, (part, _) in self.parts.items()
        }
        self.in_range: set[str] = set()
        self.contracts: set[str] = set()
        self.proved: dict[Goal, Files] = {}
        self.at_first: dict[Goal, Files] = {}
        self.absent = defaultdict[tuple[str, str, bool], Terms](Terms)
        self.first_values, self.further = Terms(), Terms()
        self.witnesses: list[Mapping[int, int]] = []
        self._pass_on()

    def take(self, certificates: Sequence[Certificate]) -> dict[str, str]:
        """Establish all conclusions of the certificates; return the files without a conclusion, each with the reason."""
        useless = {one.file: without_rule(one.header.get("rule", "")) for one in certificates}
        attempts = list(_attempts(certificates))
        pending = [one for one in attempts if one[0] in _FACTS_FIRST]
        while pending:
            left = [one for one in pending if not self._applied(*one, useless)]
            if len(left) == len(pending):
                break
            pending = left
        for attempt in attempts:
            if attempt[0] not in _FACTS_FIRST:
                self._applied(*attempt, useless)
        return useless

    def _applied(self, family: str, together: Sequence[Certificate], useless: dict[str, str]) -> bool:
        header = together[0].header
        speaker = self.speaker(header.get("part", ""))
        try:
            if speaker is None or header.get("system") != self.together.system.name:
                raise RefusedError("it is about an unknown system")
            _RULES[family](self, speaker, *together)
        except (RefusedError, ValueError) as error:
            useless.update({one.file: str(error) for one in together if one.file in useless})
            return False
        for one in together:
            useless.pop(one.file, None)
        self._pass_on()
        return True

    def speaker(self, part: str) -> Speaker | None:
        """Return the machine of this name, the whole system for "", None for an unknown machine."""
        return self.together if not part else self.parts[part][1] if part in self.parts else None

    def _pass_on(self) -> None:
        """Add the facts about each machine to the composition, once its wired inputs are in range and its assumption is
        discharged."""
        for name, (part, alone) in self.parts.items():
            if self.write.conjuncts([part.inputs_in_range]) <= self.together.free:
                self.in_range.add(name)
                self.together.add(self._into[name].all(alone.always), lawful=False)
                if self.write.conjuncts([part.contract]) <= self.together.lawful:
                    self.contracts.add(name)
                    self.together.add(self._into[name].all(alone.facts), lawful=True)

    # -------------------------------------------------------------- facts

    def _layer(self, speaker: Speaker, start: Certificate, step: Certificate) -> None:
        lawful = start.header.get("layer") in _LAWFUL
        frame = speaker.facts_frame(lawful=lawful)
        speaker.add(frame.inductive(self.write, [start], step), lawful=lawful)

    def _step(self, speaker: Speaker, one: Certificate) -> None:
        lawful = one.header["rule"] in _LAWFUL
        if not one.hypotheses <= speaker.step(lawful=lawful):
            _only(one, speaker.step(lawful=lawful) | speaker.after.all(speaker.known(lawful=lawful)))
        speaker.add_step(self.dag.conjuncts(one.goals), lawful=lawful)

    # -------------------------------------------------------------- properties

    def _property(self, speaker: Speaker, *together: Certificate) -> None:
        """Establish each declared property of this name; without such a property, facts on the way to an obligation."""
        header, files = together[0].header, frozenset(one.file for one in together)
        goals = self.goals(header.get("part", ""), header.get("property", ""))
        errors = list[RefusedError]()
        for goal in goals:
            try:
                lawful = not goal.prop.unconditional
                frame = speaker.frame(goal.system, self.write.conjuncts([goal.prop.further_assumption]), lawful=lawful)
                missing = self.write.conjuncts([goal.good]) - self._shown(frame, together)
                if missing:
                    raise RefusedError(f"{len(missing)} parts of the property are not shown")
                (self.at_first if header["rule"] == "first state" else self.proved)[goal] = files
            except RefusedError as error:
                errors.append(error)
        if goals and len(errors) == len(goals):
            raise errors[0]
        if not goals:
            self._on_the_way(speaker, *together)

    def _shown(self, frame: Frame, together: Sequence[Certificate]) -> Terms:
        """Return the terms that the certificates establish for every state, or for the first one, according to their
        rule."""
        rule, last = together[0].header["rule"], together[-1]
        if rule == "induction start":
            return frame.inductive(self.write, together[:-1], last)
        kept = frame.inductive(self.write, together[:1], together[1]) if rule == "invariant start" else Terms()
        _only(last, frame.known | kept | (frame.first if rule == "first state" else Terms()))
        return kept | self.dag.conjuncts(last.goals) | frozenset(last.goals)

    def _on_the_way(self, speaker: Speaker, *together: Certificate) -> None:
        """Establish facts about every state that belong to no property: for all inputs if its hypotheses allow it, else under
        the assumption; those that read ghosts always under the assumption."""
        if together[0].header["rule"] == "first state":
            raise RefusedError("there is no property of this name")
        free, lawful = speaker.facts_frame(lawful=False), speaker.facts_frame(lawful=True)
        try:
            shown, frames = self._shown(free, together), {False: free, True: lawful}
        except RefusedError:
            shown, frames = self._shown(lawful, together), {True: lawful}
        for law, frame in frames.items():
            kept = frozenset(one for one in shown if self.dag.variables(one) <= frame.over)
            self.further |= kept
            speaker.add(kept, lawful=law)

    # -------------------------------------------------------------- obligations with hypotheses of their own

    def _absence(self, speaker: Speaker, one: Certificate) -> None:
        """Establish that two copies of a step agree that differ in the value of an absent input only; that no law reads it is
        an obligation of its own, so the assumption may be one of both."""
        option = next((each for each in speaker.system.optionals if each.value.name == one.header.get("of")), None)
        if option is None:
            raise RefusedError("there is no such optional input")
        other = self.write.named(option.value, f"{option.value.name} (other)")
        if other in map(self.write, (*speaker.system.state, *speaker.system.inputs)):
            raise RefusedError("a variable has the name of the second copy")
        name, lawful = option.value.name, one.header["rule"] != "absence"
        further = self.write.conjuncts([in_range(speaker.system.inputs), *([speaker.system.assume] if lawful else ())])
        further |= Rewriting(self.dag, {self.write(option.value): other}).all(further)
        _only(one, further | speaker.known(lawful=lawful) | {self.dag.make("not", [self.write(option.present)])})
        self.absent[one.header.get("part", ""), name, lawful] |= frozenset(one.goals) | self.dag.conjuncts(one.goals)

    def _first_values(self, speaker: Speaker, one: Certificate) -> None:
        _only(one, speaker.ranges)
        self.first_values |= self.dag.conjuncts(one.goals)


_RULES: Mapping[str, Callable[..., None]] = {
    "layer": Theory._layer,
    **dict.fromkeys(_STEPS, Theory._step),
    **dict.fromkeys(("induction", "implied", "invariant", "first state"), Theory._property),
    **dict.fromkeys(("absence", "absence under the assumption"), Theory._absence),
    "overflow of first values": Theory._first_values,
    "lasts": Theory._on_the_way,
    "witnesses": lambda theory, _, one: theory.witnesses.extend(one.witnesses),
}


def _attempts(certificates: Iterable[Certificate]) -> Iterator[tuple[str, tuple[Certificate, ...]]]:
    """Yield certificates that may belong together: of one rule, one machine, one property or layer."""
    groups: dict[tuple[str, ...], dict[str, list[Certificate]]] = {}
    for one in certificates:
        family, _, role = one.header.get("rule", "").rpartition(" ")
        if role not in _ROLES.get(family, ()):
            family, role = one.header.get("rule", ""), ""
        about = (one.header.get(key, "") for key in ("system", "part", "layer", "property"))
        k, unique = one.header.get("k", "1"), () if role else (one.file,)
        groups.setdefault((family, *about, *unique), {}).setdefault(f"{role} {k}" if role else "", []).append(one)
    for (family, *_), by_role in groups.items():
        for roles in _needed(family, by_role) if family in _RULES else ():
            yield from ((family, found) for found in product(*(by_role.get(role, []) for role in roles)))


def _needed(family: str, by_role: Mapping[str, object]) -> Iterator[list[str]]:
    """Yield the roles that belong together; an induction over k steps has k starts, each about one more state."""
    if family != "induction":
        yield [f"{role} 1" for role in _ROLES[family]] if family in _ROLES else [""]
        return
    for last in (role for role in by_role if role.startswith("step ")):
        k = last.removeprefix("step ")
        if k.isdecimal() and 0 < int(k) < len(by_role):
            yield [*(f"start {number}" for number in range(1, int(k) + 1)), last]
