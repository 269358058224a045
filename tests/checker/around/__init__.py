"""The checker of proofs around a stream."""
