"""The teleoperation page: its server, and the process that drives the arm for it."""
