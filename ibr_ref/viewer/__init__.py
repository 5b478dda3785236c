"""A page to look at a scene with, on this machine: `view(scene)` in a notebook, `ibr-ref view` on the command line.

Orbit, pan and zoom by mouse; a slider for every parameter; two systems, or a port's drawing, under a wipe; every array of
every stage as a picture, and all numbers of the pixel under the mouse. The page is served on loopback alone, to whoever has
the token in its address. Nothing is loaded from anywhere else.
"""

from ibr_ref.viewer.embedded import View, view
from ibr_ref.viewer.server import Server
from ibr_ref.viewer.session import Session, Subject

__all__ = ["Server", "Session", "Subject", "View", "view"]
