"""The three methods as someone ports them, in plain NumPy: right ones and broken ones, to try the oracle on."""
