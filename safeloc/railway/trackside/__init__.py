"""The trackside process: areas of virtual sections that are fed by the reports of all their vehicles. See docs/trackside.md."""
