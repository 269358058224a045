"""Machines made wrong on purpose (mutants), and which of them properties, proofs and recordings notice."""
