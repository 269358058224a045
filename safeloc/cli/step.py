"""The command `safeloc step`: run a machine by hand, in a terminal, also over ssh or from a script on standard input.

With the extra `step` a terminal shows a window (`step_window`); else, and from a script, commands are lines.
"""

from __future__ import annotations

import cmd
import importlib.util
import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from safeloc.catalogue import load_target
from safeloc.cli.console import print_line
from safeloc.cli.options import ConfigOption, TargetArgument
from safeloc.cli.step_lines import (
    assignments,
    broken_lines,
    end_told,
    number_of_steps,
    refuse_unknown,
    row_lines,
    words,
)
from safeloc.errors import InputError
from safeloc.explain.stepping import Stepper
from safeloc.proof.verification.replay import read_recording
from safeloc.runtime.streams.steps import StepStream
from safeloc.target import Target, find_recording

_HELP = """\
ENTER, step [N]       take one step, or N; an empty line of a script takes none
set NAME=VALUE ...    inputs of the next step: 12, true, a label, absent; after it they are recorded ones, or at rest
hold NAME=VALUE ...   the same in every step from now on, also over a recording: hold NAME=absent; `hold` alone: what is held
release NAME ...      hold it no more
rows                  of the next step: which transition of this mode would fire with the inputs as they stand, and what keeps the others
inputs  state  outputs  [WORD]   their values now; with a word, those that have it in their name
watch NAME ...        show these after each step; `watch` alone: nothing
broken                the properties that the run has broken; each is told at once, when a step breaks it
back [N]              take back one step, or N
save FILE             write the run as a stream for `safeloc replay`; save FILE.py: as a test for pytest
quit                  end"""


def step(
    target: TargetArgument,
    stream: Annotated[
        Path | None,
        typer.Argument(
            help="a recording whose inputs the steps take; or the name of one that ships", show_default=False
        ),
    ] = None,
    config: ConfigOption = None,
    lines: Annotated[
        bool, typer.Option("--lines", help="commands line by line, also where a window can be shown")
    ] = False,
) -> None:
    """Run a machine step by step: set inputs, see which transition fires and what refuses the others, go back, save the run."""
    loaded = load_target(target, config)
    recording = None if stream is None else read_recording(loaded, find_recording(loaded, stream))[0]
    first, inputs = ({}, []) if recording is None else (recording.first, _inputs(recording, loaded))
    stepper = Stepper(loaded, first, inputs, config)
    typed = sys.stdin.isatty()
    if typed and not lines and _can_show():
        from safeloc.cli.step_window import StepWindow  # an extra

        StepWindow(stepper).run()
        return
    shell = _Shell(stepper, prompting=typed)
    if typed:
        print_line("help lists the commands; quit or Ctrl-D ends.")
        shell.show()
    shell.tell_broken()
    shell.cmdloop()
    raise typer.Exit(2 if shell.failed and not typed else 0)


def _can_show() -> bool:
    """Return whether standard output is a terminal on which a window can be shown, and Textual is installed."""
    is_terminal = sys.stdout.isatty() and os.environ.get("TERM", "dumb") != "dumb"
    return is_terminal and importlib.util.find_spec("textual") is not None


def _inputs(recording: StepStream, target: Target) -> list[dict[str, object]]:
    """Return the inputs of each step, without remarks."""
    names = {var.name for var in target.system.inputs}
    return [{name: cell for name, cell in one.items() if name in names} for one in recording.steps]


class _Shell(cmd.Cmd):
    """Reads commands from standard input. A wrong one in a script is told and ends it."""

    def __init__(self, stepper: Stepper, *, prompting: bool) -> None:
        super().__init__()
        self.use_rawinput = prompting
        self._stepper, self._prompting, self._watched = stepper, prompting, list[str]()
        self._broken_laws, self._told_end, self._line = list[str](), False, 0
        self.failed = False
        self._prompt()

    def _prompt(self) -> None:
        self.prompt = f"{self._stepper.target.name} {self._stepper.number}> " if self._prompting else ""

    # -------------------------------------------------------------- the loop

    def onecmd(self, line: str) -> bool:
        """Run one command; an error of the user is told, in a script with its line."""
        self._line += 1
        try:
            return bool(super().onecmd(line))
        except InputError as error:
            print_line(f"safeloc: {'' if self._prompting else f'line {self._line}: '}{error}")
            self.failed = True
            return not self._prompting
        finally:
            self._prompt()

    def default(self, line: str) -> None:
        """Refuse a command that there is not."""
        if line == "EOF":
            raise EOFError
        raise InputError(f"{line.split()[0]!r} is no command; `help` lists them.")

    def emptyline(self) -> bool:
        """Take a step."""
        if self._prompting:
            self.do_step("")
        return False

    def do_EOF(self, _: str) -> bool:  # noqa: N802 # the name that `cmd` gives to the end of the input
        """End."""
        return True

    def do_quit(self, _: str) -> bool:
        """End."""
        return True

    def do_help(self, arg: str) -> None:
        """List the commands, or those with a word in their line."""
        every = _HELP.splitlines()
        for line in [one for one in every if arg in one] or every:
            print_line(line)

    # -------------------------------------------------------------- commands

    def do_step(self, text: str) -> None:
        """Take steps."""
        wanted = number_of_steps(text, "step")
        for taken in range(wanted):
            if self._ends_here(taken, wanted):
                break
            broken = self._stepper.broken_laws()
            made = self._stepper.take()
            print_line(f"{self._stepper.number:4}  {', '.join(made.fired.values())}")
            if broken != self._broken_laws:
                self._tell_laws(broken)
            self.tell_broken()
            self._show_watched()
        self.show()

    def tell_broken(self) -> None:
        """Tell the properties that the last step broke, with the parts that fail."""
        for line in broken_lines(self._stepper.broken_now()):
            print_line(f"      {line}")

    def _ends_here(self, taken: int, wanted: int) -> bool:
        """Say once that the recording has ended, and whether it ends here: no step is then taken with invented inputs."""
        recorded = len(self._stepper.recorded)
        if not recorded or self._told_end or self._stepper.number < recorded:
            return False
        self._told_end = True
        print_line(end_told(recorded, taken, wanted))
        return True

    def _tell_laws(self, broken: list[str]) -> None:
        self._broken_laws = broken
        for law in broken:
            print_line(f"      breaks the law {law}")
        print_line("      no proof speaks of what follows" if broken else "      every law is kept again")

    def do_set(self, text: str) -> None:
        """Set inputs of the next step."""
        for name, value in assignments(text):
            self._stepper.give(name, value)
        self.do_inputs("")

    def do_hold(self, text: str) -> None:
        """Hold inputs in every step."""
        for name, value in assignments(text):
            self._stepper.hold(name, value)
        print_line(f"held: {_joined(self._stepper.held)}")

    def do_release(self, text: str) -> None:
        """Hold inputs no more."""
        for name in words(text):
            self._stepper.release(name)
        print_line(f"held: {_joined(self._stepper.held)}")

    def do_rows(self, _: str) -> None:
        """Show the transitions of the present mode: of the next step, not of the last one, which `step` has told."""
        print_line(f"step {self._stepper.number + 1}, the next one, with the inputs as they stand:")
        for row in self._stepper.rows():
            for line in row_lines(row):
                print_line(line)

    def do_inputs(self, word: str) -> None:
        """Show the inputs of the next step."""
        self._values("inputs", self._stepper.inputs, word)

    def do_state(self, word: str) -> None:
        """Show the state."""
        self._values("state", self._stepper.state, word)

    def do_outputs(self, word: str) -> None:
        """Show the outputs."""
        self._values("outputs", self._stepper.outputs, word)

    def do_watch(self, text: str) -> None:
        """Choose what is shown after every step."""
        refuse_unknown(words(text), self._stepper.watchable)
        self._watched = words(text)
        print_line(f"watched after each step: {'  '.join(self._watched) or 'nothing'}")

    def do_broken(self, _: str) -> None:
        """Show the properties that the run has broken."""
        broken = self._stepper.broken()
        for name, at in broken.items():
            print_line(f"broken at step {at}: {name}")
        for at, names in _by_step(self._stepper.without_assumption()).items():
            print_line(f"claim nothing since step {at}, which broke their assumption: {', '.join(names)}")
        if not broken:
            print_line("no property is broken so far")

    def do_back(self, text: str) -> None:
        """Take steps back."""
        self._stepper.back(number_of_steps(text, "back"))
        self.show()

    def do_save(self, text: str) -> None:
        """Write the run."""
        if not text:
            raise InputError("save needs the name of a file.")
        try:
            self._stepper.save(Path(text))
        except OSError as error:
            raise InputError(f"{text}: cannot be written: {error.strerror}.") from error
        print_line(f"{self._stepper.number} steps: {text}")

    # -------------------------------------------------------------- showing

    def show(self) -> None:
        """Show the modes."""
        state = self._stepper.state
        self._values("", {name: value for name, value in state.items() if name.split(".")[-1] == "mode"}, "")

    def _show_watched(self) -> None:
        """Show what is watched, once after each step."""
        if self._watched:
            known = self._stepper.watchable
            self._values("", {name: known[name] for name in self._watched}, "")

    def _values(self, what: str, values: dict[str, str], word: str) -> None:
        chosen = {name: value for name, value in values.items() if word in name}
        if word and not chosen:
            raise InputError(f"no name of {what} has {word!r} in it.")
        print_line(f"{what}: {_joined(chosen)}" if what else f"      {_joined(chosen)}")


def _by_step(names: dict[str, int]) -> dict[int, list[str]]:
    return {at: [name for name, step in names.items() if step == at] for at in sorted(set(names.values()))}


def _joined(values: dict[str, str]) -> str:
    return "  ".join(f"{name}={value}" for name, value in values.items()) or "none"
