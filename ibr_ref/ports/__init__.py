"""Sample ports: the three methods as their users write them, drawn from exported case folders alone.

`python -m ibr_ref.ports CASE OUT` draws a case in GLSL. Nothing here, but `described`, imports anything else of the package:
a port in another language has the folder alone.
"""
