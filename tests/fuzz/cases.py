"""Cases by seed and number: a machine, a composition, or either for the back ends. The same number is the same case."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from random import Random

from safeloc.errors import ModelError
from safeloc.proof.provers.limits import Limits
from tests.fuzz import verdicts
from tests.fuzz.backends import all_back_ends
from tests.fuzz.build import Built, build
from tests.fuzz.case import LIMITS, Case
from tests.fuzz.draw import Draw
from tests.fuzz.draw_claims import Claims, inherited
from tests.fuzz.draw_whole import whole
from tests.fuzz.explore import Space, search
from tests.fuzz.judge import Claim
from tests.fuzz.obligations import obligations
from tests.fuzz.tally import TRAPS, Expect, Tally
from tests.fuzz.world import Game, Whole

REFUSABLE = TRAPS - {"inherited over a wire", "initially over ghosts", "range lies"}
ENOUGH, TRIES, MOST = 12, 4, 500  # states; how often a machine is drawn to have as many; and where search ends


@dataclass(frozen=True)
class Plan:
    """What to draw and how much of it to compare.

    traps    those that may be drawn
    claims   how many of each machine
    engines  of every claim, or with `light` one of them in turn; `rarely` those, and the obligations, of one case in `every`
    """

    traps: frozenset[str] = TRAPS
    expect: Expect = Expect()
    claims: int = 2
    engines: tuple[str, ...] = ("k-induction", "bmc", "Spacer")
    rarely: tuple[str, ...] = ("portfolio", "falsifier")
    every: int = 4
    light: bool = False
    limits: Limits = LIMITS
    compile_every: int = 4


def machine(seed: int, number: int, plan: Plan) -> Tally:
    """A machine: base, claims by every engine, obligations."""
    draw = _draw("machine", seed, number, plan)
    return _verdicts(draw, lambda: draw.world(), number, plan, forked=number % (8 * plan.every) == 0)


def composition(seed: int, number: int, plan: Plan) -> Tally:
    """A composition: the same, contracts, and what is inherited."""
    draw = _draw("composition", seed, number, plan)
    return _verdicts(draw, lambda: whole(draw), number, plan, forked=not plan.light or number % 3 == 0)


def back_ends(seed: int, number: int, plan: Plan) -> Tally:
    """A machine or composition up to the ends of 64 bits, by all back ends."""
    traps = plan.traps - {"initially over ghosts", "range lies"}
    draw = Draw(Random(f"back ends {seed} {number}"), traps, wide=True)
    game = whole(draw) if number % 3 == 2 else draw.world()
    tally = Tally()
    built = built_or_refused(game, draw.drawn.traps, tally)
    if built is not None:
        all_back_ends(game, built, draw, tally, compiled_c=number % plan.compile_every == 0)
    return tally


KINDS: dict[str, Callable[[int, int, Plan], Tally]] = {
    "machine": machine,
    "composition": composition,
    "back ends": back_ends,
}


def _draw(kind: str, seed: int, number: int, plan: Plan) -> Draw:
    return Draw(Random(f"{kind} {seed} {number}"), plan.traps)


def built_or_refused(game: Game, traps: Collection[str], tally: Tally) -> Built | None:
    """The declaration; None where it is refused, which is right only where a trap was drawn."""
    try:
        return build(game)
    except ModelError as error:
        right = sorted(REFUSABLE & set(traps))
        if right:
            tally.refused[", ".join(right)] += 1
        else:
            tally.judge("refusal", f"well-formed, yet refused: {error}")
        return None


def _drawn(draw: Draw, make: Callable[[], Game]) -> tuple[Game, Space]:
    """A game, and all its states; a dull one is drawn again."""
    for _ in range(TRIES):
        draw.drawn.traps.clear()
        game = make()
        space = search(game, MOST)
        if len(space.states) >= ENOUGH:
            break
    return game, space


def _verdicts(draw: Draw, make: Callable[[], Game], number: int, plan: Plan, *, forked: bool) -> Tally:
    game, space = _drawn(draw, make)
    tally = Tally()
    built = built_or_refused(game, draw.drawn.traps, tally)
    if built is None:
        return tally
    case = Case(game, built, space, plan.expect, tally, plan.limits)
    turn = number % len(plan.engines)
    if not plan.light or turn == 0:
        verdicts.facts(case)
    claims = Claims(draw, space).some(plan.claims)
    always = plan.engines[turn : turn + 1] if plan.light else plan.engines
    engines = (*always, *(plan.rarely if number % plan.every == 1 else ()))
    for one in claims:
        verdicts.claim(case, one, engines)
    if number % plan.every == 2:
        obligations(case)
    if forked:
        _forked(case, draw, claims)
    return tally


def _forked(case: Case, draw: Draw, claims: list[Claim]) -> None:
    """As a user asks: all together, each in a process of its own."""
    asked = [one for one in claims if one.helper is None][:1]
    if isinstance(case.game, Whole):
        asked += [inherited(draw, case.game, f"inherited {number}") for number in range(2)]
    if asked:
        verdicts.proved_together(case, asked)
