"""The rules of the audit by name: terms of `layout_rules` over variables that stand for figures of the map."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import TRUE, Bool, Num, NumVar, Var, boolean, number
from safeloc.language.interpret import Program, evaluate
from safeloc.language.nodes import And, Compare, Or, Value
from safeloc.language.terms import variables
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models import layout_rules as terms
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules import markers as marker_rules

_TURNED = {"<=": ">=", "<": ">", "==": "=="}
_REACH_MM = 10**12
UNBOUNDED = 10**12
"""Stands for `without bound`: a loop without references, a reflector without any balise before it."""


@dataclass(frozen=True)
class Figures:
    """A failed comparison: `actual` should be `relation` `required`. `what` names the actual figure; "" for a compound term."""

    what: str
    actual: int
    relation: str
    required: int
    unit: str


@dataclass(frozen=True, eq=False)
class Rule:
    """One rule of the layout. Breaking an `advice` rule is no violation."""

    name: str
    requirements: tuple[str, ...]
    term: Bool
    advice: bool = False

    @cached_property
    def _program(self) -> Program:
        return Program([self.term])

    @cached_property
    def _variables(self) -> dict[str, Var]:
        return {var.name: var for var in variables([self.term])}

    def broken(self, values: Mapping[str, Value]) -> bool:
        """Return whether the figures (name -> value) violate the rule; KeyError for a missing one."""
        return not self._program(self._bound(values))[0]

    def figures(self, values: Mapping[str, Value]) -> Figures | None:
        """Return the comparison that makes a broken rule fail; None if it is not a comparison of figures."""
        bound = self._bound(values)
        failed = _failing(self.term, bound)
        if failed is None:
            return None
        left, right = evaluate([failed.left, failed.right], bound)
        unit = failed.left.unit.name
        if isinstance(failed.right, NumVar) and not isinstance(failed.left, NumVar):
            return Figures(_words(failed.right), right, _TURNED[failed.op], left, unit)
        return Figures(_words(failed.left), left, failed.op, right, unit)

    def _bound(self, values: Mapping[str, Value]) -> dict[Var, Value]:
        return {var: values[name] for name, var in self._variables.items()}


def _words(term: Num) -> str:
    """Return the name of a figure in words (`view_from_mm`: view from); "" for a compound term."""
    return term.name.removesuffix("_mm").replace("_", " ") if isinstance(term, NumVar) else ""


def _failing(term: Bool, values: Mapping[Var, Value]) -> Compare | None:
    """Return the first comparison that makes the term false."""
    match term:
        case Compare():
            return term
        case And(parts):
            broken = (part for part in parts if not evaluate([part], values)[0])
            return _failing(next(broken), values)
        case Or(parts):
            found = [failing for part in parts if (failing := _failing(part, values)) is not None]
            return found[-1] if found else None
        case _:
            return None


@dataclass(frozen=True, eq=False)
class Rules:
    """All rules for one vehicle's figures."""

    layout: LayoutConfig

    @cached_property
    def stretch(self) -> Rule:
        """Every odometry stretch is short enough."""
        figures = (_mm("distance_mm"), _mm("fix_error_mm"), _mm("apart_mm"))
        return Rule("odometry stretch", ("RFL-D1",), terms.stretch_is_tolerable(*figures, self.layout))

    @cached_property
    def marker_stretch(self) -> Rule:
        """Some reading of a marker is near enough before every other one."""
        fix = number("fix_error_nm", NM, 0, _REACH_MM * NM_PER_MM)
        figures = (_mm("distance_mm"), fix, _mm("apart_mm"), _mm("held_back_mm"))
        return Rule("marker stretch", ("MRK-D1", "MRK-D5"), marker_rules.marker_is_near(*figures, self.layout))

    @cached_property
    def marker_order(self) -> Rule:
        """Markers are read one by one, in their order on the map."""
        term = marker_rules.markers_read_one_by_one(_mm("spacing_mm"), _mm("within_mm"), self.layout)
        return Rule("markers one by one", ("MRK-1",), term)

    @cached_property
    def markers_waiting(self) -> Rule:
        """Markers under the vehicle can wait for the trailing reader."""
        under = number("under_the_vehicle", COUNT, 0, _REACH_MM)
        return Rule("markers under the vehicle", ("MRK-1",), marker_rules.markers_can_wait(under, self.layout))

    @cached_property
    def after_balise(self) -> Rule:
        """Reflectors follow balises."""
        count = number("reflectors_since_balise", COUNT, 0, _REACH_MM)
        return Rule("reflector after its balise", ("RFL-7",), terms.reflector_follows_balise(count, self.layout))

    @cached_property
    def reference_distance(self) -> Rule:
        """The distance in the telegram, or the system variable, agrees with the map."""
        term = terms.reference_distance_agrees(_mm("stated_mm"), _mm("distance_mm"), self.layout)
        return Rule("distance from balise to reflector", ("RFL-8", "RFL-9"), term)

    @cached_property
    def function_test(self) -> Rule:
        """The function test is possible over the balise."""
        figures = (_mm("distance_mm"), _mm("read_within_mm"), _mm("view_from_mm"), _mm("view_to_mm"))
        return Rule("function test", ("RFL-6",), terms.reference_measurement_possible(*figures, self.layout), True)

    @cached_property
    def search_start(self) -> Rule:
        """The search for the reflector, by the telegram, begins early enough."""
        figures = (_mm("search_from_mm"), _mm("distance_mm"), _mm("view_from_mm"))
        return Rule("search begins in time", ("RFL-8", "RFL-9"), terms.search_starts_in_time(*figures, self.layout))

    @cached_property
    def view_zone(self) -> Rule:
        """View zones suit the radar."""
        term = terms.view_zone_in_range(_mm("view_from_mm"), _mm("view_to_mm"), self.layout)
        return Rule("view zone in range", ("RFL-1",), term)

    @cached_property
    def neighbours(self) -> Rule:
        """No reflector can be confused with its neighbour."""
        figures = (_mm("spacing_mm"), _mm("next_view_from_mm"), _mm("previous_view_to_mm"))
        term = terms.distinguishable(boolean("same_model"), *figures, self.layout)
        return Rule("neighbours told apart", ("RFL-8", "RFL-10"), term)

    @cached_property
    def across_tracks(self) -> Rule:
        """No reflector can be confused with one beside another track."""
        term = terms.distinguishable_across_tracks(boolean("same_model"), _mm("spacing_mm"), self.layout)
        return Rule("reflectors across tracks", ("RFL-10",), term)

    @cached_property
    def branches(self) -> Rule:
        """Models on branches differ."""
        return Rule("models on branches", ("RFL-11",), terms.branch_models_differ(boolean("same_model")))

    @cached_property
    def switch_view(self) -> Rule:
        """A switch lies in the view zone of the reflector behind it."""
        figures = (_mm("distance_mm"), _mm("view_from_mm"), _mm("view_to_mm"))
        return Rule("switch in view", ("RFL-12",), terms.switch_in_view(*figures, self.layout), True)

    @cached_property
    def direction(self) -> Rule:
        """The models around a balise without orientation tell the direction."""
        return Rule("direction from models", ("RFL-D5",), terms.direction_shows(boolean("same_model")), True)

    @cached_property
    def routes(self) -> Rule:
        """Routes are distinguishable."""
        faults = number("faults_to_confuse", COUNT, 0, _REACH_MM)
        return Rule("routes told apart", ("RFL-D6",), terms.routes_distinguishable(faults, self.layout))

    @cached_property
    def all_ways(self) -> Rule:
        """All ways behind a switch are compared; a finding if there are too many."""
        return Rule("ways compared", ("RFL-D6",), TRUE, advice=True)

    @cached_property
    def edge_length(self) -> Rule:
        """Edges are longer than what a vehicle runs in a cycle."""
        return Rule(
            "edge longer than a cycle's run", ("RFL-D6",), terms.edge_outlasts_a_cycle(_mm("length_mm"), self.layout)
        )

    @cached_property
    def ways_at_joints(self) -> Rule:
        """At most two edges lead on from a joint."""
        term = terms.joint_has_two_ways(number("ways", COUNT, 0, _REACH_MM))
        return Rule("two ways at a joint", ("RFL-D6",), term)

    @cached_property
    def group_before_joint(self) -> Rule:
        """A group tells the edge on which the front end is."""
        term = terms.group_tells_its_edge(_mm("to_joint_mm"), self.layout)
        return Rule("group before a joint", ("RFL-D6",), term)

    @cached_property
    def balise_windows(self) -> Rule:
        """Expectation windows of balises do not overlap."""
        figures = (_mm("spacing_mm"), _mm("first_accuracy_mm"), _mm("second_accuracy_mm"))
        return Rule("balise windows", ("RFL-D4",), terms.expectation_windows_apart(*figures, self.layout))

    @cached_property
    def stop_view(self) -> Rule:
        """The reflector is in view at the stop point."""
        names = ("standstill_mm", "window_before_mm", "window_after_mm", "view_from_mm", "view_to_mm")
        a, b, c, d, e = (_mm(name) for name in names)
        return Rule("reflector in view at stop", ("RFL-D7",), terms.stop_reflector_in_view(a, b, c, d, e, self.layout))

    @cached_property
    def standstill(self) -> Rule:
        """Standstill distance and map agree."""
        term = terms.standstill_distance_agrees(_mm("stated_mm"), _mm("distance_mm"), self.layout)
        return Rule("standstill distance", ("RFL-D7",), term)

    @cached_property
    def stop_window(self) -> Rule:
        """The stop window can be kept and is narrow enough."""
        term = terms.stop_window_fits(_mm("window_before_mm"), _mm("window_after_mm"), self.layout)
        return Rule("stop window", ("RFL-D7",), term)

    @cached_property
    def code_window(self) -> Rule:
        """As many sections as the fibre machine reads give the place."""
        least = number("sections_that_give_a_place", COUNT, 0, _REACH_MM)
        return Rule("position code", ("FWG-10", "FWG-15"), terms.sections_give_the_place(least, self.layout))

    @cached_property
    def code_reach(self) -> Rule:
        """Sections near each other differ."""
        apart = number("sections_apart", COUNT, 0, _REACH_MM)
        return Rule("near sections differ", ("FWG-9", "FWG-10"), terms.near_sections_differ(apart, self.layout))

    @cached_property
    def section_length(self) -> Rule:
        """The length of a section is one of two."""
        term = terms.section_is_short_or_long(_mm("length_of_cable_mm"), self.layout)
        return Rule("section short or long", ("FWG-10",), term)

    @cached_property
    def code_error(self) -> Rule:
        """One error within a word does not mislead."""
        readings = number("misleading_readings", COUNT, 0, _REACH_MM)
        return Rule("code withstands an error", ("FWG-10",), terms.code_withstands_an_error(readings))


def _mm(name: str) -> NumVar:
    return number(name, MM, -_REACH_MM, _REACH_MM)
