"""The reproduction of Yoo & Han 2006."""

from ibr_ref.reproduce.displacement import figure_14, figures_3_and_6, figures_15_and_16, speed, table_1, table_2
from ibr_ref.reproduce.findings import Reproduction, Step

REPRODUCTION = Reproduction(
    number=1,
    method="displacement",
    paper="Yoo & Han 2006: Displacement mapping for the precise representation of protrusion",
    steps=(
        Step(name="table-1", title="Table 1: searches", run=table_1.run),
        Step(name="table-2", title="Table 2: what each system can show", run=table_2.run),
        Step(name="figure-3", title="Figure 3", run=figures_3_and_6.figure_3),
        Step(name="figure-6", title="Figure 6", run=figures_3_and_6.figure_6),
        Step(name="figure-14", title="Figure 14", run=figure_14.run),
        Step(name="figure-15", title="Figure 15", run=figures_15_and_16.figure_15),
        Step(name="figure-16", title="Figure 16", run=figures_15_and_16.figure_16),
        Step(name="speed", title="Section 5: speed", run=speed.run),
    ),
    ambiguities=(
        (
            "How many auxiliary faces? The paper draws two, by the direction of view.",
            "All sides of the volume that are turned away from the eye: two seen obliquely, up to four from above.",
        ),
        (
            "What a search that stops nowhere shows.",
            "Over the polygon, the polygon itself; elsewhere nothing (the paper's alpha blending).",
        ),
        (
            "Which way the binary search ends.",
            "At the first lattice point known to be inside: never in front of the surface by more than a step.",
        ),
        (
            "a, the height before the stop, where that sample lies beside the map (figure 13).",
            "0: the ground around; so the sides of the volume count as steep walls.",
        ),
        (
            "The threshold is to be fitted to the picture's and the map's resolution; no value is given.",
            "0.1 of the volume's height everywhere; figure 14 shows what others do.",
        ),
        (
            "The earlier systems' parameters are not given.",
            "Those of their authors' programs where there are any (Tatarchuk 8 to 50 steps, relaxed cones 15 + 8); the "
            "table says which.",
        ),
        (
            "Where earlier systems fetch from beside a map that ends.",
            "Nothing is there: such a pixel is empty, as in figure 3 (b) and (c).",
        ),
        (
            "McGuire's LOD bias adds to the level of the pixel's footprint.",
            "The footprint's level counts as 0 here, as no other system filters the heights either.",
        ),
        (
            "The paper's box, city and textures are not published.",
            "A box and a city made by formula, of the same map sizes; the city is not Seoul's.",
        ),
    ),
)
