"""Claims about reflectors that are anchored by groups of balises, in any composition that has both (RFL-5, RFL-6, RFL-9, RFL-D3, RFL-D4).

No position of a balise is an input of such a whole: that what the reflector machine is anchored by holds the front end is proved of
the balise machine. What a telegram says is compared with the raw telegram, and with the true place of the front end.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from safeloc.language.composition import Composition
from safeloc.language.expr import Bool, Num, all_of, any_of, between, exact_to
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import NM
from safeloc.models.balise import Balise
from safeloc.models.balise.variables import ACCEPTED
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.balise_reading import BaliseReading
from safeloc.models.reflector.variables import BALISE_CONTRADICTS
from safeloc.models.reflector_anchor.line import Line
from safeloc.models.vocabulary.reasons import CONTRADICTION
from safeloc.properties.hearing import INTERVAL

for_all_inputs = partial(always, unconditional=True)


@dataclass(frozen=True, eq=False)
class Anchoring:
    """The machines of a composition, and the words in which all claims are said.

    truth  the true place of the front end after the step, in terms of the whole
    law    what is assumed of the sensors, in words
    """

    composition: Composition
    groups: Balise
    line: Line
    source: ReflectorMachine
    truth: Num
    law: str

    @property
    def accepted(self) -> Bool:
        """The balise machine reports a position, and the telegram of this cycle passed every check."""
        machine = self.groups.machine
        return self.of_groups(machine.flag("valid")) & self.of_groups_num(machine.output("telegram")).eq(ACCEPTED)

    @property
    def disproved(self) -> Bool:
        """The balise machine reports nothing because groups contradict its position."""
        return self.of_groups_num(self.groups.machine.output("reason")).eq(CONTRADICTION)

    @property
    def located(self) -> Bool:
        """The reflector machine reports a position."""
        return self.of_source(self.source.machine.flag("valid"))

    def of_groups(self, term: Bool) -> Bool:
        """Return a condition of the balise machine in terms of the whole."""
        return self.composition.of(self.groups.machine).bool(term)

    def of_groups_num(self, term: Num) -> Num:
        """Return a value of the balise machine in terms of the whole."""
        return self.composition.of(self.groups.machine).num(term)

    def of_source(self, term: Bool) -> Bool:
        """Return a condition of the reflector machine in terms of the whole."""
        return self.composition.of(self.source.machine).bool(term)

    def of_source_num(self, term: Num) -> Num:
        """Return a value of the reflector machine in terms of the whole."""
        return self.composition.of(self.source.machine).num(term)


def properties(whole: Anchoring) -> list[Property]:
    """Return the claims."""
    makers = (_rejected, _assumed, _handed_over, _distances, _by_map)
    return [prop for maker in makers for prop in maker(whole)]


# ------------------------------------------------------------------ what the balise machine rejects


def _rejected(whole: Anchoring) -> Iterator[Property]:
    given = whole.source.own.balise
    inputs = (given.identity, given.position, given.accuracy, given.since, given.reference, given.search_from)
    read = any_of(whole.of_source(one.present) for one in inputs)
    yield for_all_inputs(
        "a rejected telegram is no reading",
        (~whole.accepted).implies(~read),
        statement="of a telegram that the balise machine does not accept, the reflector machine gets nothing: no place, no "
        "distance to a reflector, and no place from which to search for it",
        requirements=("RFL-5", "RFL-9", "RFL-D4"),
    )
    yield for_all_inputs(
        "only an accepted group anchors",
        (whole.located & ~earlier_bool(whole.located)).implies(whole.accepted),
        statement="the reflector machine reports a position again only in a cycle in which the balise machine accepted a group",
        requirements=("RFL-5", "RFL-D3", "RFL-D4"),
    )


def _assumed(whole: Anchoring) -> Iterator[Property]:
    binds = whole.composition.of(whole.line.machine).bool(whole.line.accepted)
    yield for_all_inputs(
        "the survey's law binds exactly accepted groups",
        binds.iff(whole.accepted),
        statement="what is assumed of telegram and map is assumed of the group that the balise machine accepts in this cycle, and of no "
        "other telegram",
        requirements=("RFL-5", "RFL-9"),
    )


# ------------------------------------------------------------------ what it accepts


def _handed_over(whole: Anchoring) -> Iterator[Property]:
    given = whole.source.own.balise
    place, accuracy = whole.of_source_num(given.position.value), whole.of_source_num(given.accuracy.value)
    handed = whole.of_source(given.identity.present) & whole.of_source(given.position.present)
    position, below, above = (whole.of_groups_num(whole.groups.machine.output(name)) for name in INTERVAL)
    exact = all_of([whole.of_source(given.accuracy.present), whole.of_source(given.since.present)])
    group = whole.of_groups_num(whole.groups.own.memory.group)
    yield for_all_inputs(
        "an accepted group is handed over",
        whole.accepted.implies(
            all_of([
                handed, exact, place.eq(position), (accuracy >= below) & (accuracy >= above),
                accuracy.eq(below) | accuracy.eq(above), whole.of_source_num(given.since.value).eq(0),
                whole.of_source_num(given.identity.value).eq(group),
            ])
        ),
        statement="every group that the balise machine accepts is a reading of the reflector machine in the same cycle, with its identity, the "
        "balise machine's position and the greater of its margins, at the end of the cycle",
        requirements=("RFL-5",),
    )  # fmt: skip
    yield always(
        "no accepted group contradicts the reflector machine",
        whole.of_source_num(whole.source.machine.output("error")).ne(BALISE_CONTRADICTS),
        statement="the intervals of balise machine and reflector machine never exclude each other",
        requirements=("RFL-5", "RFL-D3"),
        assumption=whole.law,
    )
    off, most = whole.truth - exact_to(place, NM), exact_to(accuracy, NM)
    yield always(
        "a reading holds the front end",
        handed.implies(between(-most, off, most)),
        statement="the true position of the front end is no farther from a reading than its accuracy: no reading is stray",
        requirements=("RFL-5",),
        assumption=whole.law,
    )


# ------------------------------------------------------------------ the distance that a telegram or the map brings


def _distances(whole: Anchoring) -> Iterator[Property]:
    given, ahead, reach = whole.source.own.balise, whole.source.own.ahead, whole.source.own.config.range_limit_mm
    raw, place = whole.groups.own.read, whole.of_source_num(given.position.value)
    group = whole.of_groups_num(whole.groups.own.memory.last_group_position)
    for name, mine, theirs, least in (
        ("reflector", given.reference, raw.reflector, 0), ("search", given.search_from, raw.search, 1),
    ):  # fmt: skip
        told, distance = whole.of_groups(theirs.present), whole.of_groups_num(theirs.value)
        left = group + distance - place
        fits = whole.accepted & told & between(least, left, reach)
        yield for_all_inputs(
            f"the telegram's {name} distance is used",
            whole.of_source(mine.present).iff(fits) & fits.implies(whole.of_source_num(mine.value).eq(left)),
            statement=f"the {name} distance of an accepted telegram, counted from the group's place on the map, is handed over as "
            "what of it lies ahead of the position, wherever that is within the radar's range; no other distance is",
            requirements=("RFL-9",),
        )
    yield from _reflector_from_truth(whole, given, whole.of_source_num(ahead.position.value))


def _by_map(whole: Anchoring) -> Iterator[Property]:
    given, ahead, told = whole.source.own.balise, whole.source.own.ahead, whole.composition.of(whole.line.machine)
    entry, reference = whole.line.position, whole.line.reference
    yield for_all_inputs(
        "the map's next reflector is searched",
        whole.of_source(ahead.position.present).iff(told.bool(entry.present))
        & told.bool(entry.present).implies(whole.of_source_num(ahead.position.value).eq(told.num(entry.value))),
        statement="the reflector machine gets the map's next reflector in every cycle in which the map has one, at its place",
        requirements=("RFL-3", "RFL-9"),
    )
    group = whole.of_groups_num(whole.groups.own.memory.last_group_position)
    left = group + told.num(reference.value) - whole.of_source_num(given.position.value)
    near = between(0, left, whole.source.own.config.range_limit_mm)
    fits = all_of([whole.accepted, told.bool(reference.present), near])
    yield for_all_inputs(
        "the map's distance is used",
        whole.of_source(ahead.reference.present).iff(fits)
        & fits.implies(whole.of_source_num(ahead.reference.value).eq(left)),
        statement="the distance that the map has from an accepted group to its reflector is handed over as what of it lies ahead of the "
        "position, wherever that is within the radar's range; no other distance is",
        requirements=("RFL-6", "RFL-9"),
    )


def _reflector_from_truth(whole: Anchoring, given: BaliseReading, mapped: Num) -> Iterator[Property]:
    """The distance that is handed over against the true place of the front end and the place of the reflector on the map."""
    ahead = whole.source.own.ahead
    accuracy = whole.of_source_num(given.accuracy.value) + whole.source.own.config.map_accuracy_mm
    off, most = exact_to(mapped, NM) - whole.truth, exact_to(accuracy, NM)
    for name, told in (("telegram", given.reference), ("map", ahead.reference)):
        distance = exact_to(whole.of_source_num(told.value), NM)
        known = whole.of_source(told.present) & whole.of_source(ahead.position.present)
        yield always(
            f"the distance by the {name} is that of the true front end",
            known.implies(between(-most, off - distance, most)),
            statement=f"the distance by the {name} is that from the true front end to the map's next reflector, within the accuracy of "
            "the reading and of the survey",
            requirements=("RFL-9", "RFL-6"),
            assumption=whole.law,
        )
