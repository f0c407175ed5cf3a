"""Shared autonomy: the belief over the person's goal, the assistive action, and arbitration."""
