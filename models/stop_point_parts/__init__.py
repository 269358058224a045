"""What the stop-point machine is made of: map data and measurements, one cycle, the table."""
