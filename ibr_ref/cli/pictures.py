"""What `ibr-ref render` draws: a picture, one in bands that never is there as a whole, or the frames of a film."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import options
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, always

if TYPE_CHECKING:
    from ibr_ref.io import Frame
    from ibr_ref.io.parts import Draw
    from ibr_ref.progress import Step
    from ibr_ref.scene import Camera

CameraPath = Annotated[
    Path | None,
    typer.Option(
        "--path",
        help="A camera path (JSON: cameras with eye and target): frames of a film, --out film.png as film-0000.png and "
        "so on. Those that are there already are kept.",
    ),
]
Frames = Annotated[int, typer.Option(parser=options.whole, help="--path: how many frames.")]
Video = Annotated[
    Path | None, typer.Option(help="--path: also a video of them, .mp4, .mkv, .webm, .gif; needs ibr_ref[video].")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Of a Dask scheduler: frames of a --path, or bands of a TIFF, are drawn by its workers, which need the same "
        "version of ibr_ref[sweep].",
    ),
]
Fps = Annotated[float, typer.Option(parser=options.number, help="--video: frames a second.")]

_IN_BANDS = (".tif", ".tiff")


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """The options of what is drawn."""

    out: Path
    bits: int
    path: Path | None
    frames: int
    video: Path | None
    fps: float
    fov: float
    """Vertical, degrees, of the cameras of a path that do not say theirs."""
    scheduler: str | None
    """Of workers that draw; None: this process draws."""
    whole: dict[str, Any]
    """Options that need a whole picture, by name."""

    @property
    def in_bands(self) -> bool:
        """Whether the picture is drawn band by band."""
        return self.path is None and self.out.suffix.lower() in _IN_BANDS

    def check(self, width: int, height: int) -> None:
        """Raise what cannot go well, before long work: BadParameter, or OSError or ValueError for files."""
        from ibr_ref import io

        io.check_image_writable(self.out, self.bits)
        if self.scheduler is not None and self.path is None and not self.in_bands:
            raise typer.BadParameter(
                f"--scheduler: found beside --out {self.out}, allowed: beside --path, or for a TIFF"
            )
        for name, value in self.whole.items():
            if value and (self.path is not None or self.in_bands):
                flag, beside = (
                    "--" + name.replace("_", "-"),
                    f"--out {self.out}" if self.path is None else f"--path {self.path}",
                )
                why = (
                    "it is of one picture"
                    if self.path is not None
                    else "a TIFF is drawn band by band, never as a whole"
                )
                raise typer.BadParameter(
                    f"{flag}: found beside {beside}, allowed: beside one picture, .png, .jpg or .exr ({why})"
                )
        if self.video is not None:
            io.check_film_writable(self.video, width, height)


def draw(
    wanted: Wanted,
    scene: Any,
    params: Any,
    render: Callable[..., Frame],
    fit: Callable[[Camera], Camera],
    step: Step,
) -> tuple[bool, Frame | None]:
    """Draw and write what is wanted; whether anything is shown, and the picture, where it is there as a whole.

    render(scene, rows=...) draws a scene, or some rows of it; fit(camera) is a camera of a path with planes around it.
    """
    from ibr_ref.io.parts import shows

    if wanted.path is not None:
        return _film(wanted, scene, params, render, fit, step), None
    if wanted.in_bands:
        return _in_bands(wanted, scene, render, step), None
    step("rendering")
    frame = render(scene)
    return shows(frame), frame


def write(
    wanted: Wanted, frame: Frame, step: Step, *, stages: Path | None, depth_set: Path | None = None, camera: Any = None
) -> None:
    """A picture that is there as a whole, and what else is kept of it; depth_set: of its camera."""
    from ibr_ref import io

    step("writing")
    if stages is not None:
        frame.save_stages(stages)
    if depth_set is not None:
        io.write_depth_set(depth_set, [frame.depth_image(camera)], bits=wanted.bits)
    frame.save(wanted.out, wanted.bits)


def _in_bands(wanted: Wanted, scene: Any, render: Callable[..., Frame], step: Step) -> bool:
    from ibr_ref import io
    from ibr_ref.io.parts import Part

    shown = False
    step("drawing and writing")
    width, height = scene.camera.width, scene.camera.height
    with _drawer(wanted, scene, render) as draw:
        bands = draw(Part(rows=rows) for rows in io.poster_bands(width, height))

        def band(rows: tuple[int, int]) -> Any:
            nonlocal shown
            drawn = next(bands)
            shown = shown or drawn.shown
            return drawn.color

        io.write_poster(wanted.out, band, width, height, wanted.bits, step.within)
    return shown


@contextmanager
def _drawer(wanted: Wanted, scene: Any, render: Callable[..., Frame]) -> Iterator[Draw]:
    """What draws parts one after the other: workers, or this process."""
    if wanted.scheduler is not None:
        from ibr_ref.sweep.drawing import on_workers

        with on_workers(wanted.scheduler, scene, render) as draw:
            yield draw
    else:
        from ibr_ref.io.parts import drawn

        yield lambda parts: (drawn(scene, render, part) for part in parts)


def _film(
    wanted: Wanted, scene: Any, params: Any, render: Callable[..., Frame], fit: Callable[[Camera], Camera], step: Step
) -> bool:
    """Frames that are there already are kept, if they are of the same film: the file beside them says of which."""
    from ibr_ref import io
    from ibr_ref.io.parts import Part
    from ibr_ref.scene.digests import digest_of

    assert wanted.path is not None
    size = scene.camera.width, scene.camera.height
    cameras = [fit(camera) for camera in io.read_camera_path(wanted.path, *size, wanted.frames, wanted.fov)]
    digits = max(4, len(str(len(cameras) - 1)))
    files = [wanted.out.with_name(f"{wanted.out.stem}-{i:0{digits}}{wanted.out.suffix}") for i in range(len(cameras))]
    _mark(wanted.out.with_suffix(".film"), digest_of(scene, params, cameras, wanted.bits))
    step("drawing frames")
    missing = [i for i, file in enumerate(files) if not file.exists()]
    shown = len(missing) < len(files)
    with _drawer(wanted, scene, render) as draw:
        step.within("frames", len(files) - len(missing), len(files))
        for done, (i, drawn) in enumerate(zip(missing, draw(Part(camera=cameras[i]) for i in missing), strict=True)):
            shown = shown or drawn.shown
            io.write_image(files[i], drawn.color, wanted.bits)
            step.within("frames", len(files) - len(missing) + done + 1, len(files))
    if wanted.video is not None:
        step("writing the video")
        io.write_film(wanted.video, files, wanted.fps)
    return shown


def _mark(file: Path, digest: str) -> None:
    """Write of which film the frames beside a file are; raises ValueError where they are of another one."""
    from ibr_ref.io.outputs import atomic

    if file.exists():
        if file.read_text(errors="replace").strip() == digest:
            return
        raise ValueError(
            f"{file}: found beside frames of another film, allowed: another --out, or those removed with it"
        )
    with atomic(file) as output:
        output.write(f"{digest}\n".encode())


def goes_with(*view: str) -> dict[str, Beside]:
    """Beside which others these options, and those of the view, are read."""
    return {
        **always("path"),
        **{name: Beside("a camera path has its own cameras", {"path": ABSENT}) for name in view},
        "frames": Beside("it is about a camera path", {"path": GIVEN}),
        "video": Beside("it is about a camera path", {"path": GIVEN}),
        **always("scheduler"),
        "fps": Beside("it is about a video", {"video": GIVEN}),
    }
