"""Affine arithmetic on arrays (de Figueiredo & Stolfi 2004), compiled: what `oracle/arithmetic` asks of each operation.

A number is rows of n elements: value, error, deviation (error and all slopes), and its slope along each symbol. In NumPy a
product of two numbers with four symbols is some forty passes over short arrays, each of which costs more to start than to
run; here it is one.
"""
