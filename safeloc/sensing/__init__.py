"""Raw signals of radar, fibre and satellites, turned into whole numbers with bounds."""
