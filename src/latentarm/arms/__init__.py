"""The contract between the control loop and an arm, and the arms."""
