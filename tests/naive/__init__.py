"""The naive twin: a second, plain implementation of the methods' pages, written without sight of the package."""
