"""Inputs that do not come from satellites: trusted references, and odometry as a check."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.units import UM_PER_MM


@dataclass(frozen=True, slots=True)
class Reference:
    """A trusted place at the time of the cycle (a balise) with its accuracy; its speed, where that is trusted too."""

    position_mm: int
    accuracy_mm: int
    speed_mm_s: int | None = None
    speed_accuracy_mm_s: int = 0


@dataclass(frozen=True, slots=True)
class Run:
    """Run since the cycle before by odometry, with its error. It only checks the position and never sets it."""

    run_mm: int
    error_mm: int


def trusted_inputs(reference: Reference | None, run: Run | None) -> dict[str, int | bool | str]:
    """Both as inputs of the position machine."""
    inputs: dict[str, int | bool | str] = {
        "position.reference_accuracy_mm": 0 if reference is None else reference.accuracy_mm,
        "position.reference_speed_accuracy_um_s": 0,
        "position.odometry_error_mm": 0 if run is None else run.error_mm,
    }
    if reference is not None:
        inputs["position.reference_mm"] = reference.position_mm
        if reference.speed_mm_s is not None:
            inputs["position.reference_speed_um_s"] = reference.speed_mm_s * UM_PER_MM
            inputs["position.reference_speed_accuracy_um_s"] = reference.speed_accuracy_mm_s * UM_PER_MM
    if run is not None:
        inputs["position.odometry_mm"] = run.run_mm
    return inputs
