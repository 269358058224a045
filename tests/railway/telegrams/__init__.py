"""Tests of the telegrams and reports of ETCS."""
