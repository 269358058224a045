"""Properties of a train and its line area together, from backscatter to virtual sections (FVA-1 to FVA-18, FWG-7).

A property proved of a machine alone for all inputs in range holds in the step as well, since `wires are in range` is proved
here. A property proved of it alone under an assumption on an earlier machine (an interval that contains the truth, a report
that is true) is proved here again, without that assumption: the earlier machine guarantees it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.checks.machine import input_variables
from safeloc.language.expr import Bool, BoolVar, Num, all_of, any_of, as_num, between, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, reachable
from safeloc.language.system import in_range
from safeloc.language.terms import Substitution
from safeloc.language.units import COUNT, NM, UM
from safeloc.models.area import left_law, report_law
from safeloc.models.area.slot import ACCEPTED
from safeloc.models.fibre import Fibre
from safeloc.models.fibre_area import FibreArea, ends
from safeloc.models.sections import Sections
from safeloc.models.verification.variables import NOBODY
from safeloc.models.verification.world import place_law
from safeloc.properties import sections as sections_properties
from safeloc.properties.fibre_area.counted import counted
from safeloc.properties.fibre_area.told import told
from safeloc.properties.fibre_area.unannounced import unannounced

LAW = (
    "the fibre's bounds and code law at both ends; count and length reported for a pattern are that pattern's, "
    "the count at some moment within its run; a train with all axles counted is whole and no longer than its "
    "reference, may lose vehicles at the trailing end at any moment, and these stay there; undisturbed counters "
    "count every vehicle; top speed; no vehicle passes another; reports of other trains are true"
)
CLAIM = ("FVA-1", "FVA-10", "FWG-1", "FWG-11")
STAY = ("FVA-2", "FVA-11")
COUNTS = ("FVA-3", "FVA-12", "FVA-D1", "FWG-9", "FWG-10")
ERROR = ("FWG-7", "FVA-6", "FVA-15")
EMITTER = ("FVA-8", "FVA-17")
CLEAR = ("FVA-9", "FVA-18")
for_all_inputs = partial(always, requirements=CLAIM, unconditional=True)
under_assumption = partial(always, requirements=CLAIM, assumption=LAW)


def properties(model: FibreArea) -> list[Property]:
    """Return the properties: containment through all machines, withdrawal in the same step, and no section cleared without verification."""
    makers = (
        _truth, _guaranteed, _bounded, _withdrawal, _latched_error, _latch, _narrowed, _grows, _reached, told, counted, unannounced, _of_sections,
    )  # fmt: skip
    return [prop for maker in makers for prop in maker(model)]


def _trusted(model: FibreArea) -> Bool:
    return model.composition.of(model.verification.machine).bool(model.verification.machine.flag("trusted"))


def _reports(model: FibreArea) -> Bool:
    return model.composition.of(model.report.machine).bool(model.report.machine.flag("reported"))


def _error(model: FibreArea, end: str) -> Bool:
    fibre = model.front if end == "front" else model.rear
    return model.composition.of(fibre.machine).bool(fibre.machine.flag("error"))


# ------------------------------------------------------------------ the truth, from machine to machine


def _truth(model: FibreArea) -> Iterator[Property]:
    """Claim that the reported position and the reported ends contain the truth."""
    of, verified = model.composition.of, model.verification
    front, rear = (of(one.machine).num(one.own.ghosts.truth) for one in (model.front, model.rear))
    seen, report = of(verified.machine), model.report
    low, high = (
        verified.machine.output("position_mm") + sign * verified.machine.output(f"{side}_mm")
        for sign, side in ((-1, "margin_below"), (1, "margin_above"))
    )
    yield under_assumption(
        "containment",
        _trusted(model).implies(between(seen.num(exact_to(low, NM)), front, seen.num(exact_to(high, NM)))),
        statement="the reported position contains the front of the train that the fibre follows",
    )
    of_report = of(report.machine)
    low, high = of_report.num(report.own.reported_low), of_report.num(report.own.reported_high)
    yield under_assumption(
        "the pattern lies between its ends",
        _reports(model).implies((exact_to(low, NM) <= rear) & (front <= exact_to(high, NM))),
        statement="from min safe rear to max safe front, the report to the area contains both ends of the pattern",
        requirements=(*CLAIM, *CLEAR),
    )


def _guaranteed(model: FibreArea) -> Iterator[Property]:
    """Claim that earlier machines guarantee the assumptions of later ones."""
    of, verified = model.composition.of, model.verification
    seen = of(verified.machine)
    yield under_assumption(
        "the area reads a true report",
        _report_law(model),
        statement="the machines before the area guarantee its assumption on a train's report",
        requirements=CLEAR,
    )
    yield under_assumption(
        "a train that is counted out has left with all its axles",
        _left_law(model),
        statement="the machines before the area guarantee its assumption on a train that is counted out: neither the train "
        "nor a part that it lost is in the area",
        requirements=(*STAY, *CLEAR),
    )
    yield under_assumption(
        "the verification reads a true interval",
        seen.bool(place_law(verified.own)),
        statement="the fibre machines guarantee the verification's assumption on the front's interval",
    )


def _bounded(model: FibreArea) -> Iterator[Property]:
    """Claim the ranges of wires and of the interval."""
    of, verified = model.composition.of, model.verification
    seen = of(verified.machine)
    yield for_all_inputs(
        "wires are in range",
        _wired_in_range(model),
        statement="every value on a wire lies in the range of the input: nothing is clipped",
    )
    tolerance = model.config.fibre.tolerance_mm + 4 * model.config.fibre.max_cycle_distance_mm
    above, below = (seen.num(verified.machine.output(f"{side}_mm")) for side in ("margin_above", "margin_below"))
    yield for_all_inputs(
        "tolerance",
        _trusted(model).implies((above <= tolerance) & (below <= tolerance)),
        statement="a reported position is never wider than the tolerable error and the run of an edge's cycle",
    )


def _report_law(model: FibreArea) -> Bool:
    """Return the law of a report, for a train that was in the area before the step."""
    slot, of = model.area.own.slots[0], model.composition.of(model.area.machine)
    there = of(slot.there)
    assert isinstance(there, BoolVar)
    return Substitution({there: earlier_bool(there)}).bool(of.bool(report_law(slot)))


def _left_law(model: FibreArea) -> Bool:
    """Return the law of leaving, for a train that was in the area before the step."""
    slot, of = model.area.own.slots[0], model.composition.of(model.area.machine)
    there = of(slot.there)
    assert isinstance(there, BoolVar)
    return Substitution({there: earlier_bool(there)}).bool(of.bool(left_law(model.area.own, slot)))


def _wired_in_range(model: FibreArea) -> Bool:
    """Return the condition that all wired inputs on board are in range."""
    free, terms = set(model.composition.system.inputs), []
    for machine in model.composition.system.machines:
        of = model.composition.of(machine)
        terms += [of.bool(in_range([var])) for var in input_variables(machine) if of(var) not in free]
    return all_of(terms)


# ------------------------------------------------------------------ withdrawal in the same step


def _withdrawal(model: FibreArea) -> Iterator[Property]:
    not_accepted = _of_slot(model).bool(model.area.own.slots[0].last_verdict.ne(ACCEPTED))
    nothing = ~_trusted(model) & ~_reports(model) & not_accepted
    for name, (wrong, what, trace) in _wrong(model).items():
        yield for_all_inputs(
            f"{name} withholds",
            wrong.implies(nothing),
            statement=f"{what} withholds the position, and keeps the train's report from the sections, in the same cycle",
            requirements=trace,
        )


def _of_slot(model: FibreArea) -> Substitution:
    return model.composition.of(model.area.machine)


def _wrong(model: FibreArea) -> dict[str, tuple[Bool, str, tuple[str, ...]]]:
    """Return every mismatch and every lack of data, in words."""
    wrong = {**_wrong_ends(model), **_wrong_train(model)}
    if model.verification.own.config.needs_emitter:
        emitter, of = model.emitter.machine, model.composition.of(model.emitter.machine)
        tested, failed = (of.bool(emitter.flag(name)) for name in ("chain_tested", "failed"))
        chain = "a test pattern that failed, or has not come yet"
        wrong["a chain that failed"] = (failed | ~tested, chain, EMITTER)
    return wrong


def _located(model: FibreArea, fibre: Fibre) -> Bool:
    return model.composition.of(fibre.machine).bool(fibre.machine.flag("valid"))


def _wrong_ends(model: FibreArea) -> dict[str, tuple[Bool, str, tuple[str, ...]]]:
    front, rear = _located(model, model.front), _located(model, model.rear)
    return {
        "error F of the front": (_error(model, "front"), "F of the front's machine", ERROR),
        "error F of the rear": (_error(model, "rear"), "F of the rear's machine", ERROR),
        "a front not located": (~front, "a front that is not located", CLAIM),
        "a rear not located": (~rear, "a rear that is not located", CLAIM),
    }


def _wrong_train(model: FibreArea) -> dict[str, tuple[Bool, str, tuple[str, ...]]]:
    of, verified, entry = model.composition.of, model.verification.own, model.entry
    seen, told = of(model.verification.machine), verified.associated & verified.fibre_axles.present
    located = _located(model, model.front) & _located(model, model.rear)
    return {
        "another count": (
            seen.bool(told & verified.fibre_axles.value.ne(verified.stored_axles)),
            "a count other than the entry record's: a split train, another train, or a miscount",
            COUNTS,
        ),
        "ends apart": (
            located & _apart(model),
            "a distance between front and rear that the entry record does not allow",
            COUNTS,
        ),
        "a lost reference": (
            of(entry.machine).bool(entry.machine.fired("reference overdue")),
            "a record or handover that did not come in time",
            ("FVA-D1", *STAY),
        ),
        "a train that left": (of(entry.machine).bool(entry.own.left), "a train that was counted out", STAY),
        "no pattern": (seen.bool(~verified.associated), "a pattern that belongs to no known train", STAY),
        "another number of patterns": (
            _patterns(model).ne(_trains(model)),
            "another number of patterns than of trains that were counted in",
            STAY,
        ),
        "disturbed counters": (_disturbed(model), "axle counters that do not count", ("FVA-4", "FVA-13", *STAY)),
    }


def _patterns(model: FibreArea) -> Num:
    """Return the number of patterns that the fibre sees in the area."""
    return model.composition.of(model.order.machine).num(model.order.own.patterns)


def _trains(model: FibreArea) -> Num:
    """Return the number of trains in the area, by the known order."""
    of, total = model.composition.of(model.order.machine), as_num(0, COUNT)
    for rank in model.order.own.order:
        total = total + ite(of.num(rank).ne(0), as_num(1, COUNT), 0)
    return total


def _disturbed(model: FibreArea) -> Bool:
    """Return the condition that a head is at fault, or the section is neither clear nor occupied by counted axles."""
    own, machine = model.axle_section.own, model.axle_section.machine
    of = model.composition.of(machine)
    return of.bool(own.fault) | ~of.num(machine.mode).one_of(*machine.modes[1:3])


def _apart(model: FibreArea) -> Bool:
    """Return the condition that the distance of the ends' bounds fits no length of the record."""
    own, seen = model.verification.own, model.composition.of(model.verification.machine)
    (front_low, front_high), (rear_low, rear_high) = _bounds(model, model.front), _bounds(model, model.rear)
    low, high = seen.num(own.stored_length_low), seen.num(own.stored_length_high)
    tolerance = own.config.length_tolerance_mm
    return (front_low - rear_high > high + tolerance) | (front_high - rear_low < low - tolerance)


def _bounds(model: FibreArea, fibre: Fibre) -> tuple[Num, Num]:
    of = model.composition.of(fibre.machine)
    low, high = ends(fibre)
    return of.num(low), of.num(high)


# ------------------------------------------------------------------ latched and revoked


def _latched_error(model: FibreArea) -> Iterator[Property]:
    """Claim that F makes the train untrusted."""
    verified, seen = model.verification, model.composition.of(model.verification.machine)
    _, withheld, trusted, untrusted = verified.machine.modes
    mode = seen.num(verified.machine.mode)
    was_known = earlier_bool(seen.bool(verified.machine.mode.one_of(withheld, trusted)))
    leaves = _leaves(model)
    for end in ("front", "rear"):
        yield for_all_inputs(
            f"error F of the {end} is latched",
            (was_known & _error(model, end) & ~leaves).implies(mode.eq(untrusted)),
            statement=f"F of the {end}, with a reference stored, makes the train untrusted until another accepted record",
            requirements=ERROR,
        )


def _latch(model: FibreArea) -> Iterator[Property]:
    """Claim the end of distrust, and the revocation of a reported position."""
    verified, seen = model.verification, model.composition.of(model.verification.machine)
    none, _, _, untrusted = verified.machine.modes
    mode = seen.num(verified.machine.mode)
    due, leaves = model.composition.of(model.entry.machine).bool(model.entry.own.due), _leaves(model)
    was_untrusted = earlier_bool(seen.bool(verified.machine.mode.eq(untrusted)))
    yield for_all_inputs(
        "a mismatch is latched",
        (was_untrusted & mode.ne(untrusted)).implies(leaves | (due & seen.bool(verified.own.sound))),
        statement="an untrusted train changes its state only by a sound record in its own cycle, by leaving, or because another one comes in in its place",
        requirements=(*CLAIM, *STAY),
    )
    given = earlier_bool(_trusted(model))
    yield for_all_inputs(
        "a reported position is revoked",
        (given & mode.eq(untrusted)).implies(seen.bool(verified.machine.flag("revoked"))),
        statement="a position that was reported is revoked in the cycle in which the train becomes untrusted",
        requirements=(*CLAIM, *ERROR),
    )
    yield for_all_inputs(
        "no train without a reference",
        (earlier_bool(seen.bool(verified.machine.mode.eq(none))) & mode.ne(none)).implies(due),
        statement="no verification begins before a reference came for this train",
        requirements=(*CLAIM, *STAY),
    )


def _leaves(model: FibreArea) -> Bool:
    """The train has left, or one comes in without a record: what was known of this number is forgotten."""
    of, own = model.composition.of(model.entry.machine), model.entry.own
    comes_in = any_of(of.num(one).eq(1) for one in own.enters) & of.num(own.comes).eq(NOBODY)
    return of.bool(own.left) | comes_in


# ------------------------------------------------------------------ sections


def _narrowed(model: FibreArea) -> Iterator[Property]:
    """Claim the conditions under which the train's interval becomes narrower."""
    slot, of = model.area.own.slots[0], _of_slot(model)
    accepted, integer = of.bool(slot.last_verdict.eq(ACCEPTED)), of.bool(slot.integer)
    age, limit = of.num(slot.age), model.config.sections.area.report_age_limit_ms
    verified, seen = model.verification.own, model.composition.of(model.verification.machine)
    counted = seen.bool(verified.associated & verified.fibre_axles.present)
    yield for_all_inputs(
        "only a trusted train narrows",
        accepted.implies(_trusted(model) & _reports(model) & (age <= limit)),
        statement="the area narrows the train's interval only on a report that is trusted and fresh in that very cycle",
        requirements=CLEAR,
    )
    yield for_all_inputs(
        "only an axle count confirms integrity",
        (integer & _reports(model)).implies(counted & seen.bool(verified.fibre_axles.value.eq(verified.stored_axles))),
        statement="a train counts as whole only in a cycle in which as many axles were counted as at its entry",
        requirements=(*COUNTS, *CLEAR),
    )
    yield from _added_error(model)
    yield from _parted(model)


def _grows(model: FibreArea) -> Iterator[Property]:
    slot, of = model.area.own.slots[0], _of_slot(model)
    low, high = of.num(slot.low), of.num(slot.high)
    present, edge = of.bool(slot.present), model.config.sections.area.limit_mm
    stays = earlier_bool(present) & present & ~of.bool(slot.enters) & ~_trusted(model)
    yield for_all_inputs(
        "an untrusted train only grows",
        stays.implies(((low <= earlier_num(low)) | low.eq(-edge)) & ((high >= earlier_num(high)) | high.eq(edge))),
        statement="while the train is not trusted, neither end of its interval comes nearer to the other",
        requirements=CLEAR,
    )


def _added_error(model: FibreArea) -> Iterator[Property]:
    """Claim, in figures of its own, the distance of the reported ends of a counted train."""
    own, of = model.report.own, model.composition.of(model.report.machine)
    seen, figures = model.composition.of(model.verification.machine), model.config.parting
    told = _reports(model) & of.bool(model.report.machine.flag("integer"))
    long, run = seen.num(model.verification.own.stored_length_high), of.num(own.run_one_way)
    low, high = of.num(own.reported_low), of.num(own.reported_high)
    front, rear = of.num(own.front_low), of.num(own.rear_high)
    most = figures.count_run_mm + figures.roll_back_mm
    yield for_all_inputs(
        "a count adds its run to the error",
        told.implies(
            ((low + most <= front - long) | (run < -figures.count_run_mm))
            & ((high - most >= rear + long) | (run > figures.count_run_mm))
        ),
        statement="in a cycle in which a train counts as whole, each end is reported as far out as that of a whole train "
        "within the count's run, unless that end has led for longer than this run",
        requirements=(*COUNTS, *CLEAR),
    )
    yield for_all_inputs(
        "an end leads by run one way only",
        all_of(_one_way(model, run)),
        statement="the run in one direction is counted from zero again in a cycle in which the train stands, turns, is not measured, or is gone",
        requirements=(*COUNTS, *CLEAR),
    )


def _parted(model: FibreArea) -> Iterator[Property]:
    """Claim that a part that the train lost lies in the train's interval."""
    own, of = model.report.own, model.composition.of(model.report.machine)
    slot, area = model.area.own.slots[0], _of_slot(model)
    parted = area.bool(slot.there) & of.bool(~own.rear_is_the_trains | ~own.front_is_the_trains)
    low_um, high_um = (area.num(exact_to(bound, UM)) for bound in (slot.low, slot.high))
    yield under_assumption(
        "lost parts lie in the train's interval",
        parted.implies((low_um <= area.num(slot.true_rear)) & (area.num(slot.true_front) <= high_um)),
        statement="whenever the train parted, its last lost part lies in the train's interval from rear end to front end: "
        "a section there is not clear, for it is clear on evidence only",
        requirements=(*COUNTS, *CLEAR),
    )


def _one_way(model: FibreArea, run: Num) -> Iterator[Bool]:
    """Yield the conditions that the run in one direction grows while it goes on, and is zero from the cycle on in which it does not."""
    front = model.composition.of(model.front.machine)
    seen = model.composition.of(model.verification.machine)
    run_input = front.bool(model.front.own.run.present), front.num(model.front.own.run.value)
    yield (earlier_num(run) <= 0) | (run >= earlier_num(run)) | (run <= 0)
    yield (earlier_num(run) >= 0) | (run <= earlier_num(run)) | (run >= 0)
    yield (run > 0).implies(run_input[1] > 0)
    yield (run < 0).implies(run_input[1] < 0)
    yield run.ne(0).implies(run_input[0])
    yield run.ne(0).implies(seen.bool(model.verification.own.associated))
    yield _leaves(model).implies(run.eq(0))


def _of_sections(model: FibreArea) -> Iterator[Property]:
    """Yield the properties of area and sections; here they rest on the fibre instead of on a report that is assumed true."""
    alone = Sections(model.area, model.sections, model.composition)
    for prop in sections_properties.properties(alone):
        yield prop if prop.unconditional else replace(prop, assumption=LAW)


# ------------------------------------------------------------------ reachability


def _reached(model: FibreArea) -> Iterator[Property]:
    of, verified = model.composition.of, model.verification
    seen = of(verified.machine)
    yield reachable("trusted", _trusted(model), statement="a train can be trusted", requirements=CLAIM)
    yield reachable(
        "revoked",
        seen.bool(verified.machine.flag("revoked")),
        statement="a reported position can be revoked",
        requirements=ERROR,
    )
    first = model.sections[0].machine
    yield reachable(
        "clear beside a trusted train",
        _trusted(model) & of(first).bool(first.flag("clear")),
        statement="a section can be clear while a trusted train is in the area",
        requirements=CLEAR,
    )
