"""What moves: the contract between the control loop and an arm, and the arms behind it."""
