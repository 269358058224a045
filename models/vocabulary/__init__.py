"""What several modes share: error laws, intervals, the odometer between references, reasons, reflector models."""
