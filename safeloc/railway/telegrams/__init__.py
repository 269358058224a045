"""Telegrams and reports of ETCS as bit strings and as JSON with the names of SUBSET-026 (chapters 7 and 8)."""
