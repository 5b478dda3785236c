"""What `ibr-ref render` draws: a picture, one in bands that never is there as a whole, or the frames of a film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import options
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, always

if TYPE_CHECKING:
    from ibr_ref.io import Frame
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
    from ibr_ref.cli import emptiness

    if wanted.path is not None:
        return _film(wanted, scene, params, render, fit, step), None
    if wanted.in_bands:
        return _in_bands(wanted, scene, render, step), None
    step("rendering")
    frame = render(scene)
    return emptiness.shows(frame), frame


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
    from ibr_ref.cli import emptiness

    shown = False

    def band(rows: tuple[int, int]) -> Any:
        nonlocal shown
        frame = render(scene, rows=rows)
        shown = shown or emptiness.shows(frame)
        return frame.color

    step("drawing and writing")
    io.write_poster(wanted.out, band, scene.camera.width, scene.camera.height, wanted.bits, step.within)
    return shown


def _film(
    wanted: Wanted, scene: Any, params: Any, render: Callable[..., Frame], fit: Callable[[Camera], Camera], step: Step
) -> bool:
    """Frames that are there already are kept, if they are of the same film: the file beside them says of which."""
    from ibr_ref import io
    from ibr_ref.cli import emptiness
    from ibr_ref.scene.digests import digest_of

    assert wanted.path is not None
    size = scene.camera.width, scene.camera.height
    cameras = [fit(camera) for camera in io.read_camera_path(wanted.path, *size, wanted.frames, wanted.fov)]
    digits = max(4, len(str(len(cameras) - 1)))
    files = [wanted.out.with_name(f"{wanted.out.stem}-{i:0{digits}}{wanted.out.suffix}") for i in range(len(cameras))]
    _mark(wanted.out.with_suffix(".film"), digest_of(scene, params, cameras, wanted.bits))
    step("drawing frames")
    shown = False
    for i, (file, camera) in enumerate(zip(files, cameras, strict=True)):
        step.within("frames", i, len(files))
        if file.exists():
            shown = True
            continue
        frame = render(replace(scene, camera=camera))
        shown = shown or emptiness.shows(frame)
        frame.save(file, wanted.bits)
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
        "fps": Beside("it is about a video", {"video": GIVEN}),
    }
