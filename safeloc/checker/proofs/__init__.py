"""Check of proofs written by cvc5, step by step, by rules of our own.

Only `solver` uses cvc5; it returns plain data, and `check` trusts no part of these.
"""
