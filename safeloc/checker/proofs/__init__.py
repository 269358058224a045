"""Proofs that cvc5 writes, checked step by step by rules of our own.

Only `solver` asks cvc5; what it hands over is data that `check` takes nothing for granted of.
"""
