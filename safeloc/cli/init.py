"""`safeloc init`: write a project of the user's own, ready to be verified."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from safeloc.cli.console import err, out
from safeloc.templates.project import TEMPLATES, write_project


def init(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="a new folder, or an empty one; its name is the project's")
    ],
    template: Annotated[str, typer.Option("--template", help=f"{' or '.join(TEMPLATES)}")] = "machine",
) -> None:
    """Write a project of your own: machine, world, claims, a recording, tests and CI, verified as it stands."""
    for path in write_project(folder, template):
        out.print(str(path), markup=False)
    err.print(f"next: cd {folder}; make verify; then read README.md and {TEMPLATES[template].module}.py", markup=False)
