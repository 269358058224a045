"""Start and end of a command: find it by name, and turn its result or failure into an exit code.

0    all holds
1    something is violated
2    no result: wrong usage or input, or safeloc itself failed
3    undecided within the limits
130  interrupted (Ctrl-C)
141  the reader of the output closed the pipe
"""

from __future__ import annotations

import os
import sys
import traceback
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from safeloc.cli.commands import COMMANDS, loaded
from safeloc.cli.console import err
from safeloc.errors import SafelocError

_NO_RESULT, INTERRUPTED, CLOSED_PIPE = 2, 130, 141


class _Commands(TyperGroup):
    """The commands. Only names and summaries are known until one is called.

    An exception gives exit code 2: Python's own code for it, 1, means `violated` here.
    """

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = {name: TyperCommand(name, help=known.summary) for name, known in COMMANDS.items()}

    def resolve_command(self, ctx: Any, args: Any) -> Any:
        """Return the command that is called, loaded from its module."""
        name, known, rest = super().resolve_command(ctx, args)
        return name, known if name is None else loaded(name), rest

    def invoke(self, ctx: Any) -> Any:
        """Run one command."""
        try:
            try:
                return super().invoke(ctx)
            finally:
                sys.stdout.flush()  # here, where a closed pipe can still be distinguished from other errors
                _say_what_was_not_kept()
        except SafelocError as error:
            err.print(f"safeloc: {error}", markup=False)
            raise typer.Exit(_NO_RESULT) from error
        except BrokenPipeError as error:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # otherwise Python prints an error at exit
            raise typer.Exit(CLOSED_PIPE) from error
        except KeyboardInterrupt as error:
            err.print("safeloc: interrupted; no result.", markup=False)
            raise typer.Exit(INTERRUPTED) from error
        except Exception as error:
            if type(error).__module__.split(".")[0] in ("typer", "click"):
                raise  # these end a command, or report wrong usage
            traceback.print_exception(error)
            err.print("safeloc: failed, as printed above; no result. Please report it.", markup=False)
            raise typer.Exit(_NO_RESULT) from error


def _say_what_was_not_kept() -> None:
    """Say that results were not kept, if that is so; the engine is looked up, not loaded, since most commands do without it."""
    engine = sys.modules.get("safeloc.proof.cache.engine")
    if engine is not None and engine.was_disturbed():
        err.print(
            "safeloc: files of safeloc were written during this run; what it found after that is not kept, and the next run finds it again.",
            markup=False,
            soft_wrap=True,
        )


app = typer.Typer(cls=_Commands, add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"safeloc {_version()}")
        raise typer.Exit


def _version() -> str:
    from importlib import metadata  # slow to load; no other command needs it

    try:
        return metadata.version("safeloc")
    except metadata.PackageNotFoundError:
        return "(no version: this checkout is not installed)"


@app.callback()
def safeloc(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """Prove, test, replay and report how a train is located."""


def main() -> None:
    """Run the command line."""
    app(prog_name="safeloc")
