"""Terms that several machines share: error laws, intervals, the odometer between references, reasons, reflector models."""
