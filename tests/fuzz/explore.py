"""The explicit search: every state that any inputs lead to, and what claims are worth there. Nothing here is safeloc's."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from tests.fuzz.judge import Claim, Watch, requires_first
from tests.fuzz.speaks import comes
from tests.fuzz.terms import Term, fast, was
from tests.fuzz.world import Game, State

LIMIT = 1500  # states; a machine with more is searched so far only, and says so
NODES = 40_000  # of states with what a claim remembers


class Edge(NamedTuple):
    """A step: state before and inputs, the state after it by number, the rows that fired, and whether it is lawful."""

    known: State
    after: int
    fired: State
    lawful: bool


@dataclass
class Space:
    """All states by number, each with its steps; the first `starts` of them are first states.

    full  every state after so many steps or fewer has its steps; None where that is so of all states
    """

    game: Game
    states: list[State]
    edges: list[list[Edge]]
    starts: int
    full: int | None
    _seen: dict[int, Mapping[str, int]] = field(default_factory=dict)

    def env(self, edge: Edge) -> Mapping[str, int]:
        """What a claim reads in a step: values before, inputs, what fired, and the state after."""
        known = self._seen.get(id(edge))
        if known is None:
            names = self.game.state_names
            before = {was(name): edge.known[name] for name in names}
            known = self._seen[id(edge)] = {**edge.known, **before, **edge.fired, **self.states[edge.after]}
        return known

    def reached(self, allowed: Callable[[Edge], int]) -> dict[int, int]:
        """State -> the number of allowed steps to it."""
        depth = dict.fromkeys(range(self.starts), 0)
        queue = list(depth)
        for state in queue:
            for edge in self.edges[state]:
                if edge.after not in depth and allowed(edge):
                    depth[edge.after] = depth[state] + 1
                    queue.append(edge.after)
        return depth

    def steps(self, allowed: Callable[[Edge], int]) -> Iterator[tuple[int, Edge]]:
        """Every allowed step from a state that allowed steps lead to, with the depth of its state."""
        for state, depth in self.reached(allowed).items():
            yield from ((depth, edge) for edge in self.edges[state] if allowed(edge))

    def dead_ends(self, allowed: Callable[[Edge], int]) -> list[int]:
        """States that allowed steps lead to and none leaves."""
        return [state for state in self.reached(allowed) if not any(map(allowed, self.edges[state]))]

    def for_ever(self, allowed: Callable[[Edge], int]) -> set[int]:
        """States from which some run of allowed steps never ends, as far as states have their steps."""
        left = {state: {edge.after for edge in self.edges[state] if allowed(edge)} for state in self.reached(allowed)}
        while ending := [state for state, later in left.items() if not later & left.keys()]:
            for state in ending:
                del left[state]
        return set(left)

    def lasts(self, allowed: Callable[[Edge], int], steps: int) -> bool:
        """Whether some run has so many allowed steps."""
        now = set(range(self.starts))
        for _ in range(steps):
            now = {edge.after for state in now for edge in self.edges[state] if allowed(edge)}
        return bool(now)


def lawful(edge: Edge) -> bool:
    """Steps under the assumption."""
    return edge.lawful


def anyhow(_: Edge) -> bool:
    """All steps."""
    return True


def search(game: Game, limit: int = LIMIT) -> Space:
    """Every state, breadth first, of at most about `limit`."""
    names = game.state_names
    starts = [dict(one) for one in {_key(first, names): first for first in game.firsts()}.values()]
    states, number, choices = list(starts), {_key(one, names): n for n, one in enumerate(starts)}, game.choices()
    depth, edges, full = [0] * len(states), list[list[Edge]](), None
    for place, state in enumerate(states):
        if place >= limit:
            full = depth[place] - 1
            break
        edges.append([])
        for inputs in choices:
            known = {**state, **inputs}
            after, fired, allowed = game.step(known)
            key = _key(after, names)
            if key not in number:
                number[key] = len(states)
                states.append(after)
                depth.append(depth[place] + 1)
            edges[place].append(Edge(known, number[key], fired, allowed))
    edges += [[] for _ in states[len(edges) :]]
    return Space(game, states, edges, len(starts), full)


def _key(state: State, names: tuple[str, ...]) -> tuple[int, ...]:
    return tuple(state[name] for name in names)


@dataclass(frozen=True)
class Truth:
    """What a claim is worth.

    depth     of the shortest run that breaks it (for `reachable`: that comes there); None where there is none
    known     whether the search saw enough to say so; a depth that is known is the shortest
    goes_on   whether each of its runs can go on
    lasts     whether some run keeps its further assumption for five steps
    """

    depth: int | None
    known: bool
    goes_on: bool
    lasts: bool


def allowed_by(claim: Claim) -> Callable[[Edge], int]:
    """The steps that a claim speaks of."""
    further = fast(claim.further_assumption)
    if claim.unconditional:
        return lambda edge: further(edge.known)
    return lambda edge: edge.lawful and further(edge.known)


def truth(space: Space, claim: Claim) -> Truth:
    """The claim by breadth-first search over states and what the claim remembers of its past."""
    allowed = allowed_by(claim)
    watch = Watch(claim)
    first = requires_first(claim, space.game.state_names)
    queue = [(state, watch.memory, 0) for state in range(space.starts)]
    seen = {(state, memory) for state, memory, _ in queue}
    if first and any(watch.hit(space.states[state]) for state in range(space.starts)):
        return Truth(0, True, True, True)
    for state, memory, depth in queue:
        for edge in space.edges[state]:
            if not allowed(edge):
                continue
            env = space.env(edge)
            after, hit = watch.step(memory, env)
            if hit:
                return Truth(depth + 1, space.full is None or depth <= space.full, True, True)
            if (edge.after, after) not in seen:
                seen.add((edge.after, after))
                queue.append((edge.after, after, depth + 1))
        if len(seen) > NODES:
            return Truth(None, False, True, True)
    goes_on = bool(space.starts) and not space.dead_ends(allowed)
    return Truth(None, space.full is None, goes_on, space.lasts(allowed, 5))


def occurs(space: Space, claim: Claim, case: Term) -> bool | None:
    """Whether some run comes to a case of a claim; None where the search saw too little."""
    found = truth(space, comes(claim, case, space.game.state_names))
    return True if found.depth is not None else False if found.known else None


def false_somewhere(space: Space, term: Term, allowed: Callable[[Edge], int]) -> State | None:
    """A state that allowed steps lead to and in which the term does not hold."""
    holds = fast(term)
    return next((space.states[s] for s in space.reached(allowed) if not holds(space.states[s])), None)
