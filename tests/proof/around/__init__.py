"""Tests of proofs around a stream."""
