"""Search the limit of a figure: the last value at which all claims are proved, and the next one, at which a run breaks one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from safeloc.assurance.margins.asking import Answer, Asking
from safeloc.assurance.margins.figures import Figure

Direction = Literal["up", "down"]
_PATIENCE = 3
"""Values at most that are not decided in a search that goes on: each of them takes the whole limit."""
_PATIENCE_AGAIN = 0
"""The same where they are asked again, with a longer limit."""
_PATIENCE_OF_A_POINT = 1
"""The same at a point of a front, where none but the figure's own value is asked again: a front has ten points."""
_GROWTH = 4
"""Factor of the steps away from a figure's own value."""


@dataclass(frozen=True)
class Limit:
    """The limit of one figure in one direction, with the other figures unchanged.

    holds_to  the last value at which all claims are proved; the figure's own value if there is no margin
    end       the answer at the value beyond: broken (by a run), undecided, vacuous, refused; proved: the range ends at `holds_to`
    beyond    the value beyond, the next one unless it is undecided; None at the end of the range
    broken_at  if the value beyond is undecided: one farther away at which a run breaks a claim
    proved_why  the reason why no claim had to be proved at `holds_to`, if none had
    """

    figure: Figure
    direction: Direction
    holds_to: int
    end: Answer
    beyond: int | None
    broken_at: int | None = None
    proved_why: str = ""

    @property
    def margin(self) -> int:
        """The distance from the present value to the limit."""
        return abs(self.holds_to - self.figure.value)


def limit(asking: Asking, figure: Figure, direction: Direction, fixed: Mapping[str, int] | None = None) -> Limit:
    """Return the limit of a figure in one direction. fixed: other figures that have moved already, at a point of a front."""
    search = _Search(asking, figure, direction, dict(fixed or {}))
    if search.end == figure.value:
        return Limit(figure, direction, figure.value, Answer("proved"), None)
    if fixed and search.again(figure.value).end != "proved":
        return Limit(figure, direction, figure.value, search.answer(figure.value), figure.value)
    admitted = search.last_admitted()
    if admitted == figure.value:
        beyond = figure.value + search.sign
        return Limit(figure, direction, figure.value, Answer("refused", why=search.refusal(beyond)), beyond)
    beside = figure.value + search.sign
    if search.along_known(beside) or search.quickly(beside):
        return Limit(figure, direction, figure.value, search.answer(beside), beside)
    if search.answer(admitted).end == "proved":
        return search.at_the_end(admitted)
    return search.between(admitted)


def nearest(good: int, bad: int, is_good: Callable[[int], bool], most: int = 64) -> tuple[int, int]:
    """Return neighbours between `good` and `bad`, in this order: the first is good, the second is not.

    most  questions at most; after them the two may be farther apart
    """
    for _ in range(most):
        if abs(bad - good) <= 1:
            break
        middle = (good + bad) // 2
        if is_good(middle):
            good = middle
        else:
            bad = middle
    return good, bad


def _bracket(most: int, none_at: Callable[[int], bool]) -> tuple[int, int]:
    """Return two distances, of which the second is at most twice the first (or 1): nothing is found at the first, and at the second it is.

    The doublings of 1 are halved, not the distance: mostly a run breaks a claim very near, or far away. 0 stands for the good value.
    """
    doublings = [0, *(1 << power for power in range(max(most - 1, 0).bit_length())), most]
    low, high = nearest(0, len(doublings) - 1, lambda place: none_at(doublings[place]))
    return doublings[low], doublings[high]


class _Search:
    """The answers along one figure."""

    def __init__(self, asking: Asking, figure: Figure, direction: Direction, fixed: dict[str, int]) -> None:
        self._asking, self._figure, self._fixed = asking, figure, fixed
        self._direction: Direction = direction
        self.end = figure.high if direction == "up" else figure.low
        self.sign = 1 if direction == "up" else -1

    def refusal(self, value: int) -> str:
        """Return why the machine cannot be made at this value; "" if it can."""
        return self._asking.refusal(self._at(value))

    def answer(self, value: int) -> Answer:
        """Return the answer at this value."""
        return self._asking.answer(self._at(value))

    def again(self, value: int) -> Answer:
        """Return the answer at this value, asked again with a longer limit if it is undecided."""
        return self._asking.again(self._at(value))

    def quickly(self, value: int) -> bool:
        """Return whether a short search finds a run at this value."""
        return self._asking.quickly(self._at(value))

    def along_known(self, value: int) -> bool:
        """Return whether a run breaks a claim at this value along the way of one that is known."""
        return self._asking.along_known(self._at(value))

    def _at(self, value: int) -> dict[str, int]:
        return {**self._fixed, self._figure.name: value}

    def last_admitted(self) -> int:
        """Return the value towards the end after which the configuration refuses the next; the end if it refuses none."""
        if not self.refusal(self.end):
            return self.end
        return nearest(self._figure.value, self.end, lambda value: not self.refusal(value))[0]

    def at_the_end(self, admitted: int) -> Limit:
        """Return the limit of a figure whose claims hold at the last value that the configuration admits."""
        proved, figure = self.answer(admitted), self._figure
        if admitted == self.end:
            return Limit(figure, self._direction, admitted, Answer("proved"), None, proved_why=proved.why)
        beyond = admitted + self.sign
        refused = Answer("refused", why=self.refusal(beyond))
        return Limit(figure, self._direction, admitted, refused, beyond, proved_why=proved.why)

    def between(self, end: int) -> Limit:
        """Return the limit before a value at which the claims are not proved.

        From a value at which a run breaks a claim the search goes along that run to the nearest one, and asks all claims beside it.
        """
        patience = _PATIENCE_OF_A_POINT if self._fixed else _PATIENCE
        good, bad, run_at = self._narrowed(self._figure.value, end, None, self.answer, patience)
        if self.answer(bad).end == "undecided" and not self._fixed:
            start = bad if run_at is None else run_at
            if run_at is None and self.again(bad).end == "proved":
                if bad == end or self.again(end).end == "proved":
                    return self.at_the_end(end)
                good, start = bad, end
            good, bad, run_at = self._narrowed(good, start, run_at, self.again, _PATIENCE_AGAIN)
        why = "" if good == self._figure.value else self.answer(good).why
        farther = None if run_at == bad else run_at
        return Limit(self._figure, self._direction, good, self.answer(bad), bad, farther, why)

    def _narrowed(
        self, good: int, bad: int, run_at: int | None, ask: Callable[[int], Answer], patience: int
    ) -> tuple[int, int, int | None]:
        """Return a proved value, one beyond that is not, and the nearest one at which a run breaks a claim, if there is one.

        The first two are neighbours, unless more values than `patience` are not decided.
        """
        tries, undecided = _Tries(self._figure.value, self.sign), 0
        while True:
            match ask(bad).end:
                case "broken":
                    bad = run_at = self._nearest_along(good, bad)
                case "undecided":
                    undecided += 1
            if abs(bad - good) == 1 or undecided > patience:
                return good, bad, run_at
            tried = tries.between(good, bad, decided=ask(bad).end != "undecided")
            if ask(tried).end == "proved":
                good = tried
            else:
                bad = tried

    def _nearest_along(self, good: int, bad: int) -> int:
        """Return the value nearest to a good one at which a run breaks the claim along the way of the run at the bad one."""
        best = bad

        def none_at(value: int) -> bool:
            nonlocal best
            found = self._asking.along(self._at(value), self._at(best))
            best = value if found else best
            return not found

        near, far = _bracket(abs(bad - good), lambda distance: none_at(good + self.sign * distance))
        return nearest(good + self.sign * near, good + self.sign * far, none_at)[1]


class _Tries:
    """The values that are asked between a good and a bad one.

    Beside a run, or a value at which a claim says nothing, first the next value, then the middle, in turn; before what is not
    decided in growing steps from the figure's own value, then the middle.
    """

    def __init__(self, value: int, sign: int) -> None:
        self._value, self._sign, self._step, self._beside = value, sign, 1, True

    def between(self, good: int, bad: int, *, decided: bool) -> int:
        """Return the next value to ask."""
        if decided:
            self._beside = not self._beside
            return (good + bad) // 2 if self._beside else bad - self._sign
        while self._step <= abs(good - self._value):
            self._step *= _GROWTH
        tried = self._value + self._sign * self._step
        return tried if abs(tried - self._value) < abs(bad - self._value) else (good + bad) // 2
