"""What is legal: bounds of numbers, fetches, coverage and visibility, the same for all methods."""
