"""Machines on measured data: input validation, records and steps, controllers in a host, the stand-alone process."""
