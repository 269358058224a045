"""Ghosts of a group reading whose reader was late or beside its place: what the world may choose so that it keeps its laws, if anything.

    antenna         when the reading was taken, the antenna stood over the group within the detection accuracy
    counter or age  the run since then is what the counter says, but for rate and wander; or no more than the age allows
    map             the group lies within its accuracy of its place, or is far off

The run since the reading, the wander then and the place of the group are the world's to choose. Where no choice keeps all, counter
and age are kept, and the group lies where it does: then the antenna did not stand over it, which is what the latency did.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.variables import BaliseConfig
from safeloc.runtime.streams.steps import Cell


@dataclass(frozen=True)
class LateGroup:
    """A reading in its cycle.

    now_nm    place of the front end at the end of the cycle; ran_nm: its run in the cycle
    age_ms    as the reading tells it
    since_mm  run since the time stamp by the latched counter; None: it is not counted
    """

    config: BaliseConfig
    now_nm: int
    ran_nm: int
    wander_nm: int
    age_ms: int
    since_mm: int | None

    def ghosts(self, true_since_nm: int, spot_nm: int, place_nm: int, accuracy_nm: int) -> dict[str, Cell]:
        """Return the ghosts of the reading: as they truly are, or as near to that as the laws allow."""
        least, most = self._since_nm
        beyond, detection = self.now_nm - self.config.antenna_mm * NM_PER_MM, self.config.detection_mm * NM_PER_MM
        low = max(beyond - detection, least + place_nm - accuracy_nm)
        high = min(beyond + detection, most + place_nm + accuracy_nm)
        since = min(max(true_since_nm, least), most)
        if low <= high:
            both = min(max(since + spot_nm, low), high)
            spot_nm = min(max(both - since, place_nm - accuracy_nm), place_nm + accuracy_nm)
            since = both - spot_nm
        return {
            "read_place_nm": spot_nm,
            "true_since_nm": since,
            "reading_wander_nm": 0 if self.since_mm is None else self._wander_then(since, self.since_mm),
        }

    @property
    def _since_nm(self) -> tuple[int, int]:
        """Return the least and the greatest run since the reading that counter or age allow, nm."""
        config, half = self.config, self.config.odometer.wander_nm
        if self.since_mm is not None:
            around, wrong = self.since_mm * NM_PER_MM + self.wander_nm, abs(self.since_mm) * config.odometer.rate_ppm
            return around - half - wrong, around + half + wrong
        step = config.measuring_step_mm * NM_PER_MM
        farthest = self.age_ms * config.max_speed_mm_s * 1_000 + step
        if self.age_ms > config.period_ms:
            return -farthest, farthest
        return max(-farthest, min(self.ran_nm, 0) - step), min(farthest, max(self.ran_nm, 0) + step)

    def _wander_then(self, since_nm: int, since_mm: int) -> int:
        """Return the wander at the reading: within its half, and as what the counter says wants it."""
        half = self.config.odometer.wander_nm
        return min(max(self.wander_nm - (since_nm - since_mm * NM_PER_MM), -half), half)
