"""Every disagreement that the fuzzer has found, as a machine of its own. A refusal is right where a trap was set.

What is not mended yet is expected to fail, strictly: whoever mends it takes its trap out of tests.fuzz.expect.OPEN.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from random import Random

import pytest

from safeloc.language.antecedents import antecedents
from tests.fuzz import verdicts
from tests.fuzz.backends import all_back_ends
from tests.fuzz.build import build, read
from tests.fuzz.case import Case
from tests.fuzz.cases import KINDS, Plan, built_or_refused
from tests.fuzz.draw import Draw
from tests.fuzz.draw_terms import Pen
from tests.fuzz.expect import NOW, OPEN
from tests.fuzz.explore import anyhow, search
from tests.fuzz.judge import WAITING, Claim
from tests.fuzz.obligations import obligations
from tests.fuzz.speaks import cases
from tests.fuzz.tally import Tally
from tests.fuzz.terms import Term, fast
from tests.fuzz.world import Game, Row, Var, Whole, World

Look = Callable[[Case], None]
HOW_MANY, GO = Var("i", "number", 0, 2), Var("go", "truth")
X, Y, G = Var("x", "number", 0, 3), Var("y", "number", 0, 3), Var("g", "number", 0, 3)


def known(trap: str) -> pytest.MarkDecorator | list[pytest.MarkDecorator]:
    """Expected to fail while it is open."""
    return [pytest.mark.xfail(reason=f"not mended: {trap}", strict=True)] if trap in OPEN else []


def found(game: Game, trap: str, look: Look) -> list[str]:
    """What disagrees about a game in which a trap is set."""
    tally = Tally()
    built = built_or_refused(game, {trap}, tally)
    if built is not None:
        look(Case(game, built, search(game), NOW, tally))
    return tally.wrong


def by(*engines: str, one: Claim) -> Look:
    """A claim by these engines."""
    return lambda case: verdicts.claim(case, one, engines)


def by_all_back_ends(case: Case) -> None:
    """Every back end but C."""
    all_back_ends(case.game, case.built, Draw(Random("found")), case.tally, compiled_c=False)


def at_most(name: str, number: int) -> Term:
    """name <= number."""
    return ("le", ("var", name), ("lit", number))


def at_least(name: str, number: int) -> Term:
    """name >= number."""
    return ("ge", ("var", name), ("lit", number))


def copies(name: str, var: Var, heard: Var, **more: object) -> World:
    """A machine that keeps what it hears."""
    return World(name, 1, (heard,), {var: 0}, {"told": ("var", var.name)}, (_copy(var, heard),), **more)  # type: ignore[arg-type]


def _copy(var: Var, heard: Var) -> Row:
    return Row("copy", (0,), 0, sets={var.name: ("var", heard.name)})


def is_(name: str, number: int) -> Term:
    """name == number."""
    return ("eq", ("var", name), ("lit", number))


TWICE = World(
    "m",
    3,
    (HOW_MANY,),
    rows=(Row("ab", (0,), 1, is_("i", 0)), Row("bc", (1,), 2, is_("i", 1)), Row("release", (0, 1, 1), 0, is_("i", 2))),
)
STAYS = Claim("C is for ever", "always", ("implies", ("among", ("was", "mode"), 2), ("among", ("var", "mode"), 2)))

TRUTH = World(
    "m",
    1,
    (GO,),
    {X: None},
    rows=(
        Row(
            "up",
            (0,),
            0,
            ("and", ("var", "go"), ("gt", ("var", "x"), ("lit", 0))),
            {"x": ("add", ("var", "x"), ("lit", 2))},
        ),
    ),
    ghosts={G: 0},
    ghost_moves={"g": ("var", "g")},
    initially=(("eq", ("var", "x"), ("var", "g")),),
    lemmas={"x is 0": is_("x", 0)},
)

ARMED = World(
    "m",
    1,
    (HOW_MANY,),
    {Var("armed", "truth"): False},
    rows=(Row("arm", (0,), 0, ("gt", ("var", "i"), ("lit", 0)), {"armed": ("true",)}),),
)
HEARD: Term = ("ge", ("var", "i"), ("lit", 1))
ANSWERED = Claim(
    "answered",
    "within",
    ("and", HEARD, ("not", ("was", "armed"))),
    ("and", HEARD, ("was", "armed")),
    1,
    helper=("implies", ("var", WAITING), ("and", ("var", "armed"), HEARD)),
)

RESTS = World("a", 1, (GO,), ghosts={G: 0}, ghost_moves={"g": ("var", "g")})
PUSHED = World("a", 1, (GO,), ghosts={Y: 0}, ghost_inputs=(G,), ghost_moves={"y": ("var", "g")})
ROLES = Whole("w", (RESTS, copies("b", X, G)), shared=frozenset({"g"}))
TOLD = Whole("w", (PUSHED, copies("b", X, G)), shared=frozenset({"g"}))
TRUE_TOLD = Whole("w", (PUSHED, copies("b", X, HOW_MANY)), {"b.i": ("var", "a.y")})

OPT = Var("o", "number", 0, 3, optional=True)
READS_O = Row("s", (0,), 0, ("var", "o.present"), {"x": ("var", "o")})
BOTH_READ = Whole("w", tuple(World(name, 1, (OPT,), {X: 0}, rows=(READS_O,)) for name in "ab"), shared=frozenset({"o"}))

Q = Var("q", "number", 0, 3)
AT_LEAST_ONE: Term = ("ge", ("var", "q"), ("lit", 1))
FIRST = copies("a", X, Var("j", "number", 1, 3))
THEN = copies("b", Y, Q, assumption=AT_LEAST_ONE)
WIRED = Whole("w", (FIRST, THEN), {"b.q": ("var", "a.x")}, discharge=("b",))
INHERITED = Claim("q is at least 1", "always", ("ge", ("var", "a.x"), ("lit", 1)), of="b", own=AT_LEAST_ONE)

ROUND = World(
    "m",
    2,
    (GO, HOW_MANY),
    {X: 0, Var("t", "truth"): False},
    rows=(
        Row("up", (0,), 1, ("var", "go"), {"t": ("not", ("var", "t"))}),
        Row("down", (1,), 0, sets={"x": ("var", "i")}),
    ),
)
HEARS = replace(ROUND, name="b", inputs=(*ROUND.inputs, Q))
CONSTANT = Whole("w", (RESTS, HEARS), {"b.q": ("lit", 2), "b.go": ("gt", ("lit", 1), ("lit", 0))})
NONE: Term = ("and", ("var", "go"), ("not", ("var", "go")))
LEAVES = World(
    "m", 1, (GO,), {X: 0}, rows=(Row("leave", (0,), 0, ("var", "go"), {"x": ("lit", 3)}),), assumption=at_most("x", 2)
)
SILENT = Whole("w", (World("a", 1, (GO,), {X: 0}, assumption=NONE), copies("b", Y, Q)))
NEXT: Term = ("ite", at_most("x", 1), ("add", ("var", "x"), ("lit", 2)), ("sub", ("var", "x"), ("lit", 2)))
EVEN = World(
    "a", 1, (GO,), {X: 0}, rows=(Row("turn", (0,), 0, sets={"x": NEXT}),)
)  # 0, 2, 0: never 1, which 3 would lead to
ODD = World("b", 2, (Q,), rows=(Row("raise", (0,), 1, is_("q", 1)),))
NEVER_ODD = Whole("w", (EVEN, ODD), {"b.q": ("var", "a.x")})
KEEPS = World("b", 1, (Q,), {Y: 3}, rows=(Row("keep", (0,), 0),))
TWO_TOLD = Whole("w", (EVEN, KEEPS), {"b.q": ("lit", 2)})
TURNS = World(
    "b", 2, (Q,), {X: 0}, rows=(Row("raise", (0,), 1, is_("x", 1)), Row("turn", (0,), 0, sets={"x": NEXT}, rank=1))
)
NEVER_RAISED = Whole("w", (RESTS, TURNS), {"b.q": ("lit", 2)})


def kept(whole: Whole, own: Term) -> Claim:
    """What the second machine keeps by itself, as a claim about the whole."""
    world = whole.worlds[1]
    return Claim("kept", "always", whole.told(world, own), of=world.name, own=own)


def together(*claims: Claim) -> Look:
    """Claims as `prove` decides them."""
    return lambda case: verdicts.proved_together(case, claims)


FOUND: dict[str, tuple[Game, str, Look]] = {
    "d01: a helper reads an input": (ARMED, "helper reads inputs", by("k-induction", one=ANSWERED)),
    "d03: a ghost is another machine's input": (
        ROLES,
        "ghost shared with an input",
        by("k-induction", "Spacer", one=Claim("c", "always", is_("b.x", 0))),
    ),
    "d04: it starts where the truth is": (TRUTH, "initially over ghosts", lambda case: void(verdicts.facts(case))),
    "d08: a source is named twice": (TWICE, "source named twice", by("k-induction", "bmc", one=STAYS)),
    "d24: an optional input is shared": (BOTH_READ, "optional shared", by_all_back_ends),
    "d27: a ghost input is shared with an input": (TOLD, "ghost input shared with an input", by_all_back_ends),
    "d28: a wire tells the truth": (TRUE_TOLD, "wire reads a ghost", by_all_back_ends),
    "d29: inherited, and false in the first state": (
        WIRED,
        "inherited over a wire",
        lambda case: verdicts.proved_together(case, [INHERITED]),
    ),
    "an assumption lasts that one run only ends": (LEAVES, "", obligations),
    "no run at all keeps the assumption": (SILENT, "", obligations),
    "a disjunction speaks of the failing of its first part": (
        NEVER_ODD,
        "",
        together(
            Claim("c", "always", ("or", at_most("a.x", 3), ("var", "a.go"))),
            Claim("d", "always", ("or", ("var", "a.go"), at_most("a.x", 3))),
            Claim(
                "e",
                "always",
                ("or", at_most("a.x", 3), ("var", "a.go")),
                of="a",
                own=("or", at_most("x", 3), ("var", "go")),
            ),
        ),
    ),
    "no step is lawful, and a claim speaks of no case": (
        SILENT,
        "",
        together(
            Claim("c", "always", at_most("a.x", 3)),
            Claim("d", "always", ("implies", ("var", "a.go"), at_most("a.x", 3))),
            Claim("e", "always", at_most("a.x", 0), of="a", own=at_most("x", 0)),
        ),
    ),
    "a case occurs in its machine by itself": (
        NEVER_ODD,
        "",
        together(
            Claim(
                "c",
                "always",
                ("implies", ("among", ("was", "b.mode"), 1), ("among", ("var", "b.mode"), 1)),
                of="b",
                own=("implies", ("among", ("was", "mode"), 1), ("among", ("var", "mode"), 1)),
            ),
        ),
    ),
    "a row fires in its machine by itself, in no run of the whole": (NEVER_ODD, "", obligations),
    "a wired constant makes an implication of a choice": (
        TWO_TOLD,
        "",
        together(kept(TWO_TOLD, ("ite", at_least("y", 3), at_least("q", 1), at_most("y", 1)))),
    ),
    "a wired constant makes a plain claim of a disjunction": (
        TWO_TOLD,
        "",
        together(kept(TWO_TOLD, ("or", at_least("y", 3), at_least("q", 3)))),
    ),
    "a wired constant settles one case and makes another": (
        NEVER_RAISED,
        "",
        together(
            kept(
                NEVER_RAISED,
                (
                    "and",
                    ("ite", ("among", ("var", "mode"), 0), at_least("q", 1), at_most("x", 0)),
                    ("implies", ("among", ("var", "mode"), 0), at_least("q", 1)),
                ),
            )
        ),
    ),
}


def void(_: object) -> None:
    """What is looked at only for what it leaves in the tally."""


def test_product_and_oracle_speak_of_the_same_cases() -> None:
    """As many of them, each of which means the same, for random claims: the rule is stated twice."""
    rng, count = Random("cases"), 0
    variables = (*ROUND.inputs, *ROUND.state)
    pen, built = Pen(rng, variables, (("mode", 2),)), build(ROUND)
    space = search(ROUND)
    for number in range(150):
        one = Claim(f"c{number}", "always", ("and", pen.truth(2), ("implies", pen.truth(1), pen.truth(2))))
        told, own = antecedents(built.prop(one)), cases(one)
        assert len(told) == len(own), one
        count += len(own)
        for theirs, ours in zip(map(read, told), own, strict=True):
            assert all(fast(theirs)(edge.known) == fast(ours)(edge.known) for _, edge in space.steps(anyhow)), one
    assert count > 150


def test_they_do_so_where_wires_tell_constants() -> None:
    """Of what a machine keeps by itself: what the constants decide is left out by both, and nothing else."""
    rng, made = Random("wired"), set[str]()
    pen = Pen(rng, (*HEARS.inputs, *HEARS.state), (("mode", 2),))
    built, space = build(CONSTANT), search(CONSTANT)
    for _ in range(400):
        one = kept(CONSTANT, ("and", pen.truth(2), ("implies", pen.truth(1), pen.truth(2))))
        told, own = antecedents(built.prop(one)), cases(one)
        assert len(told) == len(own), one
        before = cases(replace(one, term=one.own))
        made.add("fewer" if len(own) < len(before) else "more" if len(own) > len(before) else "as many")
        for theirs, ours in zip(map(read, told), own, strict=True):
            assert all(fast(theirs)(edge.known) == fast(ours)(edge.known) for _, edge in space.steps(anyhow)), one
    assert {"fewer", "more", "as many"} == made


def test_a_wide_range_is_never_listed() -> None:
    """A ghost that is another machine's input, over all numbers of 64 bits, begins with the least of them."""
    assert [] == KINDS["back ends"](1, 89, Plan(expect=NOW)).wrong


@pytest.mark.parametrize("name", [pytest.param(name, marks=known(FOUND[name][1])) for name in FOUND])
def test_found(name: str) -> None:
    """It is refused, or nothing disagrees about it any more."""
    assert [] == found(*FOUND[name])
