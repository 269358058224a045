"""Moves as nested statements: values that depend on the same condition share one `if`.

A term that several places need is computed once, directly before the first of them, and after the tests that do not need it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from safeloc.codegen.naming_terms import Text, Writing
from safeloc.codegen.simplify_under_facts import Known, implied
from safeloc.language.nodes import And, Bool, Choose, ChooseBool, Expr, Lit, Not, Or, Truth

_FEWEST_REASONS = 3
_DEEPEST = 40  # Python itself refuses more than 100 levels of indentation

Targets = Sequence[tuple[str, Expr]]


@dataclass(frozen=True)
class Bind:
    """An assignment: a name for a value, which is a number or a truth value."""

    name: str
    value: Text
    is_truth: bool


@dataclass(frozen=True)
class Test:
    """An `if` whose block ends the function; the statements after it run if the test fails."""

    test: Text
    block: Block


@dataclass(frozen=True)
class Choice:
    """An `if`, `elif`, `else`: runs the first branch whose test holds, else `otherwise`, and continues after it."""

    branches: tuple[tuple[Text, Block], ...]
    otherwise: Block


@dataclass(frozen=True)
class End:
    """The end of a branch, with the targets' values."""

    values: tuple[Text, ...]


Statement = Bind | Test | Choice | End
Block = list[Statement]


@dataclass(frozen=True)
class _Group:
    """Targets chosen by one condition, or by none."""

    condition: Expr | None
    targets: Targets


class Blocks:
    """Builds statements; tracks which terms have a name at the current place."""

    def __init__(self, written: Writing) -> None:
        self._written = written
        self._count = 0
        self._known: dict[tuple[Expr, bool], Known] = {}

    def text(self, term: Expr) -> Text:
        """Return the term as an expression."""
        return self._written.text(term)

    def ending(self, targets: Targets, depth: int = 0) -> Block:
        """Return statements that compute all targets, and end every branch with their values."""
        outer, block = dict(self._written.named), list[Statement]()
        while (condition := self._begin(targets, block, depth)) is not None:
            then = self.ending(self._under(condition, targets, True), depth + 1)
            block.append(Test(self.text(condition), then))
            targets = self._under(condition, targets, False)
        block.append(End(tuple(self.text(term) for _, term in targets)))
        self._written.named = outer
        return block

    def either(self, condition: Expr, holds: Callable[[], Block], fails: Callable[[], Block]) -> Block:
        """Return statements that run the block of `holds` if the condition holds, else that of `fails`; both end the
        function."""
        outer = dict(self._written.named)
        before, text = self._prepared(condition, 0), self.text(condition)
        inside = dict(self._written.named)
        then = holds()
        self._written.named = inside
        block = [*before, Test(text, then), *fails()]
        self._written.named = outer
        return block

    def _begin(self, targets: Targets, block: Block, depth: int) -> Expr | None:
        """Compute all targets except those that depend on one condition; return this condition, prepared for a test.

        None if no target depends on a condition. The statements are appended to `block`.
        """
        groups = self._grouped(targets, depth)
        block += self._bound(self._shared(groups), depth)
        chosen = [group for group in groups if group.condition is not None]
        last = max(chosen, key=lambda group: len(group.targets), default=None)
        for group in groups:
            if group.condition is None:
                block += [statement for _, term in group.targets for statement in self._prepared(term, depth)]
                if last is not None:
                    block += self._bound([term for _, term in group.targets], depth)
            elif group is not last:
                block += self._choice(group.condition, group.targets, depth)
                self._written.named |= {term: name for name, term in group.targets}
        if last is None or last.condition is None:
            return None
        block += self._prepared(last.condition, depth)
        return last.condition

    def _keeping(self, targets: Targets, depth: int) -> Block:
        """Return statements that assign every target's value to its name."""
        outer, block = dict(self._written.named), list[Statement]()
        condition = self._begin(targets, block, depth)
        if condition is None:
            block += [Bind(name, self.text(term), isinstance(term, Bool)) for name, term in targets]
        else:
            left = [(name, term) for name, term in targets if self._written.named.get(term) != name]
            block += self._choice(condition, left, depth)
        self._written.named = outer
        return block

    def _choice(self, condition: Expr, targets: Targets, depth: int) -> Block:
        """Return one `if`, `elif`, `else`, extended as long as the next test needs no computation before it."""
        before, branches = self._prepared(condition, depth), list[tuple[Text, Block]]()
        rung: Expr | None = condition
        while rung is not None:
            branches.append((self.text(rung), self._keeping(self._under(rung, targets, True), depth + 1)))
            targets = self._under(rung, targets, False)
            rung = self._next_rung(targets, depth)
        return [*before, Choice(tuple(branches), self._keeping(targets, depth + 1))]

    def _next_rung(self, targets: Targets, depth: int) -> Expr | None:
        """Return the one condition on which targets depend, if it can be tested without a computation before; else None."""
        groups = self._grouped(targets, depth)
        conditions = [group.condition for group in groups if group.condition is not None]
        plain = [term for group in groups if group.condition is None for _, term in group.targets]
        if len(conditions) != 1 or self._written.unnamed(plain):
            return None
        waits = [*self._written.awaited(conditions[0]), *self._shared(groups)]
        return None if any(map(self._needs_name, waits)) else conditions[0]

    def _prepared(self, term: Expr, depth: int) -> Block:
        return self._bound(self._written.awaited(term), depth)

    def _bound(self, terms: Iterable[Expr], depth: int) -> Block:
        """Return assignments for terms without a name; terms that only one branch of a choice needs are computed there."""
        block: Block = []
        for term in terms:
            if not self._needs_name(term):
                continue
            if isinstance(term, (Choose, ChooseBool)) and depth < _DEEPEST and self._branches_wait(term):
                name = self._new_name()
                block += self._choice(term.condition, [(name, term)], depth)
            else:
                block += self._prepared(term, depth)
                value, name = self.text(term), self._new_name()
                block.append(Bind(name, value, isinstance(term, Bool)))
            self._written.named[term] = name
        return block

    def _branches_wait(self, term: Choose | ChooseBool) -> bool:
        """Return whether a branch of the choice needs a term that has to be computed before."""
        tested = set(self._written.unnamed([term.condition]))
        return any(self._needs_name(part) and part not in tested for part in self._written.awaited(term))

    def _new_name(self) -> str:
        self._count += 1
        return f"t{self._count}"

    def _needs_name(self, term: Expr) -> bool:
        """Return whether the term is neither a constant, nor named, nor the negation of such a term."""
        inner = term.inner if isinstance(term, Not) else term
        return not isinstance(inner, (Lit, Truth)) and inner not in self._written.named

    def _grouped(self, targets: Targets, depth: int) -> list[_Group]:
        """Return the targets grouped by the condition on which they depend, in order of first appearance; None: no condition."""
        if depth >= _DEEPEST:
            return [_Group(None, targets)]
        groups: dict[Expr | None, list[tuple[str, Expr]]] = {}
        for name, term in targets:
            chosen = isinstance(term, (Choose, ChooseBool)) and term not in self._written.named
            key = term.condition if chosen and isinstance(term, (Choose, ChooseBool)) else None
            groups.setdefault(key, []).append((name, term))
        return [_Group(condition, members) for condition, members in groups.items()]

    def _sites(self, group: _Group) -> list[list[Expr]]:
        """Return the places of a group in the code, each with the terms that are computed there."""
        if group.condition is None:
            return [[term] for _, term in group.targets]
        branches = [[term for _, term in self._under(group.condition, group.targets, holds)] for holds in (True, False)]
        return [[group.condition], *branches]

    def _under(self, condition: Expr, targets: Targets, holds: bool) -> list[tuple[str, Expr]]:
        """Return the targets simplified for a known truth value of the condition."""
        left = _chosen(condition, targets, holds)
        if not any(node is condition for node in self._written.unnamed([term for _, term in left])):
            return left
        assert isinstance(condition, Bool)
        if (condition, holds) not in self._known:
            kept = {term: term for term in self._written.named}
            self._known[condition, holds] = Known({**kept, **implied(condition, holds)})
        known, named = (
            self._known[condition, holds],
            self._written.named,
        )  # what has a name keeps it: it is computed already
        return [(name, term if term in named else known(term)) for name, term in left]

    def _shared(self, groups: Sequence[_Group]) -> list[Expr]:
        """Return the terms that more than one place needs, operands first."""
        places: dict[int, int] = {}  # one bit a place
        uses: Counter[int] = Counter()
        sites, again = list[list[Expr]](), list[int]()
        for group in groups:
            again += [0b11 << len(sites)] if _lists_reasons(group.condition) else []
            sites += self._sites(group)
        for number, site in enumerate(sites):
            for term in site:
                places[id(term)] = places.get(id(term), 0) | 1 << number
                uses[id(term)] += 1
        order = self._written.unnamed([term for site in sites for term in site])
        for node in reversed(order):
            for part in dict.fromkeys(self._written.parts(node)):
                places[id(part)] = places.get(id(part), 0) | places[id(node)]
                uses[id(part)] += 1
        shared = [node for node in order if uses[id(node)] > 1 and places[id(node)] & (places[id(node)] - 1)]
        return [node for node in shared if all(places[id(node)] & ~both for both in again)]


def _lists_reasons(condition: Expr | None) -> bool:
    """Return whether the condition is a disjunction of many reasons: in most steps none holds, and the branch tests each again.

    Terms that both the test and the branch need are then computed twice instead of named, because the test stops at the
    first reason that holds.
    """
    parts = condition.parts if isinstance(condition, And) else (condition,)
    return any(isinstance(part, Or) and len(part.parts) >= _FEWEST_REASONS for part in parts)


def _chosen(condition: Expr, targets: Targets, holds: bool) -> list[tuple[str, Expr]]:
    """Return the targets for a known truth value of the condition: of a choice by it, the chosen branch."""
    left: list[tuple[str, Expr]] = []
    for name, term in targets:
        if isinstance(term, (Choose, ChooseBool)) and term.condition is condition:
            left.append((name, term.then if holds else term.other))
        else:
            left.append((name, term))
    return left
