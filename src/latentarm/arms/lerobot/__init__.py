"""Arms of LeRobot, such as the SO-101, driven next to their bus by a separate process."""
