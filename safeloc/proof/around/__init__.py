"""Proofs about one journey and everything near it: all streams of sensor values in a tube around a given one.

deviations.py   how far each input may deviate, be missing or come late
tube.py         the inputs of each cycle that this allows
intervals.py    bounds of terms, by which a step is folded
course.py       some cycles of the machine from a set of states on, as terms
hand_over.py    the proved set of states after some cycles
windows.py      the stream window by window: claims asked, states handed over
members.py      a stream of the tube that obeys the world's laws, or the cycle from which on there is none
nearest.py      the smallest factor on all widths at which a stream breaks a claim
proving.py      all of it for one target
"""
