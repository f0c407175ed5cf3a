"""What is to be done with an arm: where it starts, what is wanted, when it is done, and who shows it."""
