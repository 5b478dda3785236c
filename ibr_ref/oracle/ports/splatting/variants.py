"""Ports of splatting that are right, each in its own way, with the tightest device profile that explains it.

Splatting filters nothing and interpolates nothing: 8-bit weights and varyings over unsnapped triangles are no variants here.
"""

from __future__ import annotations

from typing import Any

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.faults.kinds import Variant
from ibr_ref.oracle.ports.splatting import orders
from ibr_ref.oracle.ports.splatting.port import Port, with_stage


class AllAtOnce(Port):
    """Other orders in every stage that has one."""

    vertex = type("AllOrders", (orders.ClipFromWorld, orders.Viewport, orders.HornersLaw, orders.CosinesOnly), {})
    raster = orders.Quads


class OwnNormals(Port):
    """Points are lit with the port's own normals, not with those that the case hands over."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """Without the case's inputs."""
        super().__init__(scene, params, policy, {})


_FLOAT32 = Policy()
_ALL = Policy(loose=2, seed=5, backwards=True, subpixel_rounding="down", depth_bits=24, color_bits=8)

VARIANTS: tuple[Variant, ...] = (
    Variant("float64", Policy(float_bits=64), "ieee32"),
    Variant("float32", _FLOAT32, "ieee32"),
    Variant("backwards-sums", Policy(backwards=True), "ieee32"),
    Variant("fused", Policy(fused=True), "ieee32"),
    Variant("fused-backwards", Policy(fused=True, backwards=True), "ieee32"),
    Variant("clip-from-world", _FLOAT32, "ieee32", with_stage(orders.ClipFromWorld)),
    Variant("clip-from-reference", _FLOAT32, "ieee32", with_stage(orders.ClipFromReference)),
    Variant("inverse-intrinsics", _FLOAT32, "ieee32", with_stage(orders.InverseIntrinsics)),
    Variant("viewport", _FLOAT32, "ieee32", with_stage(orders.Viewport)),
    Variant("horners-law", _FLOAT32, "ieee32", with_stage(orders.HornersLaw)),
    Variant("cosines-only", _FLOAT32, "ieee32", with_stage(orders.CosinesOnly)),
    Variant("whole-codes", _FLOAT32, "ieee32", with_stage(orders.WholeCodes)),
    Variant("pow", Policy(intrinsic_power=True), "ieee32"),
    Variant("pow-loose", Policy(intrinsic_power=True, loose=2, seed=3), "vulkan"),
    Variant("own-normals", _FLOAT32, "ieee32", OwnNormals, ("atlas.normal",)),
    Variant("truncating", Policy(truncated=True), "d3d11"),
    # Rounded correctly, 255 (k / 255) is k for every byte, and the port the plain one.
    Variant("normals-as-floats", Policy(truncated=True), "d3d11", with_stage(orders.FloatCodes)),
    Variant("reciprocals", Policy(reciprocal=True), "vulkan"),
    Variant("loose-quotients-1", Policy(loose=2, seed=1), "vulkan"),
    Variant("loose-quotients-2", Policy(loose=2, seed=2), "vulkan"),
    Variant("4-subpixel-bits", Policy(subpixel_bits=4), "gl,subpixel_bits=4"),
    Variant("4-subpixel-bits-truncated", Policy(subpixel_bits=4, subpixel_rounding="down"), "gl,subpixel_bits=4"),
    Variant("subpixels-up", Policy(subpixel_rounding="up"), "vulkan"),
    Variant("subpixels-truncated", Policy(subpixel_rounding="down"), "vulkan"),
    Variant("quads", _FLOAT32, "vulkan", with_stage(orders.Quads)),
    Variant("depth-24", Policy(depth_bits=24), "vulkan"),
    # Looser in sums and products than any interface grants: in the profile with the most room.
    Variant("jitter-1", Policy(jitter=1, seed=1), "gl"),
    Variant("jitter-2", Policy(jitter=2, seed=2), "gl"),
    Variant("jitter-3", Policy(jitter=2, seed=3), "gl"),
    Variant("bytes", Policy(color_bits=8), "gl"),
    Variant("all-at-once", _ALL, "gl", AllAtOnce),
)
