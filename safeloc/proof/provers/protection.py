"""Check of a protection level by a solver: errors within their bounds never exceed it (SAT-5).

The error of a least-squares solution is the sum of share times error over its satellites. z3 decides over the rationals
with the figures of the geometry in use: nothing is rounded, and the check does not rely on the sum that gave the level.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import z3

from safeloc.errors import EngineError, InputError
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers.asking import ask, new_solver, why_unknown


def protected(shares: Mapping[str, Fraction], bounds: Mapping[str, int], level: int, seconds: float = 10) -> Verdict:
    """Prove that errors within their bounds (|error_i| <= bounds[i]) give |sum shares[i] error_i| <= level.

    Violated names errors that exceed the level. InputError for a share without a bound; EngineError if z3 and the sum of the
    worst errors contradict each other.
    """
    if shares.keys() - bounds.keys():
        raise InputError(f"no bound for {', '.join(sorted(shares.keys() - bounds.keys()))}; give one for every share.")
    errors = {name: z3.Real(name) for name in shares}
    solver = new_solver()
    solver.add(*(z3.And(one <= bounds[name], one >= -bounds[name]) for name, one in errors.items()))
    total: Any = z3.RealVal(0)
    for name, share in shares.items():
        total = total + z3.Q(share.numerator, share.denominator) * errors[name]
    solver.add(z3.Or(total > level, total < -level))
    answer = ask(solver, seconds)
    if answer == z3.unsat:
        worst = sum((abs(share) * bounds[name] for name, share in shares.items()), Fraction(0))
        if worst > level:
            raise EngineError(
                f"z3 found no errors beyond {level}, but all errors at their bounds add up to {float(worst)}."
            )
        return Proved(None, "z3", 0, ("errors all at their bounds, exactly",))
    if answer == z3.unknown:
        return Unknown(f"solver: {why_unknown(solver)}")
    model = solver.model()
    errors_ = ", ".join(f"{name} {model.eval(one, model_completion=True)}" for name, one in errors.items())
    return Violated(None, "z3", f"beyond {level} with errors {errors_}")
