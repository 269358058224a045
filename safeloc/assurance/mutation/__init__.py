"""Mutation analysis: machines with one deliberate error (mutants), and the properties, proofs and recordings that detect them."""
