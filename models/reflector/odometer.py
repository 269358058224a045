"""The odometer of the reflector machine: what the vehicle may have run since a radar frame or a balise reading."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from safeloc.language.expr import Lit, Num, as_num, ite, maximum
from safeloc.language.units import COUNT, NM, NM_PER_MM, PPM
from safeloc.models.vocabulary.measured import MeasuredDistance


@dataclass(frozen=True, eq=False)
class ReflectorOdometer(MeasuredDistance):
    """A measured distance, of which also shares of a cycle are known.

    An interval read off a reflector or a balise is true as it stands. Whoever runs on from it adds the law's one-off constant
    once, because the odometer's error may wander within it from the next cycle on.
    """

    @cached_property
    def constant_nm(self) -> int:
        """The one-off constant of the law, nm."""
        return 2 * self.law.wander_nm

    @cached_property
    def growth(self) -> Num:
        """Error that the cycle adds to either margin, nm. The error reported beyond the law is the same in both cases.

        The sum stands outside the choice, as this machine was proved.
        """
        return super().growth if self.more is None else replace(self, more=None).growth + self.more

    @cached_property
    def gap_after(self) -> Num:
        """Cycles without a usable distance after this one, counted up to one more than permitted."""
        counted, most = self.gap + 1, self.limits.gap_limit + 1
        return ite(self.admitted, as_num(0, COUNT), ite(counted > most, most, counted))

    def lag(self, share_ppm: int) -> tuple[Num, Num]:
        """Return the farthest that the vehicle may have run (forwards, backwards) in the last share of the cycle, nm."""
        blind = as_num(-(-self.limits.blind_nm * share_ppm // NM_PER_MM), NM)
        share, more = Lit(share_ppm, PPM), as_num(0, NM) if self.more is None else self.more
        forward = maximum(self.measured.value, 0) * share + more
        backward = maximum(-self.measured.value, 0) * share + more
        return ite(self.admitted, forward, blind), ite(self.admitted, backward, blind)
