"""Template: a sensor's machine and a supervising one, composed; what the second assumes is proved from the first."""
