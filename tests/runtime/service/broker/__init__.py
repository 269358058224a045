"""Many vehicles over a broker."""
