"""Runs that break claims of a composition a few steps from a known run: recordings go where a search from the first state does not come.

Before a train of `fibre_area` is trusted, the counters were reset and swept, a train came in, its record came, and it was counted: a dozen steps of
a system with hundreds of variables. A claim on a trusted train is broken one step later, from any state of a recording in which one is trusted.
"""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.language.spec import Goal
from safeloc.language.trace import Trace
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.onward import onward
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.provers.shorten import shortened

ENGINE = "search from a known run"
_FURTHER = 2
_EACH_S = 1.0
"""Steps from a state of a known run, and seconds of effort for the search from one state."""


def broken_onward(goals: Sequence[Goal], known_runs: Sequence[Recording], limits: Limits) -> dict[Goal, Trace]:
    """Return a run for each goal that is broken so soon after a known run, as short as the time for it allows.

    The goals are of one composition and one assumption; none of a machine by itself, whose first states are near enough.
    """
    if not goals or not goals[0].original.parts:
        return {}
    asked = dict(enumerate(goals))
    found = onward(goals[0].plain, asked, known_runs, deadline(limits.seconds), _FURTHER, _EACH_S)
    return {
        asked[number]: shortened(asked[number], run.initial, [step.inputs for step in run.steps])
        for number, run in found.items()
    }
