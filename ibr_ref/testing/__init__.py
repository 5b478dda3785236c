"""Random scenes for property-based tests, and ports hunted with them. Needs Hypothesis: `pip install "ibr_ref[hypothesis]"`.

    from ibr_ref import testing

    def test_my_port():
        testing.assert_port(my_port.draw, method="displacement", device="vulkan")

`cases(method)` is a strategy for `oracle.Case`s that a right port passes, small ones that shrink towards the simplest
scene; what they are made of, polygons, cameras, lights, meshes, depth images and parameters, lies in `testing.displacement`,
`testing.splatting` and `testing.shadows`. `Hunt` looks for one bug after another, as `ibr-ref hunt` does.
"""

from ibr_ref.testing.cases import cases
from ibr_ref.testing.door import Door
from ibr_ref.testing.hunting import Found, Hunt
from ibr_ref.testing.judging import Bug, PortError, bug_of, drawing
from ibr_ref.testing.ports import Drawer, Program, Served, port_of
from ibr_ref.testing.properties import assert_port

__all__ = [
    "Bug",
    "Door",
    "Drawer",
    "Found",
    "Hunt",
    "PortError",
    "Program",
    "Served",
    "assert_port",
    "bug_of",
    "cases",
    "drawing",
    "port_of",
]
