"""Campaigns: many simulated vehicles, drawn from declared distributions, and what can honestly be said of them.

declaration, distributions   the TOML file
scenes                       machine and simulation of a stratum; the draws
judged, counted              laws and intervals of every vehicle-cycle; the table of a shard
shards, schedule             what is run as one; where it runs
statistics, aggregate        estimates with intervals
kept                         streams of what was found
"""
