"""Methods as programs, a class a stage, in the words of the contract: the port, its legal variants, and what judges both."""
