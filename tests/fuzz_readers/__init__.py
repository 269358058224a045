"""Every reader is given anything: `python -m tests.fuzz_readers --seconds 600`."""
