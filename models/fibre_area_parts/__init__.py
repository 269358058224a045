"""Parts of the fibre area: when a train enters and its record is due, and what of its ends is believed."""
