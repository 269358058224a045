"""Proofs of the balise machine that would notice: each guard or added error, once broken, loses a property."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, cached_property
from types import ModuleType

import pytest

from safeloc.language.expr import FALSE, Bool, Expr, Lit, Num, Var, as_num, ite, minimum
from safeloc.language.machine import Machine, Transition
from safeloc.language.nodes import Value
from safeloc.language.rows import Updates
from safeloc.language.spec import observe
from safeloc.language.system import lower
from safeloc.language.terms import Substitution
from safeloc.language.units import COUNT, MM, PPM
from safeloc.language.verdict import Proved, word
from safeloc.models import balise
from safeloc.models.balise import Balise, build
from safeloc.models.balise import variables as v
from safeloc.models.balise.judgement import Judgement
from safeloc.models.balise.telegram import PASSED, Reader
from safeloc.models.balise.variables import BaliseConfig, Parts, parts
from safeloc.models.vocabulary.error_law import EDDY_CURRENT, RADAR, ErrorLaw
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.balise import properties
from tests.models.wrong_edits import lost

Table = Sequence[Transition]
Breaking = Callable[[Balise], Table]


@cache
def model() -> Balise:
    """The default machine."""
    return build(parts(BaliseConfig()))


def rebuilt(machine: Machine, table: Table) -> Machine:
    """The machine with another table and the same variables and environment."""
    return replace(machine, transitions=table)


def proved(machine: Machine, names: Sequence[str]) -> list[str]:
    """Which of the named properties are proved of a (possibly broken) machine."""
    system = lower(machine)
    wanted = [one for one in properties(replace(model(), machine=machine)) if one.name in names]
    assert len(wanted) == len(names)
    limits = Limits(seconds=20, induction=2)
    return [prop.name for prop in wanted if isinstance(kinduction(observe(system, prop), limits), Proved)]


# ------------------------------------------------------------------ ways to break it


def without(name: str) -> Breaking:
    """A transition that never fires."""
    return lambda good: [replace(t, when=FALSE) if t.name == name else t for t in good.machine.transitions]


def taking(*wrong: Callable[[v.Parts], tuple[Expr, Expr]]) -> Breaking:
    """Guards and updates that take a variable for something else."""

    def broken(good: Balise) -> Table:
        pairs = [one(good.own) for one in wrong]
        see = Substitution({var: instead for var, instead in pairs if isinstance(var, Var)})
        return [replace(t, when=see.bool(t.when), set=_seen(see, t.set)) for t in good.machine.transitions]

    return broken


def _seen(see: Substitution, updates: Mapping[Var, Expr | Value]) -> dict[Var, Expr | Value]:
    return {var: see(term) if isinstance(term, (Num, Bool)) else term for var, term in updates.items()}


def accepting(verdict: Num) -> Breaking:
    """A telegram with that verdict resets the position all the same."""

    def broken(good: Balise) -> Table:
        table = []
        for t in good.machine.transitions:
            if t.name == "expected group resets the position":
                wrongly = good.judgement.sightings[0].seen & good.judgement.verdict.eq(verdict)
                table.append(replace(t, when=t.when | wrongly))
            else:
                table.append(t)
        return [t for t in table if not (verdict is v.CONTRADICTED and t.name == "contradiction")]

    return broken


def changed(name: str, updates: Callable[[Balise], Mapping[Var, Expr]]) -> Breaking:
    """One transition with other updates."""

    def broken(good: Balise) -> Table:
        return [replace(t, set={**t.set, **updates(good)}) if t.name == name else t for t in good.machine.transitions]

    return broken


def less_margin(good: Balise) -> Mapping[Var, Expr]:
    """The margin grows by one nanometre a cycle less than the error may."""
    return {good.own.held.above: good.judgement.run_on.above - 1}


def telegram_alone(good: Balise) -> Mapping[Var, Expr]:
    """The telegram replaces the interval instead of narrowing it."""
    return dict(good.own.held.become(good.judgement.fix))


BROKEN: dict[str, tuple[Breaking, tuple[str, ...]]] = {
    "check bits ignored": (
        taking(lambda own: (own.read.check.value, ite(own.heading.backwards, PASSED, PASSED))),
        ("containment", "corrupted changes nothing", "only complete and undamaged groups count"),
    ),
    "identity ignored": (
        taking(lambda own: (own.read.group.value, own.linking.slots[0].group)),
        ("containment", "foreign changes nothing", "only announced groups reset"),
    ),
    "stale telegrams believed": (
        taking(lambda own: (own.read.age.value, minimum(own.read.age.value, 0))),
        ("containment", "stale changes nothing"),
    ),
    "window opened too early": (
        accepting(v.TOO_EARLY),
        ("containment", "of the expected group but outside its window changes nothing"),
    ),
    "window closed too late": (accepting(v.TOO_LATE), ("containment", "rejected telegrams change nothing")),
    "orientation ignored": (
        accepting(v.WRONG_DIRECTION),
        ("containment", "of the expected group but passed the wrong way changes nothing"),
    ),
    "incomplete groups believed": (accepting(v.INCOMPLETE), ("containment", "incomplete changes nothing")),
    "contradiction ignored": (accepting(v.CONTRADICTED), ("containment", "contradiction delocalizes")),
    "contradiction not told": (without("contradiction"), ("contradiction delocalizes",)),
    "telegram instead of the common part": (
        changed("expected group resets the position", telegram_alone),
        ("a reset never widens",),
    ),
    "optimistic margin": (changed("run on", less_margin), ("containment", "margins never shrink")),
    "distance run not counted": (
        changed("run on", lambda good: {good.own.memory.run: good.own.memory.run}),
        ("margin as the audit reckons it",),
    ),
    "tolerance forgotten": (without("tolerance exceeded"), ("tolerance",)),
    "silence forgotten": (without("sensors failed"), ("silence delocalizes",)),
    "linking accuracy ignored": (
        taking(lambda own: (own.linking.slots[0].accurate, FALSE)),
        ("accuracy by precedence",),
    ),
    "national value forgotten": (
        taking(lambda own: (own.national.known, FALSE)),
        ("a national value stays",),
    ),
    "first miss forgotten": (
        taking(lambda own: (own.memory.missed_in_row, minimum(own.memory.missed_in_row, 0))),
        ("two missed brake", "missed groups are counted"),
    ),
    "refused groups not counted": (
        taking(lambda own: (own.memory.refused_in_row, minimum(own.memory.refused_in_row, 0))),
        ("groups that disagree are counted",),
    ),
    "refused groups end nothing": (
        without("announced groups disagree in a row"),
        ("groups that disagree in a row end the position",),
    ),
    "the count of refused groups goes on": (
        changed(
            "expected group resets the position",
            lambda good: {good.own.memory.refused_in_row: good.own.memory.refused_in_row},
        ),
        ("groups that disagree are counted",),
    ),
    "one refused group ends the position": (
        taking(lambda own: (own.memory.refused_in_row, as_num(own.config.refusal_limit_groups, COUNT))),
        ("a contradiction is the reason only with groups that contradict",),
    ),
    "a miss not told": (without("expected group missed"), ("reported: expected group missed",)),
    "detection accuracy taken for none": (
        changed("expected group resets the position", lambda good: sharper(good)),
        ("containment", "a reset interval contains the true position"),
    ),
}


def sharper(good: Balise) -> Mapping[Var, Expr]:
    """A reset that forgets the antenna's detection accuracy."""
    reader = replace(good.own.config.reader, detection_mm=0)
    odometer, cycle = good.own.odometer, good.judgement
    fix = reader.fix(good.own.read, cycle.place, cycle.accuracy, odometer)
    return dict(good.own.held.become(cycle.run_on.narrowed(fix)))


SLOW = ("a miss not told", "first miss forgotten", "contradiction not told", "silence forgotten")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("way", [pytest.param(way, marks=pytest.mark.slow if way in SLOW else ()) for way in BROKEN])
def test_a_broken_machine_is_noticed(way: str) -> None:
    """What is proved of the machine is not proved of the broken one."""
    breaking, names = BROKEN[way]
    broken = rebuilt(model().machine, breaking(model()))
    assert proved(broken, names) == []


@pytest.mark.thorough
def test_what_the_broken_ones_lose_is_proved_of_the_right_one() -> None:
    """The same engine and limits prove each of those properties of the machine as it is."""
    wanted = sorted({name for _, names in BROKEN.values() for name in names})
    assert sorted(proved(model().machine, wanted)) == wanted


VARIANTS = {
    "first group trusted": BaliseConfig(trust_first_group=True),
    "free references": BaliseConfig(free_references=True),
    "four groups announced": BaliseConfig(announced_groups=4),
    "another odometer": BaliseConfig(odometer=EDDY_CURRENT, antenna_mm=0, period_ms=200),
    "radar": BaliseConfig(odometer=RADAR, tolerance_mm=10_000, detection_mm=0),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIANTS)
def test_variant_is_proved(name: str) -> None:
    """RFL-5, RFL-D4: every configuration is proved, not only the default one."""
    made = build(parts(VARIANTS[name]))
    findings = prove(lower(made.machine), properties(made), Limits(seconds=60), jobs=2)
    assert {finding.id: word(finding.result) for finding in findings if word(finding.result) != "proved"} == {}


# ------------------------------------------------------------------ wrong edits of the terms


Group = Callable[[Parts, Judgement], Updates]


def _search_forgotten(right: Group) -> Group:
    def group(own: Parts, cycle: Judgement) -> Updates:
        return {**right(own, cycle), own.search.known: FALSE, own.search.place: as_num(0, MM)}

    return group


def _search_from_the_reflector(right: Group) -> Group:
    def group(own: Parts, cycle: Judgement) -> Updates:
        told, place = own.read.search.present, cycle.place + own.read.reflector.value
        return {**right(own, cycle), own.search.place: ite(told, place, as_num(0, MM))}

    return group


def _wrong_side(right: Callable[[Reader, Num, Num], tuple[Num, Num]]) -> Callable[[Reader, Num, Num], tuple[Num, Num]]:
    return lambda reader, place, accuracy: right(reader, place - 2 * reader.antenna_mm, accuracy)


def _without_detection(
    right: Callable[[Reader, Num, Num], tuple[Num, Num]],
) -> Callable[[Reader, Num, Num], tuple[Num, Num]]:
    return lambda reader, place, accuracy: right(reader, place, accuracy - reader.detection_mm)


def _early_is_incomplete(right: cached_property[Num]) -> property:
    def verdict(cycle: Judgement) -> Num:
        judged = right.func(cycle)
        return ite(judged.eq(v.TOO_EARLY), v.INCOMPLETE, judged)

    return property(verdict)


def _beyond_always(_: object) -> property:
    return property(lambda cycle: v.ALONG)


def _never_told(_: object) -> property:
    return property(lambda cycle: cycle.own.memory.direction)


def _by_any_second_group(_: object) -> property:
    def direction(cycle: Judgement) -> Num:
        return ite(cycle.own.memory.group.ne(0), v.ALONG, cycle.own.memory.direction)

    return property(direction)


def _without_floor(_: object) -> Callable[[ErrorLaw, Num, Num, int], Num]:
    return lambda law, distance, age, period_ms: distance * Lit(law.rate_ppm, PPM)


TOLD = "the telegram's search distance is reported"
AT_ITS_PLACE = "a group at its place is neither out of its window nor a contradiction"
COUNTED = "groups that disagree are counted"
IN_A_ROW = "groups that disagree in a row end the position"
DIRECTION = "only balise groups set the reported direction"
EDITS: dict[str, tuple[type | ModuleType, str, Callable[..., object], str]] = {
    "search distance ignored": (balise, "_group_counts", _search_forgotten, TOLD),
    "search from where the reflector is": (balise, "_group_counts", _search_from_the_reflector, TOLD),
    "antenna on the wrong side of the window": (Reader, "window", _wrong_side, "no window closes early"),
    "and the group is not found in it": (Reader, "window", _wrong_side, "the expected group counts"),
    "nor is it in order to take it": (Reader, "window", _wrong_side, "only announced groups reset"),
    "window without the detection accuracy": (Reader, "window", _without_detection, "no window closes early"),
    "window without the detection accuracy refuses a right group": (Reader, "window", _without_detection, AT_ITS_PLACE),
    "antenna on the wrong side refuses a right group": (Reader, "window", _wrong_side, AT_ITS_PLACE),
    "refusals counted by misses": (Judgement, "disagrees", lambda _: property(lambda cycle: cycle.missed), IN_A_ROW),
    "a group out of its window is taken for incomplete": (Judgement, "_of_announced", _early_is_incomplete, COUNTED),
    "direction told by any group": (Judgement, "direction", _beyond_always, DIRECTION),
    "direction never told": (Judgement, "direction", _never_told, DIRECTION),
    "direction by any second group": (Judgement, "direction", _by_any_second_group, DIRECTION),
    "what was told is never forgotten": (v.Ahead, "lies_ahead", lambda _: lambda told, passed: told.known, TOLD),
}


QUICK = ("search distance ignored",)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "edit", [pytest.param(edit, marks=() if edit in QUICK else pytest.mark.slow) for edit in EDITS]
)
def test_a_wrong_edit_of_a_term_is_noticed(edit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """RFL-9, RFL-D4: windows, directions and distances are claimed in figures of their own."""
    where, name, wrong, broken = EDITS[edit]
    monkeypatch.setattr(where, name, wrong(getattr(where, name)))
    made = build(parts(BaliseConfig()))
    assert lost(made.machine, properties(made), broken)


@pytest.mark.thorough
def test_a_floor_that_is_not_added_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """MRK-4: of a unit that errs with time, what the law adds in every cycle is added."""
    monkeypatch.setattr(ErrorLaw, "growth_nm", _without_floor(None))
    made = build(parts(VARIANTS["radar"]))
    assert lost(made.machine, properties(made), "rejected telegrams change nothing")
