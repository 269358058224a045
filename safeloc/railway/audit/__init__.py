"""The audit of a line: whether its layout meets what the proofs assume (RFL-D1, RFL-7, RFL-8, RFL-11).

The rules are the terms of `safeloc.models.layout_rules`, evaluated by the reference interpreter on the figures of the
map, for every stretch, every pair of neighbours and every branch, on all routes at once.
"""

from safeloc.railway.audit.all_rules import audit

__all__ = ["audit"]
