"""The stand-alone process: lines in, reports out (MRK-3). See docs/embedding.md."""
