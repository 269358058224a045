"""The world of the fibre machine: the true position of the end, the sections that it passes, and the laws for the inputs.

The world reads the inputs and the configuration. Of the machine it reads one thing, which the machine reports: the section
number with which the host asks the map.

    the detector  measures runs within rate and floor, and amplitudes; if an amplitude changes, the end has passed an edge of a
                  section since the last amplitude
    the map       has a section where it really lies, or so far from there that no expectation window bridges the distance
    a section     is as long as its kind says, and looks unlike the sections near it in number
    a code word   that is found has at most one section that is missed, misread or false, and the last one is not false
    the train     may pass sections unseen, and meet changes that are no sections

The amplitude's band is derived here once more, from the inputs alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    Bool,
    Expr,
    Lit,
    Num,
    Var,
    any_of,
    as_num,
    between,
    exact_to,
    ite,
    minimum,
    with_unit,
)
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.fibre import variables as v
from safeloc.models.fibre.variables import Parts
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE, on_line

_ASKED = "the section number with which the host asks the map: the count that the machine reports"


def world(own: Parts) -> World:
    """Return the world: true position, sections really passed, and the last messages of detector and map."""
    seen, now = own.ghosts, Passing(own)
    return own.declared.world(
        moves={
            seen.truth: now.after,
            seen.edge: ite(now.edge, seen.next_true_edge, seen.edge),
            seen.count: seen.next_count,
            seen.real: seen.next_real,
            seen.band: now.band,
            seen.upwards: now.upwards,
            seen.possible_run_since_amplitude: ite(
                own.amplitude.present, as_num(0, NM), minimum(now.unheard, seen.possible_run_since_amplitude.high)
            ),
            seen.measured_run_error: now.wrong_after,
            **_entered(own, now),
        },
        clauses=_laws(own, now),
        reads_machine=_ASKED,
    )


def _entered(own: Parts, now: Passing) -> dict[Var, Expr]:
    """Return the moves of the ghosts of a section: at its entry they take the map's section in this direction."""
    seen, met = own.ghosts, now.met
    return {
        seen.section_is_the_maps: ite(
            now.enters, now.alike & seen.next_true_edge.eq(exact_to(met.near, NM)), seen.section_is_the_maps
        ),
        seen.far_edge_on_map: ite(now.enters, met.far, seen.far_edge_on_map),
        seen.long_on_map: ite(now.enters, met.long, seen.long_on_map),
        seen.ahead_by: ite(now.enters, seen.count - own.sections_counted, seen.ahead_by),
    }


# ------------------------------------------------------------------ one cycle of the world


@dataclass(frozen=True, eq=False)
class Met:
    """The map's section in the direction of the run."""

    known: Bool
    near: Num
    far: Num
    rises: Bool
    long: Bool


@dataclass(frozen=True, eq=False)
class Passing:
    """Events of a cycle at the end of the train, and the detector's messages about them."""

    own: Parts

    @cached_property
    def after(self) -> Num:
        """True position of the end after the cycle, nm."""
        return self.own.ghosts.truth + self.own.ghosts.true_run

    # -------------------------------------------------------------- the amplitude

    @cached_property
    def band(self) -> Num:
        """The amplitude's band: beside sections, or in one; without an amplitude, the last band."""
        amplitude, was = self.own.amplitude, self.own.ghosts.band
        return ite(amplitude.present, ite(was.eq(v.NORMAL), self._from_beside, self._from_within), was)

    @cached_property
    def _from_beside(self) -> Num:
        amplitude, least = self.own.amplitude.value, self.own.config.change_cdb
        return ite(amplitude + least <= 0, v.LOWERED, ite(amplitude < least, v.NORMAL, v.RAISED))

    @cached_property
    def _from_within(self) -> Num:
        amplitude, most, was = self.own.amplitude.value, self.own.config.return_cdb, self.own.ghosts.band
        beside = ite(was.eq(v.RAISED), amplitude <= most, amplitude + most >= 0)
        return ite(beside, v.NORMAL, was)

    @cached_property
    def enters(self) -> Bool:
        """The amplitude is changed, and the last one was normal."""
        return self.own.ghosts.band.eq(v.NORMAL) & self.band.ne(v.NORMAL)

    @cached_property
    def leaves(self) -> Bool:
        """The amplitude is normal, and the last one was changed."""
        return self.own.ghosts.band.ne(v.NORMAL) & self.band.eq(v.NORMAL)

    @cached_property
    def edge(self) -> Bool:
        """The detector sees an edge."""
        return self.enters | self.leaves

    # -------------------------------------------------------------- the run

    @cached_property
    def run(self) -> Num:
        """The measured run, mm; 0 without one."""
        return self.own.run.value_or(as_num(0, MM))

    @cached_property
    def size_nm(self) -> Num:
        """The magnitude of the measured run, nm."""
        return exact_to(ite(self.run < 0, -self.run, self.run), NM)

    @cached_property
    def error_nm(self) -> Num:
        """Greatest error of this cycle's run, nm: 1 ppm of n mm is n nm."""
        config, run = self.own.config, self.own.run
        rate, floor = with_unit(run.value * config.rate_ppm, NM), config.floor_mm * NM_PER_MM
        moved = ite(run.value < 0, floor - rate, ite(run.value > 0, floor + rate, as_num(0, NM)))
        return ite(run.present, moved, Lit(self.farthest_nm, NM))

    @cached_property
    def upwards(self) -> Bool:
        """The end runs upwards; if it stands, or no run is measured, it ran upwards last."""
        up, down = self.run > 0, self.run < 0
        return up | (self.own.ghosts.upwards & ~down)

    @cached_property
    def unheard(self) -> Num:
        """Measured run since the last amplitude, plus its greatest error, nm."""
        return self.own.ghosts.possible_run_since_amplitude + self.size_nm + self.error_nm

    @cached_property
    def wrong(self) -> Num:
        """Greatest error of the run since the last edge, at the end of the cycle, nm."""
        return self.own.ghosts.measured_run_error + self.error_nm

    @cached_property
    def wrong_after(self) -> Num:
        """The same after this cycle's edge, which may lie anywhere since the last amplitude, or after its reference."""
        error = ite(self.edge, self.unheard, self.wrong)
        referred = self.own.reference_accepted & self.band.eq(v.NORMAL)
        return minimum(ite(referred, as_num(0, NM), error), self.own.ghosts.measured_run_error.high)

    # -------------------------------------------------------------- the map

    @cached_property
    def met(self) -> Met:
        """The map's next section in the direction of the run."""
        up, down = self.own.ahead, self.own.behind
        return Met(
            self._met(up.known, down.known), ite(self.upwards, up.near, down.near), ite(self.upwards, up.far, down.far),
            self._met(up.rises, down.rises), self._met(up.long, down.long),
        )  # fmt: skip

    def _met(self, up: Bool, down: Bool) -> Bool:
        return (self.upwards & up) | (~self.upwards & down)

    @cached_property
    def alike(self) -> Bool:
        """The map has a section there that changes the amplitude in the same direction as the section being entered."""
        met = self.met
        return met.known & ((met.rises & self.band.eq(v.RAISED)) | (~met.rises & self.band.eq(v.LOWERED)))

    @cached_property
    def followed(self) -> Bool:
        """The runs since the last edge and since the last amplitude are known within the tolerance."""
        most = self.own.config.tolerance_mm * NM_PER_MM
        return (self.wrong <= most) & (self.own.ghosts.possible_run_since_amplitude < most)

    @cached_property
    def bridged_nm(self) -> Num:
        """Greatest distance that the expectation window bridges, nm: four edge tolerances, and twice the errors of both runs."""
        edges = 4 * self.own.config.edge_tolerance_mm + 1
        return 2 * (self.wrong + self.unheard) + edges * NM_PER_MM

    @cached_property
    def farthest_nm(self) -> int:
        """Greatest run of a cycle, nm, in whole mm rounded up."""
        return self.own.config.max_cycle_distance_mm * NM_PER_MM

    @cached_property
    def along(self) -> Num:
        """Distance of the edge seen in this cycle from the edge passed last, nm, positive upwards."""
        return self.own.ghosts.next_true_edge - self.own.ghosts.edge

    def beyond(self, far: Num | int) -> Bool:
        """Return the condition that the edge seen in this cycle lies farther than `far` from the one passed last, on either side."""
        return (self.along > far) | (self.along < -far)


# ------------------------------------------------------------------ the laws


def _laws(own: Parts, now: Passing) -> dict[str, Bool | Law]:
    return {
        "a measured run is true within its error": _run_law(own, now),
        ON_THE_LINE: Law(
            on_line(own.ghosts.truth, now.after), "The coordinates of the line do not end before the train does.", ("position_limit_mm",),
            "[D] 1 000 km of line", "infrastructure", "when the map is made",
        ),
        "a changed amplitude is met at an edge": _edge_law(own, now),
        "the map has the section that is entered, or it is far away": _entry_law(own, now),
        "the map has the ends of a section": _map_law(own, now),
        "the section that was entered is left at one of its ends": _exit_law(own, now),
        "a section is as long as its kind says": _length_law(own, now),
        "sections near each other in number look different": _code_law(own, now),
        "sections are passed one at a time": _count_law(own, now),
        "a reference is true": _reference_law(own, now),
        "a code word that is found lies at its place": _word_law(own),
    }  # fmt: skip


def _run_law(own: Parts, now: Passing) -> Law:
    off = own.ghosts.true_run - exact_to(now.run, NM)
    return Law(
        (off <= now.error_nm) & (-off <= now.error_nm),
        "The measured run of a cycle is wrong by no more than its rate and a floor. A measured run of zero means that the end "
        "stands. In a cycle without a measured run the train runs no faster than its highest speed.",
        ("rate_ppm", "floor_mm", "max_speed_mm_s", "period_ms"),
        "[D] measured over simulation (docs/fibre.md)",
        "supplier",
        "run between two sections against the map",
    )


def _edge_law(own: Parts, now: Passing) -> Law:
    off, tolerance = now.after - own.ghosts.next_true_edge, own.config.edge_tolerance_mm * NM_PER_MM
    near = (off <= now.unheard + tolerance) & (-off <= now.unheard + tolerance)
    anywhere = own.ghosts.possible_run_since_amplitude >= own.ghosts.possible_run_since_amplitude.high
    return Law(
        now.edge.implies(anywhere | near),
        "When the amplitude leaves normal, or returns to it, the end has passed the edge of a section or of a false change. "
        "That edge lies no farther from the end than the edge's tolerance and the run since the last cycle with an amplitude "
        "(at least the run of this cycle). If that run exceeds the tolerance, or if this is the first amplitude, the edge may "
        "lie anywhere.",
        ("edge_tolerance_mm", "change_cdb", "return_cdb", "tolerance_mm"),
        "[D] gauge, pulse and window; [S] 002 l. 160: 5 to 10 m",
        "supplier",
        "type test over sections surveyed; lengths read against the map",
    )


def _entry_law(own: Parts, now: Passing) -> Law:
    off = own.ghosts.next_true_edge - exact_to(now.met.near, NM)
    return Law(
        (now.enters & now.alike & now.followed).implies(off.eq(0) | (off > now.bridged_nm) | (-off > now.bridged_nm)),
        "A change of the amplitude that is of the kind of the map's next section begins where that section begins. Or it is a "
        "false change, or belongs to another section, and then lies farther away than the expectation window can bridge: "
        "twice the tolerances of two edges, the run since the last amplitude, and the error of the run since the last edge. "
        "This holds while both runs are known within the tolerance.",
        ("edge_tolerance_mm", "rate_ppm", "floor_mm", "max_speed_mm_s", "period_ms", "tolerance_mm"),
        "[D] layout: a change like that of the expected section, at its place, cannot be distinguished from it",
        "infrastructure",
        "audit of the line's sections; places of changes that no section explains are reported",
    )


def _map_law(own: Parts, now: Passing) -> Law:
    met = now.met
    onwards = ite(now.upwards, met.near < met.far, met.far < met.near)
    there = now.enters & now.alike & own.ghosts.next_true_edge.eq(exact_to(met.near, NM))
    return Law(
        there.implies(own.ghosts.next_real & onwards),
        "Where the map has the near edge of a section, there is one, and its far edge lies beyond.",
        (),
        "[M] survey when the sections are made",
        "infrastructure",
        "audit of the line's map; survey",
    )


def _exit_law(own: Parts, now: Passing) -> Law:
    seen = own.ghosts
    far = now.bridged_nm + own.config.long_mm * NM_PER_MM
    ends = seen.next_true_edge.eq(seen.edge) | seen.next_true_edge.eq(exact_to(seen.far_edge_on_map, NM))
    return Law(
        (now.leaves & seen.section_is_the_maps & now.followed).implies(ends | now.beyond(far)),
        "A section of the map is left where it was entered, or at its other edge. After cycles without an amplitude the train "
        "may leave another section instead; that one lies farther away than the longest section and what the expectation "
        "window can bridge. This holds while both runs are known within the tolerance.",
        ("long_mm", "edge_tolerance_mm", "rate_ppm", "floor_mm", "max_speed_mm_s", "period_ms", "tolerance_mm"),
        "[D] layout",
        "infrastructure",
        "audit of the line's sections",
    )


def _length_law(own: Parts, now: Passing) -> Law:
    long, short = (length * NM_PER_MM for length in (own.config.long_mm, own.config.short_mm))
    made = any_of(now.along.eq(ran) for ran in (0, short, -short))
    return Law(
        (now.leaves & own.ghosts.real).implies(made | now.beyond(long - 1)),
        "A section is short or long: a short one has its length, a long one at least its length.",
        ("short_mm", "long_mm"),
        "[D] as the sections are made",
        "infrastructure",
        "audit of the line's sections; lengths read against the map",
    )


def _code_law(own: Parts, now: Passing) -> Law:
    seen = own.ghosts
    near = between(-own.config.reach, seen.ahead_by, own.config.reach)
    was_long = now.beyond(own.config.long_mm * NM_PER_MM - 1)
    as_measured = (was_long & seen.long_on_map) | (~was_long & ~seen.long_on_map)
    passed = now.leaves & seen.real & seen.section_is_the_maps & now.along.ne(0)
    return Law(
        (passed & near).implies(ite(seen.ahead_by.eq(0), as_measured, ~as_measured)),
        "If the section that was entered has the number that the map was asked for, it has the length of the map's entry. A "
        "section of another number within the reach of the code has the other length.",
        ("reach",),
        "[D] the code's law, kept by `make_code` and checked by `PositionCode`",
        "infrastructure",
        "audit of the line: the rule `near sections differ`, for the configured reach",
    )


def _count_law(own: Parts, now: Passing) -> Law:
    seen = own.ghosts
    more, one = seen.next_count - seen.count, ite(now.upwards, as_num(1, COUNT), as_num(-1, COUNT))
    entered = ite(seen.next_real, more.eq(one), more.eq(0))
    unseen = between(-1, more, 1) & seen.next_real.iff(seen.real)
    within = seen.band.ne(v.NORMAL) & now.band.ne(v.NORMAL) & seen.real
    return Law(
        ite(now.enters, entered, unseen & within.implies(more.eq(0))),
        "The train passes one section at a time, whether the fibre sees it or not. A false change is no section.",
        (),
        "[D] as the sections are laid",
        "infrastructure",
        "audit of the line's sections",
    )


def _reference_law(own: Parts, now: Passing) -> Law:
    off, tolerance = now.after - exact_to(own.reference_position, NM), own.config.edge_tolerance_mm * NM_PER_MM
    place = (off <= tolerance) & (-off <= tolerance)
    return Law(
        own.reference_accepted.implies(place & own.ghosts.next_count.eq(own.reference_count)),
        "An accepted reference gives the end's place within the tolerance of an edge, and the number of sections below it.",
        ("edge_tolerance_mm",),
        "[D] an axle counter at a known place",
        "operator",
        "the place by the sections passed next",
    )


def _word_law(own: Parts) -> Law:
    at_edge = own.ghosts.edge.eq(exact_to(own.word_position, NM))
    return Law(
        own.word_found.implies(at_edge & own.ghosts.count.eq(own.word_count)),
        "The map has the sections as they lie, and of those passed from the first to the last symbol of a code word that it has, at "
        "most one is missed, misread or false, and the one read last is no false one, but the section passed last. Then the edge "
        "passed last is the one that the map gives for this word, and so is the number of sections below it.",
        ("window", "reach"),
        "[D] of each such reading it is shown, through the decoder, that the edge and the number follow, for codes that pass the "
        "audit (docs/fibre.md, words with an error)",
        "infrastructure",
        "audit of the line: the rules `position code` and `code withstands an error`, for the configured window. How often a "
        "section is missed, misread or false: by the reasons of F of trains that are located",
    )
