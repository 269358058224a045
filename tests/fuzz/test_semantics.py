"""Our own semantics and search, on machines small enough to be counted by hand."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from tests.fuzz.bounds import FIRST, LAST, bounds, fits
from tests.fuzz.draw import Draw
from tests.fuzz.draw_claims import Claims
from tests.fuzz.draw_terms import Pen
from tests.fuzz.explore import Space, allowed_by, anyhow, lawful, occurs, search, truth
from tests.fuzz.judge import Claim, Watch, hit_at, holds_at, requires_first
from tests.fuzz.speaks import cases, plain
from tests.fuzz.terms import FALSE, TRUE, Term, Values, fast, value
from tests.fuzz.world import Row, Var, Whole, World

OURS = (
    "terms",
    "bounds",
    "world",
    "judge",
    "speaks",
    "explore",
    "draw_terms",
    "draw",
    "draw_claims",
    "draw_whole",
    "tally",
)
X, GO, Q, Y = Var("x", "number", 0, 3), Var("go", "truth"), Var("q", "number", 0, 3), Var("y", "number", 0, 3)
UP: Term = ("min", ("add", ("var", "x"), ("lit", 1)), ("lit", 3))
COUNTER = World("m", 1, (GO,), {X: 0}, rows=(Row("up", (0,), 0, ("var", "go"), {"x": UP}),))


def at_most(number: int) -> Term:
    """x <= number."""
    return ("le", ("var", "x"), ("lit", number))


@pytest.mark.parametrize("name", OURS)
def test_nothing_is_shared_with_the_product(name: str) -> None:
    """What decides what is true imports nothing of safeloc, nor a solver: only its own kind and the standard library."""
    tree = ast.parse((Path(__file__).parent / f"{name}.py").read_text(encoding="utf-8"))
    froms = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    plain = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    ours = {f"tests.fuzz.{one}" for one in OURS}
    assert [] == [one for one in (*froms, *plain) if one.split(".")[0] in ("safeloc", "z3", "cvc5", "numpy")]
    assert [] == [one for one in froms if one.startswith("tests.") and one not in ours]


@pytest.mark.parametrize(
    ("expected", "number", "divisor"), [(-1, -1, 2), (-2, -4, 2), (1, 3, 2), (0, 0, 5), (FIRST // 7, FIRST, 7)]
)
def test_division_rounds_down(expected: int, number: int, divisor: int) -> None:
    """Towards minus infinity, also of negative numbers; rounding up is the mirror image."""
    assert expected == value(("floor", ("lit", number), divisor), {})
    assert -expected == value(("ceil", ("lit", -number), divisor), {})


def test_the_fast_terms_are_the_defined_ones() -> None:
    """What the search calls gives what the definition gives, for random terms of every kind."""
    rng = Random("terms")
    variables = (Var("a", "number", -3, 3), Var("b", "number", 0, 7), Var("c", "truth"), Var("d", "colour", 0, 2))
    pen = Pen(rng, variables, (("mode", 3),))
    for _ in range(400):
        values = {**{var.name: rng.choice(var.values) for var in variables}, "mode": rng.randrange(3)}
        for term in (pen.number(3), pen.truth(3)):
            assert value(term, values) == fast(term)(values)


def test_bounds_hold_every_value() -> None:
    """Within its bounds lies whatever a term is worth; and a wide pen writes nothing that leaves 64 bits."""
    rng = Random("bounds")
    variables = (Var("a", "number", FIRST, LAST), Var("b", "number", -5, 9), Var("c", "truth"))
    ranges = {"a": (FIRST, LAST), "b": (-5, 9)}
    pen = Pen(rng, variables, (), wide=True)
    for _ in range(400):
        term = pen.number(3)
        low, high = bounds(term, ranges)
        values = {"a": rng.choice((FIRST, -1, 0, LAST)), "b": rng.randint(-5, 9), "c": rng.random() < 0.5}
        assert low <= value(term, values) <= high
        assert fits(term, ranges)


def test_every_state_is_found_with_its_depth() -> None:
    """A counter to three has four states, the last one three steps away, and eight steps in all."""
    space = search(COUNTER)
    assert {0: 0, 1: 1, 2: 2, 3: 3} == {space.states[s]["x"]: d for s, d in space.reached(anyhow).items()}
    assert 8 == sum(map(len, space.edges))


@pytest.mark.parametrize(("expected", "most"), [(None, 3), (3, 2), (1, 0)])
def test_the_shortest_run_is_found(expected: int | None, most: int) -> None:
    """The depth of a broken claim is the number of steps of the shortest run that breaks it."""
    assert expected == truth(search(COUNTER), Claim("c", "always", at_most(most))).depth


def test_the_first_state_counts_for_terms_over_state() -> None:
    """A claim over state only is broken at the start; one that reads an input in the first step."""
    space = search(COUNTER)
    assert 0 == truth(space, Claim("c", "always", ("ge", ("var", "x"), ("lit", 1)))).depth
    reads_input: Term = ("or", ("ge", ("var", "x"), ("lit", 1)), ("var", "go"))
    assert 1 == truth(space, Claim("c", "always", reads_input)).depth


@pytest.mark.parametrize(("expected", "steps"), [(1, 0), (3, 2)])
def test_within_counts_from_the_trigger(expected: int, steps: int) -> None:
    """Asked in the first step, unanswered in it and in `steps` further ones: broken after the last of them."""
    claim = Claim("c", "within", ("true",), ("ge", ("var", "x"), ("lit", 9)), steps)
    assert expected == truth(search(COUNTER), claim).depth


def test_a_dead_end_is_found() -> None:
    """Where the assumption allows no step any more, a run ends; its further assumption may end it as well."""
    space = search(replace(COUNTER, assumption=("and", at_most(1), ("var", "go"))))
    assert [{"mode": 0, "x": 2}] == [space.states[state] for state in space.dead_ends(lawful)]
    assert [True, False] == [space.lasts(lawful, steps) for steps in (2, 3)]
    further = truth(
        search(COUNTER), Claim("c", "always", at_most(3), further_assumption=("and", at_most(0), ("var", "go")))
    )
    assert not further.goes_on
    assert not further.lasts


def test_a_trigger_that_never_comes_is_told() -> None:
    """An antecedent, or the trigger of a `within`, that holds in no step leaves a claim empty."""
    space = search(COUNTER)
    never: Term = ("gt", ("var", "x"), ("lit", 3))
    for claim in (Claim("c", "always", ("implies", never, at_most(0))), Claim("c", "within", never, at_most(0), 1)):
        assert [False] == [occurs(space, claim, case) for case in cases(claim)]
    assert [] == cases(Claim("c", "always", at_most(3)))


def test_a_wire_tells_the_state_after_the_step() -> None:
    """A later machine hears in a step what an earlier one came to in it; before that there is nothing to hear."""
    later = World("b", 1, (Q,), {Y: 0}, rows=(Row("copy", (0,), 0, sets={"y": ("var", "q")}),))
    first = replace(COUNTER, name="a")
    whole = Whole("w", (first, later), {"b.q": ("var", "a.x")})
    assert all(state["a.x"] == state["b.y"] for state in search(whole).states)
    assert ("le", ("var", "a.x"), ("lit", 1)) == whole.told(later, ("le", ("var", "q"), ("lit", 1)))


def test_an_owed_assumption_is_not_assumed_of_the_whole() -> None:
    """What is owed leaves every step lawful, and is kept or not by what the earlier machine does."""
    later = World("b", 1, (Q,), {}, assumption=("le", ("var", "q"), ("lit", 1)))
    first = replace(COUNTER, name="a")
    assumed = search(Whole("w", (first, later), {"b.q": ("var", "a.x")}))
    owed = search(Whole("w", (first, later), {"b.q": ("var", "a.x")}, discharge=("b",)))
    assert 2 == len(assumed.reached(lawful))
    assert 4 == len(owed.reached(lawful))
    assert not all(owed.game.kept("b", edge.known) for _, edge in owed.steps(lawful))  # type: ignore[union-attr]


def random_run(space: Space, claim: Claim, rng: Random) -> tuple[Values, list[Values]]:
    """First state, and what a claim reads in the steps of a random allowed run, up to eight of them."""
    allowed, state, run = allowed_by(claim), rng.randrange(space.starts), list[Values]()
    first = space.states[state]
    while len(run) < 8 and (steps := [edge for edge in space.edges[state] if allowed(edge)]):
        edge = rng.choice(steps)
        run.append(space.env(edge))
        state = edge.after
    return first, run


def remembered(claim: Claim, first: Values, run: list[Values], state_names: Sequence[str]) -> int | None:
    """The same as `hit_at`, by the memory that the search uses."""
    watch = Watch(claim)
    if requires_first(claim, state_names) and watch.hit(first):
        return 0
    memory = watch.memory
    for number, env in enumerate(run, 1):
        memory, hit = watch.step(memory, env)
        if hit:
            return number
    return None


def test_the_memory_of_a_claim_says_what_its_definition_says() -> None:
    """On random runs both break a claim after the same step; and never before the shortest run that the search knows."""
    rng, seen = Random("claims"), 0
    for number in range(100):
        draw = Draw(Random(f"definition {number}"))
        space = search(draw.world())
        for claim in Claims(draw, space).some(4) if space.starts else []:
            true, names = truth(space, claim), space.game.state_names
            for _ in range(8):
                first, run = random_run(space, claim, rng)
                hit = hit_at(claim, first, run, names)
                seen += hit is not None
                assert remembered(claim, first, run, names) == hit, claim
                assert hit is None or (true.depth is not None and true.depth <= hit), claim
    assert seen > 500


def test_past_operators_are_as_documented() -> None:
    """previous is false in the first step; once stays; since needs its start and then every step."""
    run = [{"p": p, "q": q} for p, q in ((True, False), (True, True), (True, False), (False, False))]
    p, q = ("var", "p"), ("var", "q")
    assert [False, True, True, True] == [holds_at(("previous", p), run, step) for step in range(4)]
    assert [False, True, True, True] == [holds_at(("once", q), run, step) for step in range(4)]
    assert [False, True, True, False] == [holds_at(("since", p, q), run, step) for step in range(4)]


P, Z, R = ("var", "go"), ("var", "z"), ("gt", ("var", "x"), ("lit", 1))
X_IS = [("eq", ("var", "x"), ("lit", number)) for number in (0, 1)]


@pytest.mark.parametrize(
    ("expected", "term"),
    [
        ([P], ("implies", P, R)),
        ([("not", P)], ("or", P, R)),
        ([P], ("or", ("not", P), R)),
        ([P, R], ("and", ("implies", P, R), ("and", ("implies", R, P), P))),
        ([P], ("not", ("not", ("implies", P, R)))),
        ([], ("not", ("implies", P, R))),
        ([], ("iff", P, R)),
        ([], ("or", ("and", P, Z), ("and", ("not", P), ("not", Z)))),
        ([], ("among", ("var", "x"), 0, 1)),
        ([], ("or", *X_IS)),
        ([("not", X_IS[0])], ("or", X_IS[0], P)),
        ([("not", ("among", ("var", "x"), 0, 1))], ("or", ("among", ("var", "x"), 0, 1), P)),
        ([], ("ite", P, R, ("not", R))),
        ([], ("implies", P, ("eq", ("lit", 1), ("lit", 1)))),
        ([], ("or", FALSE, P)),
        ([P], ("ite", P, R, TRUE)),
    ],
)
def test_a_claim_speaks_of_cases(expected: list[Term], term: Term) -> None:
    """Of what stands before `implies`, of the failing of the first part of `or`; not of both or neither, nor of one of several."""
    assert expected == cases(Claim("c", "always", term))
    assert [] == cases(Claim("c", "reachable", term))
    assert [term] == cases(Claim("c", "within", term, P, 1))


def test_the_plain_form_means_the_same() -> None:
    """For random truths, in random states."""
    rng = Random("plain")
    variables = (Var("a", "number", -3, 3), Var("c", "truth"), Var("d", "colour", 0, 2))
    pen = Pen(rng, variables, (("mode", 3),))
    for _ in range(400):
        term = ("ite", pen.truth(2), rng.choice((TRUE, FALSE, pen.truth(1))), rng.choice((TRUE, FALSE, pen.truth(3))))
        values = {**{var.name: rng.choice(var.values) for var in variables}, "mode": rng.randrange(3)}
        assert bool(value(term, values)) == bool(value(plain(term), values))


def test_a_run_that_never_ends_is_found() -> None:
    """A counter that has to move ends at its assumption's bound, one that may rest does not; a ring never ends."""
    must: Term = ("and", at_most(1), ("var", "go"))
    assert set() == search(replace(COUNTER, assumption=must)).for_ever(lawful)
    may = search(replace(COUNTER, assumption=at_most(1)))
    assert [0, 1] == sorted(may.states[state]["x"] for state in may.for_ever(lawful))
    ring: Term = ("ite", ("ge", ("var", "x"), ("lit", 3)), ("lit", 0), UP)
    turns = search(replace(COUNTER, rows=(Row("turn", (0,), 0, sets={"x": ring}),)))
    assert 4 == len(turns.for_ever(anyhow))
