"""Questions to z3 with limits that z3 itself counts: the answers are the same on a busy machine as on an idle one."""

from __future__ import annotations

from typing import Any

import z3

from safeloc.proof.provers.limits import clock_multiple, milliseconds, spend

UNITS_PER_SECOND = 5_000_000
"""Units of z3's resource count in one second of effort: half of our queries use 5 to 10 million a second on an idle processor."""
WRAPS = 2**32  # z3 reports its count in 32 bits
MOST_UNITS = WRAPS - 1


def new_solver(seed: int = 0) -> z3.Solver:
    """Make a solver for a series of related questions."""
    return _seeded(z3.Solver(), seed)


def plain_solver(seed: int = 0) -> z3.Solver:
    """Make a solver without preprocessing tactics.

    It suits a single question, and questions about many targets at once, for which tactics take time without any gain.
    """
    return _seeded(z3.SimpleSolver(), seed)


def _seeded(solver: z3.Solver, seed: int) -> z3.Solver:
    solver.set("random_seed", seed)
    return solver


def ask(solver: z3.Solver, seconds: float, *assumptions: Any) -> z3.CheckSatResult:
    """Ask the solver within the given seconds of effort, and count the effort used; `unknown` if no effort is left."""
    if seconds <= 0:
        return z3.unknown
    solver.set("rlimit", units(seconds))
    solver.set("timeout", milliseconds(clock_multiple() * seconds))
    before = counted(solver)
    answer = solver.check(*assumptions)
    spend((counted(solver) - before) % WRAPS / UNITS_PER_SECOND)
    return answer


def units(seconds: float, per_second: int = UNITS_PER_SECOND) -> int:
    """Return seconds of effort as a limit in z3's units: at least 1, since 0 means `no limit` to z3."""
    return min(MOST_UNITS, max(1, int(seconds * per_second)))


def why_unknown(solver: z3.Solver) -> str:
    """Return z3's reason for `unknown`; z3's word `canceled` becomes `limit reached`."""
    return str(solver.reason_unknown()).replace("canceled", "limit reached")


def counted(solver: z3.Solver | z3.Fixedpoint) -> int:
    """Return the units that z3 has used so far, modulo WRAPS."""
    return int(solver.statistics().get_key_value("rlimit count"))
