"""Simulated radar, map and odometer of many vehicles with the reflector machine at once, and the scenes that they meet."""
