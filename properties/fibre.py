"""What must hold of the place from localization sections (FWG-1 to FWG-15)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import abs_, all_of, as_num, before, between, exact_to, ite, was, with_unit
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import COUNT, NM
from safeloc.models.fibre import CHECKED, CODE, COUNTS, SEEN, Fibre
from safeloc.models.fibre import variables as v
from safeloc.properties.in_step import in_step

NM_PER_MM, NM_PER_UM = 1_000_000, 1_000
LAW = "the detector's bounds, true references, and a code in which near sections differ"


def properties(model: Fibre) -> list[Property]:
    """Containment, counting, the code, and the error signal."""
    return [*_place(model), *_charged(model), *_counting(model), *_code(model), *_error(model), *_reached(model)]


def _place(model: Fibre) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, position, over = machine.flag("valid"), machine.output("position_mm"), machine.output("over_mm")
    off = own.truth - exact_to(position, NM)
    yield always(
        "containment",
        valid.implies(between(-exact_to(over, NM), off, exact_to(over, NM))),
        statement="a reported interval holds the end of the train",
        requirements=("FWG-1", "FWG-11"),
        assumption=LAW,
    )
    yield always(
        "tolerance",
        valid.implies(over <= own.config.tolerance_mm + own.config.max_step_mm * 4),
        statement="a reported interval is never wider than the tolerable error and the run of the cycle of an edge",
        requirements=("FWG-1", "FWG-11"),
        unconditional=True,
    )
    no_event = own.signal.one_of(v.NO_SIGNAL) & was(model.own.counted)
    stays = before(machine.mode).eq(machine.modes[2]) & valid & no_event & ~own.reference
    yield always(
        "only edges narrow",
        stays.implies(own.drift >= before(own.drift)),
        statement="without an edge of a section, or a reference, the interval never becomes narrower",
        requirements=SEEN,
        unconditional=True,
    )
    yield always(
        "no resurrection",
        (valid & before(machine.mode).ne(machine.modes[2])).implies(machine.fired("reference accepted", "word found")),
        statement="a place is known again only from an accepted reference, or from a whole word of the code",
        requirements=CODE,
        unconditional=True,
    )


def _charged(model: Fibre) -> Iterator[Property]:
    """What a run may be wrong by, in figures of its own: the law of the detector speaks of the machine's charge."""
    machine, own, config = model.machine, model.own, model.own.config
    _, counting, located, _ = machine.modes
    mode, run = machine.mode, abs_(own.run.value)
    rate = with_unit(run * config.rate_ppm, NM) + config.floor_mm * NM_PER_MM
    farthest = as_num(config.max_speed_mm_s * config.period_ms * NM_PER_UM, NM)
    charge = ite(own.run.present, ite(run.eq(0), as_num(0, NM), rate), farthest)
    follows = before(mode).one_of(counting, located) & mode.one_of(counting, located) & ~own.reference
    yield always(
        "every run is charged",
        (follows & own.signal.eq(v.NO_SIGNAL)).implies(own.drift - before(own.drift) >= charge),
        statement="in a cycle without an edge the interval grows by rate and floor of the run, and by the farthest run where "
        "none came",
        requirements=("FWG-1", "FWG-11"),
        unconditional=True,
    )
    edge = mode.one_of(counting, located) & own.signal.ne(v.NO_SIGNAL)
    within = ite(own.run.present, exact_to(run, NM), as_num(0, NM))
    yield always(
        "an edge is charged the run of its cycle",
        edge.implies(own.drift >= within + charge),
        statement="an edge may have been passed anywhere within its cycle: the run of the whole cycle is charged",
        requirements=("FWG-1", "FWG-11"),
        unconditional=True,
    )


def _counting(model: Fibre) -> Iterator[Property]:
    machine, own = model.machine, model.own
    waiting, counting, located, _ = machine.modes
    mode = machine.mode
    counts = before(mode).one_of(counting, located) & mode.one_of(counting, located) & ~own.reference
    change = own.count - before(own.count)
    back = own.run.present & (own.run.value < 0)
    yield always(
        "a signal is a rise or a fall",
        own.signal.eq(v.POSITION_SIGNAL).implies(before(own.band).eq(v.NORMAL) & own.band.ne(v.NORMAL)),
        statement="a position signal arises only where the amplitude leaves normal, upwards or downwards",
        requirements=SEEN,
        unconditional=True,
    )
    yield always(
        "normal again is no section",
        (before(own.band).ne(v.NORMAL) & own.band.eq(v.NORMAL)).implies(own.signal.ne(v.POSITION_SIGNAL)),
        statement="the return to normal is not taken for a second section",
        requirements=SEEN,
        unconditional=True,
    )
    yield always(
        "one section at a time",
        before(own.band).ne(v.NORMAL).implies(own.signal.ne(v.POSITION_SIGNAL)),
        statement="between two signals the amplitude is normal",
        requirements=SEEN,
        unconditional=True,
    )
    yield always(
        "count begins with the first signal",
        (machine.flag("count_known") & ~was(own.counted)).implies(own.signal.eq(v.POSITION_SIGNAL)),
        statement="before the first signal the count is undefined, not zero",
        requirements=COUNTS,
        unconditional=True,
    )
    yield always(
        "waiting has no count",
        mode.eq(waiting).implies(~machine.flag("count_known") & ~machine.flag("valid")),
        statement="without a signal there is neither count nor place",
        requirements=COUNTS,
        unconditional=True,
    )
    yield always(
        "every signal counts by direction",
        (counts & own.signal.eq(v.POSITION_SIGNAL)).implies(
            change.eq(ite(own.forwards, as_num(1, COUNT), as_num(-1, COUNT)))
        ),
        statement="each signal counts one up where the train runs forwards, and one down where it runs back",
        requirements=COUNTS,
        unconditional=True,
    )
    yield always(
        "running back decreases",
        (counts & back & own.signal.eq(v.POSITION_SIGNAL)).implies(change.eq(-1)),
        statement="a section entered while running back decreases the count",
        requirements=COUNTS,
        unconditional=True,
    )
    yield always(
        "a section left again is uncounted",
        (counts & own.signal.eq(v.TURNED_BACK)).implies(
            change.eq(ite(was(own.upwards), as_num(-1, COUNT), as_num(1, COUNT)))
        ),
        statement="a section that is left on the side it was entered no longer counts",
        requirements=COUNTS,
        unconditional=True,
    )
    quiet = own.signal.one_of(v.NO_SIGNAL, v.PASSED) & ~machine.fired("word found")
    yield always(
        "nothing else counts",
        (counts & quiet).implies(change.eq(0)),
        statement="the count changes only with a signal, or with a section that is left again",
        requirements=COUNTS,
        unconditional=True,
    )


def _code(model: Fibre) -> Iterator[Property]:
    machine, own, cycle = model.machine, model.own, model.cycle
    _, counting, located, faulted = machine.modes
    mode, was_located = machine.mode, before(machine.mode).eq(machine.modes[2])
    off = before(own.true_count) - before(own.count)
    yield always(
        "count agrees with the truth",
        (machine.fired("section passed") & was(own.real) & (abs_(off) <= own.config.reach)).implies(off.eq(0)),
        statement="when a real section was passed and no error is out, the count is the true one, although up to `reach` "
        "sections were missed or false before",
        requirements=(*CODE, *COUNTS),
        assumption=LAW,
    )
    yield always(
        "disagreement raises F",
        (
            was_located & was(own.real) & in_step(machine, cycle.read) & off.ne(0) & (abs_(off) <= own.config.reach)
        ).implies(mode.ne(located) | own.reference),
        statement="a real section that is passed while the count is wrong ends the location in that cycle",
        requirements=(*CODE, *COUNTS),
        assumption=LAW,
    )
    wrong = in_step(machine, cycle.wrong_length)
    calm = ~own.reference & ~in_step(machine, cycle.silent | cycle.too_wide)
    yield always(
        "wrong length raises F",
        (was_located & wrong & calm).implies(mode.eq(faulted)),
        statement="a section of another length than the map has, or of none that can be read, raises F in the same cycle",
        requirements=CODE,
        unconditional=True,
    )
    yield always(
        "a word is whole",
        machine.fired("word found").implies(before(mode).eq(counting) & before(own.read).eq(own.config.window)),
        statement="the code tells the place only when as many symbols were read as make a window of the line unique",
        requirements=CODE,
        unconditional=True,
    )
    symbol = ite(before(own.band).eq(v.RAISED), as_num(2, COUNT), 0) + ite(
        in_step(machine, cycle.reads_long), as_num(1, COUNT), 0
    )
    spelt = machine.fired("symbol read") & before(own.read).eq(0)
    yield always(
        "the word is what was read",
        (spelt & before(own.word).eq(0)).implies(own.word.eq(symbol) & own.read.eq(1)),
        statement="the first symbol of a word is the kind and the length of the section passed",
        requirements=CODE,
        unconditional=True,
    )


def _error(model: Fibre) -> Iterator[Property]:
    machine, own, cycle = model.machine, model.own, model.cycle
    *_, located, faulted = machine.modes
    mode = machine.mode
    was_located = before(mode).eq(located)
    calm = ~own.reference & ~in_step(machine, cycle.silent | cycle.too_wide)
    near = ite(own.forwards, own.ahead.near, own.behind.near)
    signal = was_located & calm & own.signal.eq(v.POSITION_SIGNAL)
    additional = {
        "time of flight": (own.flight, own.config.flight_threshold_mm, ("FWG-4", "FWG-6", "FWG-7")),
        "reflecting point": (own.reflection, own.config.reflection_threshold_mm, ("FWG-4", "FWG-5", "FWG-7")),
    }
    for name, (seen, threshold, trace) in additional.items():
        far = seen.present & (abs_(seen.value - near) > threshold)
        yield always(
            f"{name} off the section raises F",
            (signal & far).implies(machine.flag("error")),
            statement=f"where the place by {name} and the section's known place differ by more than the threshold, F is "
            "out in the cycle of the position signal",
            requirements=trace,
            unconditional=True,
        )
    for name, flaw in {
        "false section": cycle.enters & ~cycle.fits,
        "missed section": cycle.overdue,
        "endless section": cycle.endless,
        "time of flight": cycle.flight_differs,
        "reflecting point": cycle.reflection_differs,
    }.items():
        yield always(
            f"{name} raises F at once",
            (was_located & calm & in_step(machine, flaw)).implies(machine.flag("error") & ~machine.flag("valid")),
            statement=f"a disagreement ({name}) raises F, and ends the location, in the same cycle",
            requirements=CHECKED,
            unconditional=True,
        )
    yield always(
        "F is latched",
        (before(mode).eq(faulted) & mode.ne(faulted)).implies(own.reference),
        statement="F stays until an accepted reference",
        requirements=CHECKED,
        unconditional=True,
    )
    nothing = all_of(machine.output(f"{name}_mm").eq(0) for name in ("position", "over", "under"))
    yield always(
        "F reports nothing",
        machine.flag("error").implies(nothing & ~machine.flag("count_known")),
        statement="with F out there is neither place nor count",
        requirements=CHECKED,
        unconditional=True,
    )
    yield always(
        "F has a reason",
        machine.flag("error").implies(own.why.one_of(
            v.FALSE_SECTION, v.MISSED_SECTION, v.WRONG_LENGTH, v.NO_END_OF_SECTION, v.FLIGHT_DIFFERS, v.REFLECTION_DIFFERS
        )),
        statement="F says why",
        requirements=CHECKED,
        unconditional=True,
    )  # fmt: skip


def _reached(model: Fibre) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    yield reachable("located", valid & own.counted, statement="a train can be located by counting", requirements=COUNTS)
    yield reachable("error", machine.flag("error"), statement="F can come", requirements=CHECKED)
    yield reachable(
        "section passed", own.signal.eq(v.PASSED) & valid, statement="a section can be passed", requirements=SEEN
    )
