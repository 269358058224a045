"""Parts of the axle-counter machines."""
