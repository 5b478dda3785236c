"""What `ibr-ref render` draws: a picture, one in bands that never is there as a whole, or the frames of a film."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import options, own_case
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, always

if TYPE_CHECKING:
    from ibr_ref.io import Frame
    from ibr_ref.io.parts import Draw
    from ibr_ref.progress import Step
    from ibr_ref.scene import Camera

_IN_BANDS = (".tif", ".tiff")


@dataclass(frozen=True, kw_only=True)
class Picture:
    """Options: a picture, or the frames of a film, and who draws."""

    out: options.Out
    path: Annotated[
        Path | None,
        typer.Option(
            "--path",
            help="A camera path (JSON: cameras with eye and target): frames of a film, --out film.png as film-0000.png and "
            "so on. Those that are there already are kept.",
        ),
    ] = None
    frames: Annotated[int, typer.Option(parser=options.whole, help="--path: how many frames.")] = 120
    video: Annotated[
        Path | None,
        typer.Option(help="--path: also a video of them, .mp4, .mkv, .webm, .gif; needs ibr_ref[video]."),
    ] = None
    fps: Annotated[float, typer.Option(parser=options.number, help="--video: frames a second.")] = 30.0
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Of a Dask scheduler: frames of a --path, or bands of a TIFF, are drawn by its workers, which need the "
            "same version of ibr_ref[sweep].",
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class Kept:
    """Options: how the picture is written, and what else is."""

    bits: options.Bits = 8
    stages: Annotated[Path | None, typer.Option(help="Also write every stage array, as .npz.")] = None
    case: own_case.Folder = None


@dataclass(frozen=True)
class Wanted:
    """What is drawn, and what is written."""

    picture: Picture
    kept: Kept
    fov: float
    """Vertical, degrees, of the cameras of a path that do not say theirs."""
    whole: dict[str, Any]
    """Options that need a whole picture, by name; beside `stages`."""

    @property
    def in_bands(self) -> bool:
        """Whether the picture is drawn band by band."""
        return self.picture.path is None and self.picture.out.suffix.lower() in _IN_BANDS

    def check(self, size: options.Size) -> None:
        """Raise what cannot go well, before long work: BadParameter, or OSError or ValueError for files."""
        from ibr_ref import io

        out, path, stages = self.picture.out, self.picture.path, self.kept.stages
        io.check_image_writable(out, self.kept.bits)
        if self.picture.scheduler is not None and path is None and not self.in_bands:
            raise typer.BadParameter(f"--scheduler: found beside --out {out}, allowed: beside --path, or for a TIFF")
        for name, value in {"stages": stages, **self.whole}.items():
            if value and (path is not None or self.in_bands):
                raise self._not_whole("--" + name.replace("_", "-"))
        if self.picture.video is not None:
            io.check_film_writable(self.picture.video, *size)
        own_case.check_writable(self.kept.case)
        if stages is not None:
            io.check_writable(stages)

    def _not_whole(self, flag: str) -> typer.BadParameter:
        """The error for an option that needs a whole picture."""
        out, path = self.picture.out, self.picture.path
        beside = f"--out {out}" if path is None else f"--path {path}"
        why = "a TIFF is drawn band by band, never as a whole" if path is None else "it is of one picture"
        return typer.BadParameter(
            f"{flag}: found beside {beside}, allowed: beside one picture, .png, .jpg or .exr ({why})"
        )


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

    if wanted.picture.path is not None:
        return _film(wanted, scene, params, render, fit, step), None
    if wanted.in_bands:
        return _in_bands(wanted, scene, render, step), None
    step("rendering")
    frame = render(scene)
    return shows(frame), frame


def write(wanted: Wanted, frame: Frame, step: Step, *, depth_set: Path | None = None, camera: Any = None) -> None:
    """A picture that is there as a whole, and what else is kept of it; depth_set: of its camera."""
    from ibr_ref import io

    kept = wanted.kept
    step("writing")
    if kept.stages is not None:
        frame.save_stages(kept.stages)
    if depth_set is not None:
        io.write_depth_set(depth_set, [frame.depth_image(camera)], bits=kept.bits)
    frame.save(wanted.picture.out, kept.bits)


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

        io.write_poster(wanted.picture.out, band, width, height, wanted.kept.bits, step.within)
    return shown


@contextmanager
def _drawer(wanted: Wanted, scene: Any, render: Callable[..., Frame]) -> Iterator[Draw]:
    """What draws parts one after the other: workers, or this process."""
    if wanted.picture.scheduler is not None:
        from ibr_ref.sweep.drawing import on_workers

        with on_workers(wanted.picture.scheduler, scene, render) as draw:
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

    picture, bits = wanted.picture, wanted.kept.bits
    assert picture.path is not None
    size = scene.camera.width, scene.camera.height
    cameras = [fit(camera) for camera in io.read_camera_path(picture.path, *size, picture.frames, wanted.fov)]
    digits = max(4, len(str(len(cameras) - 1)))
    out = picture.out
    files = [out.with_name(f"{out.stem}-{i:0{digits}}{out.suffix}") for i in range(len(cameras))]
    _mark(out.with_suffix(".film"), digest_of(scene, params, cameras, bits))
    step("drawing frames")
    missing = [i for i, file in enumerate(files) if not file.exists()]
    shown = len(missing) < len(files)
    with _drawer(wanted, scene, render) as draw:
        step.within("frames", len(files) - len(missing), len(files))
        for done, (i, drawn) in enumerate(zip(missing, draw(Part(camera=cameras[i]) for i in missing), strict=True)):
            shown = shown or drawn.shown
            io.write_image(files[i], drawn.color, bits)
            step.within("frames", len(files) - len(missing) + done + 1, len(files))
    if picture.video is not None:
        step("writing the video")
        io.write_film(picture.video, files, picture.fps)
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
