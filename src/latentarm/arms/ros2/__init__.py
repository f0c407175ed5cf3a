"""Arms behind ros2_control, driven over rosbridge through a watchdog that runs next to the arm."""
