"""Which parts of its method a case uses: by these the sections of its README are chosen (`ibr_ref.pages`)."""

from __future__ import annotations

from ibr_ref.oracle.schema.displacement import DisplacementParams, DisplacementScene
from ibr_ref.oracle.schema.document import DisplacementCase, Document, ShadowsCase, SplattingCase
from ibr_ref.oracle.schema.shadows import ShadowsParams
from ibr_ref.oracle.schema.splatting import SplattingParams, SplattingScene


def features(document: Document) -> frozenset[str]:
    """The words that the pages' marks may have, of one case."""
    if isinstance(document, DisplacementCase):
        found = _displacement(document.params, document.scene)
    elif isinstance(document, SplattingCase):
        found = _splatting(document.params, document.scene)
    elif isinstance(document, ShadowsCase):
        found = _shadows(document.params)
    return frozenset({document.method} | found)


def _displacement(params: DisplacementParams, scene: DisplacementScene) -> set[str]:
    found = {
        "phong",
        params.interval,
        params.faces,
        "shadow" if params.shadow_steps else "unshadowed",
        "polygon_depth" if params.depth == "polygon" else "displaced",
    }
    for polygon in scene.polygons:
        found.add("heights" if polygon.normal_map is None else "normal_map")
        if polygon.facade_map is not None:
            found.add("facade")
    if found & {"heights", "facade"}:
        found.add("gradient")
    return found


def _splatting(params: SplattingParams, scene: SplattingScene) -> set[str]:
    return {params.shape, "normals", "unlit" if scene.light is None else "phong"}


def _shadows(params: ShadowsParams) -> set[str]:
    found: set[str] = {params.method, params.content, params.accumulation}
    if params.method == "warp":
        found.add(params.policy)
    if params.content == "depth":
        found |= {word for word, used in (("pcf", params.pcf), ("quantize", params.quantize is not None)) if used}
    return found
