"""Notes on claims of a user's machine that read an absent input, which a proof takes for the number that is stored."""

from __future__ import annotations

from collections.abc import Iterable

from safeloc.catalogue import Target
from safeloc.cli.console import out, print_line
from safeloc.language.system import canonical
from safeloc.proof.provers.absent_in_claims import read_while_absent


def print_absent_readings(targets: Iterable[Target]) -> None:
    """Print a note for each claim of a machine of one's own that depends on an input also while it is absent.

    Machines that ship have no such claim (tests/models/test_claims_on_absent_inputs.py).
    """
    for target in (one for one in targets if ":" in one.spec):
        for claim, option in read_while_absent(target.system, target.properties):
            out.print("")
            print_line(
                f"note: the claim {claim.name!r} ({claim.src}) depends on {option.value.name} also while it is absent; it is "
                f"then {canonical(option.value)}, which nobody measured. Write {option.value.name}.present.implies(...), or "
                f"{option.value.name}.present & ..."
            )
