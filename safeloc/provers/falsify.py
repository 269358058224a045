"""placeholder"""

from safeloc.verdict import Unknown, Verdict


def falsify(goal, limits, seed=0) -> Verdict:
    return Unknown("none")
