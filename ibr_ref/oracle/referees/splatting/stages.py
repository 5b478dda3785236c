"""Every stage of which a port handed in an array, judged on its own inputs."""

from __future__ import annotations

from collections.abc import Iterator

from ibr_ref.array_types import Bools
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.splatting import pixels, points, raster, texels
from ibr_ref.oracle.referees.splatting.blends import SUMS
from ibr_ref.oracle.referees.splatting.model import Model
from ibr_ref.oracle.referees.splatting.pixels import fewest

ARRAYS = {
    "normals": ("atlas.normal",),
    "atlas": texels.ARRAYS,
    "vertex": points.ARRAYS,
    "raster": (*raster.ARRAYS, *SUMS),
    "resolve": ("color", "depth"),
}
"""For each stage the arrays that it is compared by."""
STAGES = tuple(ARRAYS)
SAMPLED = ("normals", "vertex", "image")
"""Of which some elements are sooner judged than all."""
START = 100
"""What setting up a program costs, in rows of a march."""


class Stages:
    """A port's stages by one program; of normals, points and a picture by itself those `among` alone.

    right: by the right program, where this one has a bug. thorough: also where depths are contradicted points are lit.
    """

    def __init__(
        self,
        model: Model,
        handed: Handed,
        among: Bools | None = None,
        right: Stages | None = None,
        *,
        thorough: bool = False,
    ) -> None:
        self.port: points.Port = points.Port(model, handed, right.port if right else None)
        self.among, self.thorough = among, thorough

    @property
    def cost(self) -> int:
        """In rows of a march: those of this program are a sixteenth as long."""
        return START + self.port.model.machine.run.rows // 16

    def judgements(self) -> Iterator[Judgement]:
        """Of what was handed in, in pipeline order."""
        return (self.judge(stage) for stage in STAGES if self.names(stage))

    def names(self, stage: str) -> tuple[str, ...]:
        """What of a stage was handed in."""
        return tuple(name for name in ARRAYS[stage] if name in self.port.handed)

    def judge(self, stage: str) -> Judgement:
        """One stage, or "image"."""
        if stage == "normals":
            return texels.judge_normals(self.port, self.among)
        if stage == "atlas":
            return texels.judge_atlas(self.port)
        if stage == "image":
            return pixels.judge_image(self.port, self.among, thorough=self.thorough)
        return fewest([self._judge(stage, port) for port in self.port.ways])

    def _judge(self, stage: str, port: points.Port) -> Judgement:
        if stage == "vertex":
            return points.judge_vertex(port, self.among)
        judges = {"raster": raster.judge_raster, "resolve": pixels.judge_resolve}
        return judges[stage](port)
