"""Recordings that a configuration cannot take are left out, each with its reason, by every command that runs them."""

from __future__ import annotations

from pathlib import Path

from safeloc.assurance.mutation.declared import declared
from safeloc.catalogue import load_target
from safeloc.proof.verification.other_figures import refused_recordings, with_fitting_recordings


def test_recordings_of_inputs_that_are_not_there_are_left_out(tmp_path: Path) -> None:
    """Two tracks have no inputs of a third one; the mutants of that machine are judged without these recordings."""
    figures = tmp_path / "two.toml"
    figures.write_text("tracks = 2\n", encoding="utf-8")
    target = load_target("occupied_track", figures)
    refused = refused_recordings(target)
    assert set(refused) == set(target.streams) != set()
    assert all("occupied_track has no input 'track_3_of_edge'" in why for why in refused.values())
    assert () == with_fitting_recordings(target).streams == declared("occupied_track", figures)[0].streams


def test_recordings_that_fit_stay(tmp_path: Path) -> None:
    """Under other figures that change no input, and under the figures of the recordings, of which none is run for that."""
    figures = tmp_path / "same.toml"
    figures.write_text("tracks = 4\n", encoding="utf-8")
    for target in (load_target("occupied_track", figures), load_target("occupied_track")):
        assert with_fitting_recordings(target).streams == target.streams != ()
