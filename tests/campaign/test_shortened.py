"""What a shortened run has to show still: a near miss stays one, and a wrong interval stays wrong."""

from __future__ import annotations

import pytest

from safeloc.campaign.shortened import _Seen

KEPT, BROKEN, MORE = frozenset[int](), frozenset({3}), frozenset({3, 4})


@pytest.mark.parametrize(
    ("seen", "other", "still"),
    [
        (_Seen(True, 40, BROKEN), _Seen(True, 40, BROKEN), True),
        (_Seen(True, 40, BROKEN), _Seen(True, 0, BROKEN), True),  # nearer still
        (_Seen(True, 40, BROKEN), _Seen(True, -1, BROKEN), False),  # it is no near miss any more
        (_Seen(True, 40, BROKEN), _Seen(True, 41, BROKEN), False),
        (_Seen(True, -40, BROKEN), _Seen(True, -1, BROKEN), True),  # wrong by less, but wrong
        (_Seen(True, -40, BROKEN), _Seen(True, 0, BROKEN), False),
        (_Seen(True, 40, BROKEN), _Seen(False, 0, BROKEN), False),
        (_Seen(True, 40, KEPT), _Seen(True, 40, BROKEN), False),
        (_Seen(True, 40, BROKEN), _Seen(True, 40, MORE), False),
        (_Seen(True, 40, MORE), _Seen(True, 40, BROKEN), True),
    ],
)
def test_a_shorter_run_shows_the_same(seen: _Seen, other: _Seen, still: bool) -> None:
    assert seen.still(other) == still
