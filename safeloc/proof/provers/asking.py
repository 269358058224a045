"""z3, asked within a limit that z3 itself counts: the same answers on a busy machine as on an idle one."""

from __future__ import annotations

from typing import Any

import z3

from safeloc.proof.provers.limits import CLOCK, milliseconds, spend

UNITS_PER_SECOND = 5_000_000
"""Of z3's resource count, in a second of effort: half of our queries make 5 to 10 million in one of an idle processor."""
WRAPS = 2**32  # z3 tells its count in 32 bits
MOST_UNITS = WRAPS - 1


def new_solver(seed: int = 0) -> z3.Solver:
    """Make a solver for questions that follow each other."""
    return _seeded(z3.Solver(), seed)


def plain_solver(seed: int = 0) -> z3.Solver:
    """Make a solver without tactics before it: for one question, or many targets at a time, on which those are lost."""
    return _seeded(z3.SimpleSolver(), seed)


def _seeded(solver: z3.Solver, seed: int) -> z3.Solver:
    solver.set("random_seed", seed)
    return solver


def ask(solver: z3.Solver, seconds: float, *assumptions: Any) -> z3.CheckSatResult:
    """Ask the solver within the given seconds of effort, and count them; `unknown` if none are left."""
    if seconds <= 0:
        return z3.unknown
    solver.set("rlimit", units(seconds))
    solver.set("timeout", milliseconds(CLOCK * seconds))
    before = _counted(solver)
    answer = solver.check(*assumptions)
    spend((_counted(solver) - before) % WRAPS / UNITS_PER_SECOND)
    return answer


def units(seconds: float) -> int:
    """Return the same as a limit for z3, to which 0 means `no limit`."""
    return min(MOST_UNITS, max(1, int(seconds * UNITS_PER_SECOND)))


def why_unknown(solver: z3.Solver) -> str:
    """Return the reason in words; z3 calls it `canceled` where the limit was reached."""
    return str(solver.reason_unknown()).replace("canceled", "limit reached")


def _counted(solver: z3.Solver) -> int:
    return int(solver.statistics().get_key_value("rlimit count"))
