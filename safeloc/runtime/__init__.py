"""What runs a machine: the border, records and steps, controllers in a host, a process of its own."""
