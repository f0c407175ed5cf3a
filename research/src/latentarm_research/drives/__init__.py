"""The simulated drive that commands and studies share: who drives, how it went, how it is shown."""
