"""The commands by name: what each is for, in a line, and where it stands. Its module is loaded only when it is called."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import typer
from typer.main import get_command


@dataclass(frozen=True)
class Known:
    """What is known of a command before its module is loaded.

    module, function  where it stands
    summary           the first paragraph of its own help (a test compares them)
    """

    module: str
    function: str
    summary: str


COMMANDS: Mapping[str, Known] = {
    "list": Known(
        "listing",
        "list_",
        "List machines, properties, requirements with the transitions and properties that answer for them, or lines.",
    ),
    "import": Known(
        "line_import", "import_line", "Import a map; what was not understood, not carried over or assumed is told."
    ),
    "audit": Known(
        "audit",
        "audit_line",
        "Check that the layout of a line meets what the proofs assume. Exit code 1 where a rule is violated.",
    ),
    "drive": Known(
        "line_drive",
        "drive",
        "Drive a recorded train over a network: odometers, balise readers at both ends, satellites and the trusted truth.",
    ),
    "guard": Known(
        "guard",
        "guard",
        "Guard a receiver: each position with its interval along the track, or the reason why it is withheld.",
    ),
    "export": Known("export", "export", "Write a machine in another form."),
    "simulate": Known(
        "simulate",
        "simulate",
        "Write simulated sensors, with the truth beside them: of a machine by itself, or of vehicles on a line.",
    ),
    "run": Known(
        "run",
        "run",
        "Run a machine as a process of its own: lines in, one report a cycle out, until SIGTERM or the end of the lines.",
    ),
    "recheck": Known(
        "recheck",
        "recheck",
        "Check every proof of a report again, from its files and the declaration alone.",
    ),
    "cache": Known("keeping", "cache", "Say how much earlier runs left behind, and take it away."),
    "prove": Known(
        "verify",
        "prove",
        "Prove the properties and obligations of a machine for all streams that obey its assumption.",
    ),
    "test": Known("verify", "test", "Run property tests along plausible and faulty streams."),
    "replay": Known("verify", "replay", "Run a recorded stream through a machine and check every property on it."),
    "report": Known("verify", "report", "Render the page of a report folder again, or write out what is packed in it."),
    "verify": Known("verify", "verify", "Prove, test, replay the shipped streams, and write the report: the main job."),
}


def loaded(name: str) -> Any:
    """The command itself, as Typer makes it of its function."""
    known = COMMANDS[name]
    alone = typer.Typer(add_completion=False)
    alone.command(name)(getattr(import_module(f"safeloc.cli.{known.module}"), known.function))
    return get_command(alone)
