"""What a program computes on: a device's numbers, or numbers with bounds, whose decisions fork."""
