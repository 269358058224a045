"""Machines and enumerations of theorems that only tests prove: no part of the package."""
