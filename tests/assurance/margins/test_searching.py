"""The search of a limit against scripted answers: proved on the one side, a run on the other, and few questions between."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from safeloc.assurance.kept_work import Keeping
from safeloc.assurance.margins.asking import Answer
from safeloc.assurance.margins.figures import Figure
from safeloc.assurance.margins.limits_of_figures import Direction, Limit, limit
from safeloc.proof.cache.store import Store

FIGURE = Figure("f", 100, "mm", 0, 1_000_000)


class Scripted:
    """One who answers from functions of the value: its end, the runs that a way leads to, and what is refused."""

    def __init__(
        self,
        end: Callable[[int], str],
        reaches: Callable[[int, int], bool],
        admits: Callable[[int], bool] = lambda _: True,
        known: Callable[[int], bool] = lambda _: False,
        patiently: Callable[[int], str] = lambda _: "",
    ) -> None:
        self.known, self.patiently = known, patiently
        self._end, self._reaches, self._admits = end, reaches, admits
        self.asked: list[int] = []
        self.broken: set[int] = set()

    def refusal(self, values: Mapping[str, int]) -> str:
        return "" if self._admits(values["f"]) else "too much"

    def answer(self, values: Mapping[str, int]) -> Answer:
        value = values["f"]
        if value in self.broken:
            return Answer("broken", "c")
        if value not in self.asked:
            self.asked.append(value)
        end = self._end(value)
        if end == "broken":
            self.broken.add(value)
        return Answer(end, "c" if end != "proved" else "")  # type: ignore[arg-type] # the script has the four words

    def again(self, values: Mapping[str, int]) -> Answer:
        value = values["f"]
        if self.patiently(value) and value not in self.broken:
            self.broken |= {value} if self.patiently(value) == "broken" else set()
            return Answer(self.patiently(value), "c")  # type: ignore[arg-type] # as above
        return self.answer(values)

    def quickly(self, values: Mapping[str, int]) -> bool:
        del values
        return False

    def along_known(self, values: Mapping[str, int]) -> bool:
        if self.known(values["f"]):
            self.broken.add(values["f"])
        return values["f"] in self.broken

    def along(self, values: Mapping[str, int], broken_at: Mapping[str, int]) -> bool:
        value = values["f"]
        assert broken_at["f"] in self.broken
        if self._end(value) == "broken" and self._reaches(value, broken_at["f"]):
            self.broken.add(value)
        return value in self.broken


def found(scripted: Scripted, way: Direction = "up", figure: Figure = FIGURE) -> Limit:
    return limit(scripted, figure, way)  # type: ignore[arg-type] # it answers what the search asks


def beyond(edge: int) -> Callable[[int], str]:
    return lambda value: "broken" if value > edge else "proved"


@pytest.mark.parametrize("edge", [100, 101, 4_711, 999_998])
def test_along_one_run_two_values_are_asked_in_full(edge: int) -> None:
    """The end of the range, and the value beside the nearest run."""
    scripted = Scripted(beyond(edge), lambda value, at: True)
    one = found(scripted)
    assert (edge, edge + 1, "broken") == (one.holds_to, one.beyond, one.end.end)
    assert len(scripted.asked) <= 2


def test_down_it_goes_as_well() -> None:
    scripted = Scripted(lambda value: "broken" if value < 37 else "proved", lambda value, at: True)
    one = found(scripted, "down")
    assert (37, 36) == (one.holds_to, one.beyond)


def test_runs_that_lead_on_a_little_each_still_come_to_the_limit() -> None:
    """A run of each value reaches a tenth farther only; the middle is asked in turn, so the questions stay few."""
    scripted = Scripted(beyond(500), lambda value, at: value > at * 9 // 10)
    one = found(scripted)
    assert (500, 501, "broken") == (one.holds_to, one.beyond, one.end.end)
    assert len(scripted.asked) < 60


def test_runs_that_lead_nowhere_still_come_to_the_limit() -> None:
    scripted = Scripted(beyond(500), lambda value, at: False)
    assert found(scripted).holds_to == 500
    assert len(scripted.asked) < 60


def test_what_is_undecided_ends_the_search_soon() -> None:
    """Proved to 120, undecided to 5000, broken beyond: the nearest run is told, and few undecided values are asked."""
    scripted = Scripted(
        lambda value: "proved" if value <= 120 else "undecided" if value <= 5_000 else "broken", lambda value, at: True
    )
    one = found(scripted)
    assert (one.end.end, one.broken_at) == ("undecided", 5_001)
    assert 100 <= one.holds_to <= 120 < (one.beyond or 0)
    assert sum(120 < value <= 5_000 for value in scripted.asked) <= 4


@pytest.mark.parametrize(("said", "edge"), [("broken", 120), ("proved", 121)])
def test_a_value_that_is_not_decided_is_asked_again_with_a_longer_limit(said: str, edge: int) -> None:
    """Proved to 120, a run from 122 on: what the longer limit says of 121 decides the limit."""
    scripted = Scripted(
        lambda value: "proved" if value <= 120 else "undecided" if value == 121 else "broken",
        lambda value, at: True,
        patiently=lambda value: said if value == 121 else "",
    )
    one = found(scripted)
    assert (edge, edge + 1, "broken") == (one.holds_to, one.beyond, one.end.end)


@pytest.mark.parametrize(
    ("patiently", "holds_to", "end", "beyond"),
    [
        ((101,), 101, "undecided", 1_000_000),
        ((101, 1_000_000), 1_000_000, "proved", None),
        ((), 100, "undecided", 101),
    ],
)
def test_what_a_longer_limit_proves_is_told_as_proved(
    patiently: tuple[int, ...], holds_to: int, end: str, beyond: int | None
) -> None:
    """Beyond 100 nothing is decided at first; the longer limit proves these values."""
    scripted = Scripted(
        lambda value: "proved" if value <= 100 else "undecided",
        lambda value, at: True,
        patiently=lambda value: "proved" if value in patiently else "",
    )
    one = found(scripted)
    assert (holds_to, end, beyond) == (one.holds_to, one.end.end, one.beyond)


def test_a_claim_that_says_nothing_ends_the_search_beside_it() -> None:
    """No run breaks it there, but a proof of it would say nothing either; the nearest such value is found."""
    scripted = Scripted(lambda value: "proved" if value <= 4_711 else "vacuous", lambda value, at: False)
    one = found(scripted)
    assert (4_711, 4_712, "vacuous") == (one.holds_to, one.beyond, one.end.end)
    assert len(scripted.asked) < 50


def test_undecided_up_to_the_end_has_no_run() -> None:
    one = found(Scripted(lambda value: "proved" if value < 101 else "undecided", lambda value, at: True))
    assert (100, 101, "undecided", None) == (one.holds_to, one.beyond, one.end.end, one.broken_at)


def test_the_last_value_that_is_admitted_is_the_end() -> None:
    one = found(Scripted(lambda _: "proved", lambda value, at: True, lambda value: value <= 640))
    assert (640, 641, "refused", "too much") == (one.holds_to, one.beyond, one.end.end, one.end.why)


def test_beside_another_figure_its_own_value_may_fail_already() -> None:
    """Then there is nothing to search, and the run at the own value is told."""
    one = limit(Scripted(lambda _: "broken", lambda value, at: True), FIGURE, "up", {"g": 3})  # type: ignore[arg-type] # as above
    assert (100, 100, "broken") == (one.holds_to, one.beyond, one.end.end)


def test_at_a_point_of_a_front_nothing_is_asked_again() -> None:
    """Alone, what is undecided is asked again, and more patience decides it; beside another figure it is told as it is, after two values."""

    def scripted() -> Scripted:
        return Scripted(
            lambda value: "proved" if value < 101 else "undecided", lambda value, at: True, patiently=lambda _: "proved"
        )

    assert found(scripted()).end.end == "proved"
    beside = scripted()
    one = limit(beside, FIGURE, "up", {"g": 3})  # type: ignore[arg-type] # as above
    assert (100, 101, "undecided") == (one.holds_to, one.beyond, one.end.end)
    assert len([value for value in beside.asked if value > 100]) <= 2


def test_at_a_point_of_a_front_its_own_value_is_asked_again() -> None:
    """A point whose own value stays undecided tells nothing at all."""
    scripted = Scripted(
        lambda value: "undecided" if value == FIGURE.value else "proved",
        lambda value, at: True,
        patiently=lambda value: "proved" if value == FIGURE.value else "",
    )
    one = limit(scripted, FIGURE, "up", {"g": 3})  # type: ignore[arg-type] # as above
    assert (FIGURE.high, None, "proved") == (one.holds_to, one.beyond, one.end.end)


def test_what_the_limits_left_open_is_not_kept(tmp_path: Path) -> None:
    """A busy computer, or a longer limit, may decide it another time."""
    store = Store(tmp_path)
    keeping = Keeping("margins", "key", store, store, lambda one: one["end"] != "undecided")
    for name, end in {"a": "broken", "b": "undecided"}.items():
        keeping.keep(name, {"end": end})
    assert keeping.kept("a") == {"end": "broken"}
    assert keeping.kept("b") is None


def test_a_run_that_is_known_ends_the_search_at_once() -> None:
    """Where the way of a known run breaks a claim at the next value, nothing else is asked."""
    scripted = Scripted(beyond(100), lambda value, at: True, known=lambda value: value == 101)
    one = found(scripted)
    assert (100, "broken", 101) == (one.holds_to, one.end.end, one.beyond)
    assert scripted.asked == []


@pytest.mark.parametrize("edge", [100, 103, 4_711, 999_998])
def test_a_run_near_the_figure_is_found_in_few_steps(edge: int) -> None:
    """The doublings of one unit are halved first, so that twice as many bits of the distance are tried as its own ones, and few more."""
    tried: list[int] = []

    def reaches(value: int, at: int) -> bool:
        del at
        tried.append(value)
        return True

    assert edge == found(Scripted(beyond(edge), reaches)).holds_to
    assert len(tried) <= max(edge - 100, 1).bit_length() + 5
