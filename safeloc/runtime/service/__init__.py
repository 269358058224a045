"""The stand-alone process: it reads lines and writes reports (MRK-3). See docs/embedding.md."""
