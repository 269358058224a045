"""The digital map of a line (RFL-4): one frozen value with all elements, checked for consistency when it is made."""

from __future__ import annotations

import hashlib
import json
from typing import Annotated

from pydantic import Field, model_validator

from safeloc.railway.map.elements import (
    AxleCounter,
    BaliseGroup,
    Crossing,
    Curve,
    DetectionSection,
    Element,
    Fibre,
    Gradient,
    Identity,
    LocalizationSection,
    Marker,
    Node,
    Reflector,
    Signal,
    SpeedLimit,
    StopPoint,
    Switch,
    TrackEdge,
    Tunnel,
    VirtualSection,
)
from safeloc.railway.map.integrity import contradictions
from safeloc.runtime.flaws import Flaw, FlawsError

Checksum = Annotated[str, Field(pattern=r"^sha256:[0-9a-f]{64}$")]


class Line(Element):
    """A line, or a part of one that was loaded separately.

    name, version  identify the map; parts of one map agree in both
    part           name of the part; empty for a complete map
    checksum       checksum of all other content (`content_checksum`)

    ValidationError for a checksum that does not match the content, and for a map that contradicts itself; the message lists
    the contradictions: unknown references, positions off their edge, double identities, nodes with three edges and no switch.
    """

    name: Identity
    version: Identity
    part: str = ""
    checksum: Checksum | None = None
    source: str = ""
    nodes: tuple[Node, ...] = Field(min_length=1)
    edges: tuple[TrackEdge, ...] = Field(min_length=1)
    switches: tuple[Switch, ...] = ()
    crossings: tuple[Crossing, ...] = ()
    balise_groups: tuple[BaliseGroup, ...] = ()
    reflectors: tuple[Reflector, ...] = ()
    markers: tuple[Marker, ...] = ()
    stop_points: tuple[StopPoint, ...] = ()
    signals: tuple[Signal, ...] = ()
    axle_counters: tuple[AxleCounter, ...] = ()
    detection_sections: tuple[DetectionSection, ...] = ()
    virtual_sections: tuple[VirtualSection, ...] = ()
    fibres: tuple[Fibre, ...] = ()
    localization_sections: tuple[LocalizationSection, ...] = ()
    tunnels: tuple[Tunnel, ...] = ()
    speed_limits: tuple[SpeedLimit, ...] = ()
    gradients: tuple[Gradient, ...] = ()
    curves: tuple[Curve, ...] = ()

    @model_validator(mode="after")
    def _agrees_with_itself(self) -> Line:
        wrong = list(contradictions(self))
        if self.checksum is not None and not wrong and self.checksum != content_checksum(self):
            told = f"checksum is {self.checksum}, but the content has {content_checksum(self)}: do not use it"
            wrong.append(Flaw(told, (("checksum",),)))
        if wrong:
            raise FlawsError(wrong)
        return self


def content_checksum(line: Line) -> str:
    """Return the SHA-256 of the canonical content: compact JSON with sorted keys, without the checksum and default values."""
    content = line.model_dump(mode="json", exclude={"checksum"}, exclude_defaults=True)
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return "sha256:" + hashlib.sha256(text.encode("utf-8")).hexdigest()


def sealed(line: Line) -> Line:
    """Return the line with the checksum of its content."""
    return line.model_copy(update={"checksum": content_checksum(line)})
