"""How the command line begins: at once, with all commands known by name, and nothing loaded that is not needed."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from functools import cache
from importlib import metadata
from pathlib import Path

import pytest

from safeloc.cli.commands import COMMANDS, loaded
from tests.cli.calling import Call

ROOT = Path(__file__).parents[2]
SOLVERS_AND_SIMULATION = {"cvc5", "hypothesis", "jinja2", "networkx", "numpy", "pytest", "scipy", "transitions", "z3"}
LOADED = """
import atexit, json, sys
atexit.register(lambda: print(json.dumps(sorted(sys.modules)), file=sys.stderr))
from safeloc.cli import main
main()
"""


@cache
def modules(*arguments: str) -> frozenset[str]:
    """What `safeloc ARGUMENTS` has loaded at its end."""
    command = [sys.executable, "-c", LOADED, *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return frozenset(json.loads(done.stderr.splitlines()[-1]))


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["prvoe"], []])
def test_what_needs_no_command_loads_none(arguments: list[str]) -> None:
    """Help, version and a wrong name come without solvers, simulation, and machines."""
    found = modules(*arguments)
    assert "safeloc.cli.entry" in found
    assert set() == found & SOLVERS_AND_SIMULATION
    assert {"safeloc.cli.commands", "safeloc.cli.console", "safeloc.cli.entry"} == {
        name for name in found if name.startswith("safeloc.cli.")
    }
    assert [] == [
        name for name in found if name.startswith(("safeloc.catalogue", "safeloc.models", "safeloc.proof.provers"))
    ]


def test_help_loads_no_configurations() -> None:
    """Nor what checks them; where a word has to be read, Typer loads the same package by itself."""
    assert "pydantic" not in modules("--help")


@pytest.mark.parametrize("arguments", [["list"], ["list", "properties", "--machine", "odometry"]])
def test_listing_loads_no_solver(arguments: list[str]) -> None:
    """Machines are made of the kernel alone, so listing them waits for no solver and no simulation."""
    found = modules(*arguments)
    assert "safeloc.models.odometry" in found
    assert set() == found & SOLVERS_AND_SIMULATION


def test_help_lists_every_command(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each by its name with its line, in the order of the table."""
    monkeypatch.setenv("COLUMNS", "300")
    called = call("--help")
    rows = [line.strip("│ ").split(maxsplit=1) for line in called.out.splitlines() if line.startswith("│")]
    known = [[name, one.summary] for name, one in COMMANDS.items()]
    assert (0, known) == (called.code, [[name, text.strip()] for name, text in rows if not name.startswith("--")])


def test_the_commands_are_these() -> None:
    """None is lost or added by accident."""
    names = (
        "init list docs import audit drive guard export simulate run recheck migrate cache prove explain test replay step report open mutate cores "
        "margins campaign faults verify"
    )
    assert names.split() == list(COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_is_what_its_line_says(name: str) -> None:
    """The line in the table is the first paragraph of the command's own help, which stands with its function."""
    command = loaded(name)
    assert (name, COMMANDS[name].summary) == (command.name, " ".join(command.help.split("\n\n")[0].split()))


def test_a_commands_own_help(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is that of the command itself, with all its options, under the name of the whole."""
    monkeypatch.setenv("COLUMNS", "300")
    called = call("prove", "--help")
    assert (0, "") == (called.code, called.err)
    assert "Usage: safeloc prove [OPTIONS]" in called.out
    assert "--property" in called.out
    assert COMMANDS["prove"].summary in called.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["prvoe"], "No such command 'prvoe'. Did you mean 'prove'"),
        (["trains"], "No such command 'trains'"),
        (["--depth", "3", "prove"], "No such option: --depth"),
    ],
)
def test_unknown_commands(call: Call, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str) -> None:
    """What there is not is told, with what is called nearly so; exit code 2."""
    monkeypatch.setenv("COLUMNS", "300")
    called = call(*arguments)
    assert (2, "") == (called.code, called.out)
    assert message in called.err


def test_the_version_is_the_packages(call: Call) -> None:
    """`--version` tells what is installed, which is what the project declares."""
    called = call("--version")
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert (0, f"safeloc {metadata.version('safeloc')}\n") == (called.code, called.out)
    assert called.out == f"safeloc {declared}\n"


def test_a_checkout_that_is_not_installed_has_no_version(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """That is said; it is no failure."""

    def missing(name: str) -> str:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", missing)
    called = call("--version")
    assert (0, "safeloc (no version: this checkout is not installed)\n") == (called.code, called.out)


def test_as_a_module() -> None:
    """`python -m safeloc` is the command line: the same output, and the same exit code."""
    good = subprocess.run(
        [sys.executable, "-m", "safeloc", "list", "lines"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (0, "") == (good.returncode, good.stderr)
    assert "fig3" in good.stdout
    wrong = subprocess.run(
        [sys.executable, "-m", "safeloc", "trains"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (2, "") == (wrong.returncode, wrong.stdout)
    assert "Usage: safeloc [OPTIONS] COMMAND" in wrong.stderr
