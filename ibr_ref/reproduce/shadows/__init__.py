"""Kang & Ihm 2002: tables 1 to 5, figures 4, 7, 8 and 9 to 12, and what the paper does not measure."""

from __future__ import annotations

from ibr_ref.reproduce.findings import Reproduction, Step
from ibr_ref.reproduce.shadows import figures, quality, times

REPRODUCTION = Reproduction(
    number=3,
    method="shadows",
    paper="Byungkwon Kang & Insung Ihm 2002, Real-Time Shadow Generation using Image Warping",
    steps=(
        Step(name="table-1", title="Complexity of the object", run=times.table_1),
        Step(name="tables-2-3-5", title="Rendered and warped, control points, light samples", run=times.by_samples),
        Step(name="table-4", title="Maps made beforehand, and memory", run=times.table_4),
        Step(name="complexity", title="From where on a warp is faster today", run=times.complexity),
        Step(name="maps", title="How near the maps come", run=quality.maps_quality),
        Step(name="soft", title="How near the soft shadows come", run=quality.soft_quality),
        Step(name="figure-4", title="Maps by place", run=figures.figure_4),
        Step(name="figure-7", title="Warped and rendered", run=figures.figure_7),
        Step(name="figure-8", title="Accumulated samples", run=figures.figure_8),
        Step(name="figures-9-12", title="Hard and soft shadows", run=figures.figures_9_to_12),
        Step(name="soft-figure", title="Soft shadows side by side", run=figures.soft_side_by_side),
    ),
    ambiguities=(
        (
            '"Three warps, like a bilinear interpolation": of which of the two images around, and are they mixed?',
            "Both policies exist: the nearer image alone (three warps), or both warped and mixed (six). The times are those "
            "of six, the slower and nearer one.",
        ),
        (
            "At what pace control points move between two maps.",
            'Evenly, as the paper\'s formula has it; interpolation="projective" takes the pace that perspective gives the '
            "caster's middle.",
        ),
        (
            "Control points are placed by hand; how, and how well, is not said.",
            "They are found by registration of warped on rendered maps, the same features marked in all nine.",
        ),
        (
            "What is in the time of a rendered shadow.",
            "The paper's includes reading the depth buffer back and making a texture; here a silhouette is rendered into "
            "memory, which is all that there is.",
        ),
        (
            '"Up to 15 times" for soft shadows.',
            "Its own table 5 has 13.6 at most (1,936 : 142 and 1,075 : 79); 13.3 and 12.4 at 256².",
        ),
        (
            "Where on the light 5 and 9 samples lie.",
            "At the centre and at two thirds of the half-edges: the centres of nine cells, two to four times nearer to the "
            "area light than samples on its border.",
        ),
        (
            "Whether the light's target moves with a sample.",
            "It does: otherwise the maps of the moved object do not match (the claim on the moved light has the number).",
        ),
        (
            "What an area light is, that few samples are compared with.",
            "The share of its area that the caster hides from a point, without the cosines of light and receiver: what "
            "samples of equal weight converge to. The caster's shadow upon itself is left out, as masks do.",
        ),
        (
            "Soler and Sillion's convolution for a scene of any shape.",
            "One plane halfway through the caster, four planes for the receivers; their subdivision into clusters is not "
            "built.",
        ),
        (
            "Percentage-closer soft shadows for a light that is not parallel to its map.",
            "The map is rendered parallel to the light, off the axis, around the caster; 32 points search a blocker, 64 "
            "filter, the same for every pixel.",
        ),
        (
            "The models and scenes are not published.",
            "Newell's teapot, a chair by formula, and the usual cow, on our stage.",
        ),
    ),
)
