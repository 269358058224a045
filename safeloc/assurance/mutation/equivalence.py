"""Check whether a mutant is equivalent to the machine: the same outputs on every run that the world allows.

First both are compared as functions on all states that the proved claims allow. If they differ there, machine and mutant are
compared as two copies side by side: from a list of equalities between their variables, in all modes, in one, or while a flag is set
or not, the greatest part that every step preserves is kept, and equal outputs have to follow from it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from safeloc.assurance.mutation.claims import Canon, Held
from safeloc.assurance.mutation.playing import Apart
from safeloc.assurance.mutation.stepping import stepped
from safeloc.language.expr import Bool, Expr, Lit, Var
from safeloc.language.nodes import BoolVar, Num
from safeloc.language.system import TransitionSystem, environment, in_range
from safeloc.language.terms import Substitution
from safeloc.proof.provers.limits import Limits

_MOST_BY_FLAG = 400
"""Most equalities by flag that are tried; machines with more flags and variables are compared without them."""


def equivalent(
    known: Held, mutant: Held, apart: Sequence[Apart], canon: Canon, limits: Limits, *, still_proved: bool
) -> str:
    """Return a text that says how the mutant was proved equivalent, or "".

    known         the unchanged machine
    apart         states of both that differ, after the same lawful steps
    still_proved  all claims are proved for the mutant, too, and may be used
    """
    for layers, words in ((1, "for all inputs in range"), (2, "under the assumption")) if not apart else ():
        if _same_step(known, mutant, canon, limits, layers=layers):
            return f"the same step and outputs in every reachable state, {words}"
    if Side(known, mutant, apart, canon, limits, still_proved=still_proved).tells_the_same():
        return "the same outputs on every run under the assumption, by two copies side by side"
    return ""


def _facts(unchanged: Held, layers: int) -> list[Bool]:
    """Return the proved facts about single states: claims of the first layers, without helpers and claims with observers."""
    claims = [claim for layer in unchanged.layers[:layers] for claim in layer.claims if claim.kind != "helper"]
    return [one.good for one in claims if one.goal is None or not one.goal.observers]


def _on_board(system: TransitionSystem) -> list[Var]:
    return [var for var in system.state if var not in system.ghosts]


def _same_step(known: Held, mutant: Held, canon: Canon, limits: Limits, *, layers: int) -> bool:
    one, other = known.system, mutant.system
    facts = _facts(known, layers)
    hypotheses = [environment(one, assume=layers > 1), *facts]
    moved = {var.name: (one.next[var], other.next[var]) for var in _on_board(one)}
    told = {name: (term, other.outputs[name]) for name, term in one.outputs.items()}
    questions = ((hypotheses, _changed(moved)), ([in_range(one.state), *facts], _changed(told)))
    return all(canon.asked.all_follow(*question, limits.seconds) for question in questions)


def _changed(pairs: Mapping[str, tuple[Expr, Expr]]) -> dict[str, Bool]:
    return {name: equal(new, old) for name, (old, new) in pairs.items() if new is not old}


def equal(one: Expr, other: Expr) -> Bool:
    if isinstance(one, Num):
        assert isinstance(other, Num)
        return one.eq(other)
    assert isinstance(one, Bool)
    assert isinstance(other, Bool)
    return one.iff(other)


class Side:
    """The machine and the mutant side by side, with the same inputs and ghosts; the mutant's variables have other names.

    twins    for each variable on board, that of the mutant
    outputs  for each output, the terms of the machine and of the mutant
    """

    def __init__(
        self,
        known: Held,
        mutant: Held,
        apart: Sequence[Apart],
        canon: Canon,
        limits: Limits,
        *,
        still_proved: bool,
    ) -> None:
        self._one, self._apart, self._canon, self._limits = known.system, apart, canon, limits
        self._second, self.twins = canon.second(_on_board(self._one))
        other = mutant.system
        self.outputs = {name: (term, self._second(other.outputs[name])) for name, term in self._one.outputs.items()}
        moves = {twin: canon.share(self._second(other.next[var])) for var, twin in self.twins.items()}
        self._after = Substitution({**self._one.next, **moves})
        self._facts = [*_facts(known, 2), in_range(self._one.state)]
        if still_proved:
            self._facts += [self._second.bool(term) for term in (*_facts(mutant, 2), in_range(_on_board(other)))]
        self._now = canon.asked.under(self._facts)
        self._in_a_step = canon.asked.under([*self._facts, environment(self._one)])

    def tells_the_same(self) -> bool:
        """Return whether equal outputs on every run under the assumption are proved."""
        goals = {name: equal(one, other) for name, (one, other) in self.outputs.items()}
        plain = self.all_equal()
        if self.proved(plain, goals):
            return True
        by_mode = {**plain, **self.equal_by_mode()}
        if self.proved(by_mode, goals):
            return True
        by_flag = self.equal_by_flag()
        return 0 < len(by_flag) <= _MOST_BY_FLAG and self.proved({**by_mode, **by_flag}, goals)

    def all_equal(self) -> dict[str, Bool]:
        """Return for each variable on board the equality of both copies."""
        return {var.name: equal(var, twin) for var, twin in self.twins.items()}

    def equal_by_mode(self) -> dict[str, Bool]:
        """Return for each variable and each mode the equality of both copies while the machine is in that mode."""
        return {name: term for var in self.twins for name, term in self._by_mode(var)}

    def _by_mode(self, var: Var) -> Iterator[tuple[str, Bool]]:
        for machine in self._one.machines:
            mode = machine.mode
            for value in range(mode.low, mode.high + 1) if mode in self.twins and mode is not var else ():
                yield f"{var.name} in {value}", mode.eq(Lit(value, mode.unit)).implies(equal(var, self.twins[var]))

    def equal_by_flag(self) -> dict[str, Bool]:
        """Return for each variable and each flag, of state or outputs, the equality of both copies while it is set, and while not.

        A stored report that is not there may have any content: its numbers need to be equal only while the flag says that it is there.
        """
        flags: dict[str, Bool] = {var.name: var for var in self.twins if isinstance(var, BoolVar)}
        flags |= {f"output {name}": one for name, (one, _) in self.outputs.items() if isinstance(one, Bool)}
        return {
            f"{var.name} {words} {name}": condition.implies(equal(var, self.twins[var]))
            for name, flag in flags.items()
            for words, condition in (("while", flag), ("while not", ~flag))
            for var in self.twins
            if var is not flag
        }

    def at_first(self, relations: Mapping[str, Bool]) -> dict[str, Bool]:
        """Return the relations that hold in every first state, in which both copies are equal."""
        failed = self._fails([self._one.init, *self.all_equal().values()], relations)
        return {key: term for key, term in relations.items() if key not in failed}

    def proved(self, relations: Mapping[str, Bool], goals: Mapping[str, Bool]) -> bool:
        """Return whether the goals follow from the greatest part of the relations that every step preserves.

        All relations have to hold at first. Those that fail in states that both reach are not in that part, and are not asked. As soon
        as the goals do not follow from what is left, they do not follow from fewer.
        """
        kept = self._seen_to_hold(relations)
        while not self._now.some_failures([*kept.values()], goals, self._limits.seconds):
            after = {key: self._after.bool(term) for key, term in kept.items()}
            failed = self._in_a_step.some_failures([*kept.values()], after, self._limits.seconds)
            if not failed:
                return True
            kept = {key: term for key, term in kept.items() if key not in failed}
        return False

    def _seen_to_hold(self, relations: Mapping[str, Bool]) -> dict[str, Bool]:
        """Return the relations that hold in all states of `apart`."""
        kept = dict(relations)
        if self._apart and kept:
            look = stepped((tuple(self.twins), tuple(self.twins.values())), [*kept.values()])
            columns = zip(*(look(*states) for states in self._apart), strict=True)
            kept = {key: term for (key, term), held in zip(relations.items(), columns, strict=True) if all(held)}
        return kept

    def _fails(self, hypotheses: Sequence[Bool], goals: Mapping[str, Bool]) -> dict[str, bool]:
        return self._canon.asked.failures([*self._facts, *hypotheses], goals, self._limits.seconds)
