"""Arms behind ros2_control, driven over rosbridge and past a watchdog that runs next to the arm."""
