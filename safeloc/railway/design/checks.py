"""Checks of a design: the written file passes the audit, the machine is proved to hold its position, and 1 mm more breaks it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.verdict import word
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.line_runs.configs import LineVehicle, fitting
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.provers.limits import Limits
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import AuditReport
from safeloc.railway.audit.marker_readings import Readings
from safeloc.railway.audit.rules import Rules
from safeloc.railway.design.designing import Design
from safeloc.railway.design.held_by_markers import followed, held_run
from safeloc.railway.design.held_by_markers import proof_of as run_proof
from safeloc.railway.design.held_stretch import HeldStretch, broken_beyond, proof_of, watched
from safeloc.railway.map.toml_files import from_toml, to_toml
from safeloc.railway.map.walk import Walk


@dataclass(frozen=True, eq=False)
class Held:
    """The findings on the machine behind groups, or markers, of one accuracy.

    machine    the machine that locates the vehicle; what: what it reads
    verdict    of the claim that it holds its position as far as the bound says, after a reading by any of its readers
    lost_in    the cycle, from 0, in which a run withdraws the position within 1 mm more; None: it does not
    """

    machine: str
    what: str
    held: HeldStretch
    verdict: str
    lost_in: int | None

    @property
    def is_shown(self) -> bool:
        """True if the bound is proved, and 1 mm more breaks it."""
        return self.verdict == "proved" and self.lost_in is not None


def written(found: Design) -> tuple[str, AuditReport]:
    """Return the text of the designed line, and the audit of the line that is read from this text."""
    text = to_toml(found.line)
    return text, audit(from_toml(text, f"{found.line.name}, designed"), found.task.layout)


def machine_config(found: Design) -> BaliseConfig | OdometryConfig:
    """Return the configuration of the machine that locates the vehicle. InputError if its figures do not suit the machine."""
    if found.task.layout.markers is None:
        return found.reach.config
    config = fitting(LineVehicle(layout=found.task.layout, trust_first=True), "odometry")
    assert isinstance(config, OdometryConfig)
    return config


def held_by_the_machine(found: Design, seconds: float) -> Iterator[Held]:
    """Yield what the vehicle's machine does behind the groups and markers of the designed line, for each accuracy among them."""
    config = machine_config(found)
    if isinstance(config, OdometryConfig):
        yield from _held_by_odometry(found, config, Limits(seconds=seconds))
        return
    machine = watched(config)
    for accuracy_mm in sorted({found.reach.accuracy_mm(one) for one in found.line.balise_groups}):
        held = found.reach.held(accuracy_mm)
        if held is not None:
            verdict = word(proof_of(machine, held, Limits(seconds=seconds)))
            yield Held("balise", "group", held, verdict, broken_beyond(machine, held))


def _held_by_odometry(found: Design, config: OdometryConfig, limits: Limits) -> Iterator[Held]:
    readings = Readings(Walk(found.line), Rules(found.task.layout))
    for accuracy in sorted({mark.accuracy_mm for mark, _, _ in readings.everywhere()}):
        held = held_run(config, accuracy)
        if held is not None:
            front, rear = (followed(config, end, accuracy) for end in (0, 1))
            verdicts = [word(run_proof(one, held.run_mm, limits)) for one in (front, rear)]
            verdict = next((one for one in verdicts if one != "proved"), "proved")
            yield Held("odometry", "marker", held, verdict, broken_beyond(rear, held))
