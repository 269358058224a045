"""The bars of `verify`: never beyond their end, and all at their end when all is over."""

from safeloc.catalogue import load_target
from safeloc.cli.verifying import Verifying
from safeloc.proof.verification.many import Began, Found, Kept, Over
from safeloc.proof.verification.one import expected


def test_a_bar_does_not_pass_its_end() -> None:
    """More findings may come than could be foreseen: runs to cases that a search found."""
    one, other = load_target("turn_off"), load_target("emitter")
    most = expected(one)
    with Verifying([one, other], quiet=True, seconds={}, jobs=2) as events:
        events(Began(one.name, most))
        for number in range(most + 5):
            events(Found(one.name, f"{one.name}/property/{number}", "proved", 0.1))
        assert events.done == {"all machines": (most, most + expected(other)), one.name: (most, most)}
        events(Over(one.name, 3.0))
        events(Kept(other.name, 7, "2026-01-01T00:00:00Z"))
        assert events.done == {"all machines": (most + expected(other), most + expected(other))}
    assert events.taken == {one.name: 3.0}
