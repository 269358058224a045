"""Notes on claims of a user's machine that read an absent input, which a proof takes for the number that is stored."""

from __future__ import annotations

from collections.abc import Iterable

from safeloc.catalogue import Target
from safeloc.cli.console import out, print_line
from safeloc.language.absent_readings import read_while_absent
from safeloc.language.system import canonical


def print_absent_readings(targets: Iterable[Target]) -> None:
    """Print a note for each claim of a machine of one's own that reads an input also while it is absent.

    Claims of machines that ship are left out: there conditions on the state imply that the input is present.
    """
    for target in (one for one in targets if ":" in one.spec):
        for claim in target.properties:
            for option in read_while_absent(target.system, claim):
                out.print("")
                print_line(
                    f"note: the claim {claim.name!r} ({claim.src}) reads {option.value.name} also while it is absent; it is "
                    f"then {canonical(option.value)}. Unless another condition implies that it is present, write "
                    f"{option.value.name}.present.implies(...), or {option.value.name}.present & ..."
                )
