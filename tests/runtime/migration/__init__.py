"""Files of version 0.1.0 as files of today."""
