"""What is told of the cases that claims speak of, against the explicit search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from safeloc.proof.provers.antecedents import Never, Open, Outcome, Seen
from tests.fuzz.case import Case
from tests.fuzz.explore import occurs, search
from tests.fuzz.judge import Claim
from tests.fuzz.speaks import cases, plain
from tests.fuzz.terms import TRUE, Term, below, rewritten
from tests.fuzz.world import Whole, World


def of_cases(case: Case, one: Claim, told: Sequence[Outcome]) -> None:
    """Whether each case occurs, as it is told; and whether all cases are told of."""
    own = cases(one)
    if len(own) != len(told):
        case.tally.judge("case", f"{len(told)} cases are told of, where there are {own}; {one}")
        return
    for number, outcome in enumerate(told):
        wrong = _wrong(case, one, number, outcome)
        if isinstance(outcome, Open) and not wrong:
            case.tally.open("case")
        else:
            case.tally.judge("case", wrong and f"{wrong}: {own[number]}, {outcome}; {one}")


def silent(case: Case, one: Claim, told: Sequence[Outcome]) -> bool:
    """Whether a case of the claim never occurs, and is told neither to be open nor to occur in its machine by itself."""
    never = [number for number, term in enumerate(cases(one)) if occurs(case.spoken_of(one), one, term) is False]
    return not all(number < len(told) and _excused(told[number]) for number in never)


def _excused(outcome: Outcome) -> bool:
    return isinstance(outcome, Open) or (isinstance(outcome, Seen) and "by itself" in outcome.where)


def _wrong(case: Case, one: Claim, number: int, outcome: Outcome) -> str:
    """What is wrong with what is told of a case; empty if nothing."""
    comes = occurs(case.spoken_of(one), one, cases(one)[number])
    match outcome:
        case Open(reason):
            return reason if reason == "nobody looked" else ""
        case Never():
            return "never, yet it occurs" if comes else ""
        case Seen(where) if "by itself" in where:
            return "" if _alone(case, one, number, where) else "its machine by itself does not come there"
        case Seen():
            return "it occurs, yet no run comes there" if comes is False else ""


def _alone(case: Case, one: Claim, number: int, where: str) -> bool:
    """Whether the machine that is told of may come there by itself: as its own claim has it, or by what the case reads."""
    if not isinstance(case.game, Whole):
        return False
    world = next(world for world in case.game.worlds if where == f"of {world.name} by itself, none of the whole")
    own = _own_claim(case.game, world, one, number) if one.of == world.name else None
    own = own or _about(case.game, world, one, cases(one)[number])
    return own is not None and _comes(world, *own)


def _comes(world: World, own: Claim, term: Term) -> bool:
    space = search(world.untied() if own.unconditional else world)
    return occurs(space, own, term) is not False


def _own_claim(whole: Whole, world: World, one: Claim, number: int) -> tuple[Claim, Term] | None:
    """The machine's own claim and the same case of it; None where wires have settled one, or made another."""
    own = replace(one, term=one.own, own=TRUE, of="")
    mine = cases(own)
    same = number < len(mine) and plain(whole.told(world, mine[number])) == cases(one)[number]
    return (own, mine[number]) if same else None


def _about(whole: Whole, world: World, one: Claim, term: Term) -> tuple[Claim, Term] | None:
    """A case that reads one machine only, over that machine's own names."""
    names = [*world.state_names, *(name for var in world.own_inputs for name in var.names), "fired"]
    back = {whole.called(world, name): name for name in names}
    if one.further_assumption != TRUE or any(leaf[1] not in back for leaf in below(term) if leaf[0] in ("var", "was")):
        return None
    mine = rewritten(term, lambda leaf: (leaf[0], back[leaf[1]]))
    return Claim("case", "always", ("not", mine), unconditional=one.unconditional), mine
