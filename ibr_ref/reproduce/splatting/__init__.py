"""The second paper: splatting of depth images."""

from ibr_ref.reproduce.findings import Reproduction, Step
from ibr_ref.reproduce.splatting import figures, quality, selection, speed

REPRODUCTION = Reproduction(
    number=2,
    method="splatting",
    paper="Lee & Park 2006, Accelerating Depth Image-Based Rendering Using GPU",
    steps=(
        Step(name="figures", title="Figures 1, 3, 5 and 6", run=figures.run),
        Step(name="tables", title="Tables 1 and 2: speed", run=speed.run),
        Step(name="quality", title="Holes, overdraw and decibels", run=quality.run),
        Step(name="references", title="Which references to keep", run=selection.run),
    ),
    ambiguities=(
        (
            "The law's coefficients are empirical, and not given.",
            "Both ways: by hand sqrt(2) times the size of a pixel that faces both cameras, alpha/d; and fitted to the 95 % "
            "quantile of the widths that the points need.",
        ),
        (
            "What OpenGL draws in tables 1 and 2 is not said, only that widths need the CPU.",
            "Points of a constant size, two pixels, with the light baked in: what a fixed-function pipeline does by itself.",
        ),
        (
            "Table 2 is of Ballet, with 1, 4 and 8 cameras of 1024 x 768; the caption of figure 4 says 2048 x 1536.",
            "786,432 points an image are 1024 x 768; two cameras of Breakdancers, in turn.",
        ),
        (
            "32 references of 256 x 256 do not fit into one texture of 1024 x 1024.",
            "Up to four textures, filled in shelves in input order.",
        ),
        (
            "Lighting is said to be in the vertex stage (3.2, 3.4) and in the fragment stage (3.2).",
            "A point has one colour, lit in the vertex stage; only winners' colours are made where no stage is kept.",
        ),
        (
            "Normals in [-1, 1] go to [0, 255]: then zero lies between two codes.",
            "floor(127 n + 128.5): zero is 128.",
        ),
        (
            "Of the tables' synthetic data only the numbers of points are known.",
            "The kettle's references at sizes of 210, 189 and 201 pixels have as many, to 1 %.",
        ),
    ),
)
