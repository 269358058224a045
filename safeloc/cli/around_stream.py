"""The stream of a proof around it: a file, a recording that ships, or a simulation of the machine or of a vehicle on a line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from safeloc.catalogue import ENTRIES, load_target
from safeloc.errors import InputError
from safeloc.language.renamed import hint
from safeloc.proof.verification.replay import read_recording
from safeloc.runtime.streams.steps import StepStream
from safeloc.simulated import Steps, first_values
from safeloc.target import Target, find_recording, recording_name


def given_stream(
    target: str, around: str | None, simulate: str | None, config: Path | None
) -> tuple[Target, StepStream, str]:
    """Return the target with a stream of it, and the name of the stream."""
    if simulate is not None and around is not None:
        raise InputError("--around and --simulate exclude each other: give a stream, or have one simulated.")
    loaded = load_target(target, config)
    if simulate is not None:
        return _Simulation(target, loaded, config, _settings(simulate)).stream()
    path = find_recording(loaded, Path(around or ""))
    stream, _ = read_recording(loaded, path)
    return loaded, stream, recording_name(path)


def _settings(text: str) -> dict[str, str]:
    """Return what `line=fig3,seed=7,faults=a,b` sets: a part without `=` goes on the setting before it."""
    found: dict[str, str] = {}
    last = ""
    for part in text.split(","):
        key, sign, value = part.partition("=")
        if sign:
            last = key.strip()
            found[last] = value.strip()
        elif last:
            found[last] += f",{part.strip()}"
        else:
            raise InputError(f"--simulate {text!r}: expected settings such as line=fig3,seed=7.")
    empty = next((key for key, value in found.items() if not value), None)
    if empty is not None:
        raise InputError(f"--simulate {empty}=: there is no value behind it; give one, or leave it out.")
    unknown = next((key for key in found if key not in _SETTINGS), None)
    if unknown is not None:
        raise InputError(
            f"--simulate: no setting {unknown!r}; there are {', '.join(_SETTINGS)}.{hint(unknown, _SETTINGS)}"
        )
    return found


_SETTINGS = ("line", "seed", "faults", "vehicle")


@dataclass(frozen=True)
class _Simulation:
    """A simulated stream: of the machine alone, or of a vehicle on a line."""

    target: str
    loaded: Target
    config: Path | None
    settings: Mapping[str, str] = field(default_factory=dict)

    def stream(self) -> tuple[Target, StepStream, str]:
        name = "simulated " + ",".join(f"{key}={value}" for key, value in self.settings.items())
        loaded, steps = self._on_a_line() if "line" in self.settings else (self.loaded, self._alone())
        lines, first = tuple(range(1, len(steps) + 1)), first_values(steps)
        return loaded, StepStream(tuple(steps), lines, first, loaded.name), name

    @property
    def _seed(self) -> int:
        text = self.settings.get("seed", "0")
        if not text.isdecimal():
            raise InputError(f"--simulate seed={text}: a seed is a whole number from 0 on.")
        return int(text)

    def _alone(self) -> Steps:
        of_lines = [key for key in self.settings if key != "seed"]
        if of_lines:
            raise InputError(f"--simulate {of_lines[0]}: only a line has it; give line=NAME too.")
        if self.loaded.simulate is None:
            raise InputError(
                f"{self.loaded.name} has no simulation; give a recording in --around, or line=NAME in --simulate."
            )
        return self.loaded.simulate(self._seed)

    def _on_a_line(self) -> tuple[Target, Steps]:
        from safeloc.cli.simulate_line import LineOptions, runs_on_line  # numpy is loaded only where it is needed

        vehicles = (self.settings["vehicle"],) if "vehicle" in self.settings else ()
        faults = (self.settings["faults"],) if self.settings.get("faults") else ()
        options = LineOptions((self.loaded.name,), vehicles, faults=faults, seed=self._seed)
        run = runs_on_line(self.settings["line"], options)[0]
        loaded = self.loaded
        if self.config is None and run.stream.config != loaded.config:
            loaded = replace(ENTRIES[self.target].make(run.stream.config), spec=self.target)
        return loaded, list(run.stream.steps)
