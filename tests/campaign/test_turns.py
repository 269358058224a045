"""More workers than cores take turns."""

from __future__ import annotations

import pytest

from safeloc.campaign.schedule import handed_out_at_once


@pytest.mark.parametrize(
    ("threads", "cores", "at_once"),
    [
        (1, 2, 2),  # one runs, one waits
        (2, 2, 4),
        (8, 2, 3),  # two run, one waits
        (8, None, 16),  # workers elsewhere have cores of their own
    ],
)
def test_no_more_shards_run_than_there_are_cores(threads: int, cores: int | None, at_once: int) -> None:
    assert handed_out_at_once(threads, cores) == at_once
