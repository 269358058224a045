"""A proof around a stream, shown again: from its certificate the checker takes the hand-over sets alone.

question   the certificate as it was read, and the machine, claims and stream that it is about
tube       what each cycle of the tube allows, as nodes
folding    terms with what is decided by bounds folded away
windows    the cycles of a window from a set of states, and what has to follow from them
streams    single streams: whether they are lawful, in the tube, and break a claim
checking   a folder that `safeloc prove --around` wrote

Tube, folding and windows share nothing with the prover's.
"""
