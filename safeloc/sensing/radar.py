"""The radar front end: an image becomes echoes with bounds, or is refused with a reason (RFL-1, RFL-2, RFL-10).

    image -> admitted? -> peaks over clutter -> places between cells -> shapes -> Frame(echoes) | NoFrame(reason)

An echo is a candidate, never a position: the machine decides whether it is the reflector of the map.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.runtime.border import Reason
from safeloc.sensing.detection import peaks
from safeloc.sensing.echoes import Echo, echoes
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import NoFrame, Order, RadarImage, Refusal, admitted, floor_cdb
from safeloc.sensing.interpolation import points


@dataclass(frozen=True)
class Frame:
    """The echoes of one image, nearest first, with the image's time (middle of the chirp), number and noise."""

    time_ms: int
    sequence: int
    floor_cdb: int
    echoes: tuple[Echo, ...]


Outcome = Frame | NoFrame


def read(image: RadarImage, config: RadarConfig) -> Outcome:
    """Process one image without regard to earlier ones."""
    power = admitted(config.sensor, image)
    if isinstance(power, NoFrame):
        return power
    found = peaks(power, config)
    if len(found) > config.detection.most_peaks:
        return NoFrame(Refusal.CROWDED, f"{len(found)} peaks")
    floor = floor_cdb(power)
    assert floor is not None
    return Frame(image.time_ms, image.sequence, floor, tuple(echoes(points(power, found, config), config)))


class FrontEnd:
    """The front end of one sensor. It takes images in the order of their delivery."""

    def __init__(self, config: RadarConfig, max_age_ms: int) -> None:
        self._config = config
        self._order = Order(max_age_ms)

    def receive(self, image: RadarImage | None, now_ms: int) -> Outcome:
        """Process the image of this cycle; None: nothing was delivered."""
        if image is None:
            return NoFrame(Reason.MISSING)
        return self._order.judge(image, now_ms) or read(image, self._config)
