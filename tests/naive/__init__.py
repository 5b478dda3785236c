"""The naive twin: a second, plain implementation of the spec pages, written without sight of the package."""
