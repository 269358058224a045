"""Complete verification of a target: proofs, obligations, property tests, replays.

one        a target from its properties to its findings, in one process
many       several targets at once, each in a separate process
plain      findings as plain data, for pipes and files
replay     a recorded stream through a machine
recordings single records as the steps of a machine
unasked    findings with the verdict "not asked"
"""
