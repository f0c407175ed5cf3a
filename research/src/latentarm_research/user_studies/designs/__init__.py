"""What depends on whether a person meets every condition or one alone, behind one interface."""
