"""Search the limit of a figure: the last value at which all claims are proved, and the next one, at which a run breaks one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from safeloc.assurance.margins.asking import Answer, Asking
from safeloc.assurance.margins.figures import Figure

Direction = Literal["up", "down"]
_PATIENCE = 6
"""Questions at most for a nearer run beyond a value that is not decided: each of them takes the whole limit."""


@dataclass(frozen=True)
class Limit:
    """How far one figure may move in one direction, with the other figures as they are.

    holds_to  the last value at which all claims are proved; the figure's own value if there is no margin
    end       the answer at the value beyond: broken (by a run), undecided, refused; proved: the range ends at `holds_to`
    beyond    the value beyond; None at the end of the range
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
        """How far the figure may move."""
        return abs(self.holds_to - self.figure.value)


def limit(asking: Asking, figure: Figure, direction: Direction, fixed: Mapping[str, int] | None = None) -> Limit:
    """Return the limit of a figure in one direction. fixed: other figures that have moved already."""
    search = _Search(asking, figure, dict(fixed or {}))
    end = figure.high if direction == "up" else figure.low
    if end == figure.value:
        return Limit(figure, direction, figure.value, Answer("proved"), None)
    admitted = search.last_admitted(end)
    if admitted == figure.value:
        beyond = figure.value + search.sign(end)
        return Limit(figure, direction, figure.value, Answer("refused", why=search.refusal(beyond)), beyond)
    next_value = figure.value + search.sign(end)
    if search.answer(next_value).end == "broken":
        return Limit(figure, direction, figure.value, search.answer(next_value), next_value)
    if search.answer(admitted).end == "proved":
        return search.at_the_end(direction, admitted, end)
    good, bad = search.bracket(admitted)
    good, bad = nearest(good, bad, lambda value: search.answer(value).end == "proved")
    broken_at = None
    if search.answer(bad).end == "undecided" and search.answer(admitted).end == "broken":
        _, broken_at = nearest(bad, admitted, lambda value: search.answer(value).end != "broken", _PATIENCE)
    why = "" if good == figure.value else search.answer(good).why
    return Limit(figure, direction, good, search.answer(bad), bad, broken_at, why)


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


class _Search:
    """The answers along one figure."""

    def __init__(self, asking: Asking, figure: Figure, fixed: dict[str, int]) -> None:
        self._asking, self._figure, self._fixed = asking, figure, fixed

    def sign(self, end: int) -> int:
        """Return the direction towards the end."""
        return 1 if end > self._figure.value else -1

    def refusal(self, value: int) -> str:
        """Return why the machine cannot be made at this value; "" if it can."""
        return self._asking.refusal({**self._fixed, self._figure.name: value})

    def answer(self, value: int) -> Answer:
        """Return the answer at this value."""
        return self._asking.answer({**self._fixed, self._figure.name: value})

    def last_admitted(self, end: int) -> int:
        """Return the value towards the end after which the configuration refuses the next; the end if it refuses none."""
        if not self.refusal(end):
            return end
        return nearest(self._figure.value, end, lambda value: not self.refusal(value))[0]

    def bracket(self, end: int) -> tuple[int, int]:
        """Return a value that holds and one that does not: from the figure's own value in growing steps towards the end."""
        good, step = self._figure.value, 1
        while True:
            tried = self._figure.value + self.sign(end) * step
            if abs(tried - self._figure.value) >= abs(end - self._figure.value):
                return good, end
            if self.answer(tried).end != "proved":
                return good, tried
            good, step = tried, 4 * step

    def at_the_end(self, direction: Direction, admitted: int, end: int) -> Limit:
        """Return the limit of a figure whose claims hold at the last value that the configuration admits."""
        proved = self.answer(admitted)
        if admitted == end:
            return Limit(self._figure, direction, admitted, Answer("proved"), None, proved_why=proved.why)
        beyond = admitted + self.sign(end)
        refused = Answer("refused", why=self.refusal(beyond))
        return Limit(self._figure, direction, admitted, refused, beyond, proved_why=proved.why)
