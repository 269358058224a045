"""The watchdog, step by step, as if it looked at every vehicle each time."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from safeloc.runtime.service.watchdog import Watchdog

LIMIT_S, PERIOD_S = 4.0, 1.0


class Simple:
    """The same rules without a shortcut."""

    def __init__(self) -> None:
        self.due: dict[str, float] = {}
        self.looked: float | None = None

    def pass_over(self, now: float) -> None:
        """Time in which nothing was read does not count."""
        passed = 0.0 if self.looked is None else now - self.looked
        self.looked = now
        self.due = {name: at + passed for name, at in self.due.items()}

    def overdue(self, now: float) -> list[str]:
        """All that are due, each once per period."""
        if self.looked is not None and now - self.looked > LIMIT_S:
            self.pass_over(now)
            return []
        self.looked = now
        found = [name for name, at in self.due.items() if at <= now]
        for name in found:
            self.due[name] += PERIOD_S
        return found


@given(
    st.lists(
        st.tuples(
            st.sampled_from(["ended", "forget", "pass_over", "overdue"]), st.sampled_from("abc"), st.integers(0, 6)
        )
    )
)
def test_it_finds_whoever_is_due(events: list[tuple[str, str, int]]) -> None:
    """Whatever happened before; and it never sleeps past the moment at which somebody is due."""
    dog, simple, now = Watchdog(LIMIT_S, PERIOD_S), Simple(), 0.0
    for what, name, later in events:
        now += later / 2
        if what == "ended":
            dog.ended(name, now)
            simple.due[name] = now + LIMIT_S
        elif what == "forget":
            dog.forget(name)
            simple.due.pop(name, None)
        elif what == "pass_over":
            dog.pass_over(now)
            simple.pass_over(now)
        else:
            assert list(dog.overdue(now)) == simple.overdue(now)
        wait = dog.next_s(now)
        assert (wait is None) == (not simple.due)
        assert wait is None or 0.0 <= wait <= max(0.0, min(simple.due.values()) - now)
