"""Known bugs: each a program with one method overridden; broken ports, mutants and suspects are the same classes."""
