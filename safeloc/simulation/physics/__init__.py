"""Errors of sensors from their physics, not from the law that a proof assumes of them: so the law may break, and a campaign says how often.

Arrays are over vehicles; a vehicle alone comes out bit by bit as it does among others. So what is computed over several vehicles at
once adds, multiplies, divides and compares; every other function is applied to one vehicle's numbers at a time.
"""
