"""Design of a line: which references may be left out and which have to be added, at least cost, so that audit and proofs hold."""
