"""Several reference images of one place."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import overload

from ibr_ref.scene import checks
from ibr_ref.scene.camera import Camera
from ibr_ref.scene.depth_image import DepthImage


@dataclass(frozen=True, kw_only=True, eq=False)
class DepthSet(Sequence[DepthImage]):
    """Pictures with depth of one place, in one world space, with their names: a sequence of its `images`.

    Raises ValueError if there is no image, something is none, or names and images are not as many.
    """

    images: Sequence[DepthImage]
    """At least one."""
    names: Sequence[str]
    """One an image: what its file, or the set, calls it."""

    def __post_init__(self) -> None:
        for field in ("images", "names"):
            value = getattr(self, field)
            if isinstance(value, (str, DepthImage)) or not isinstance(value, Iterable):
                raise checks.reject(field, type(value).__name__, "a sequence")
            object.__setattr__(self, field, tuple(value))
        for i, image in enumerate(self.images):
            if not isinstance(image, DepthImage):
                raise checks.reject(f"images[{i}]", type(image).__name__, "a DepthImage")
        if not self.images:
            raise checks.reject("images", 0, "at least one DepthImage")
        if len(self.names) != len(self.images) or not all(isinstance(name, str) for name in self.names):
            raise checks.reject("names", self.names, f"{len(self.images)} texts, one an image")

    @property
    def cameras(self) -> tuple[Camera, ...]:
        """Those of the images."""
        return tuple(image.camera for image in self.images)

    def __len__(self) -> int:
        return len(self.images)

    @overload
    def __getitem__(self, index: int) -> DepthImage: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[DepthImage]: ...

    def __getitem__(self, index: int | slice) -> DepthImage | Sequence[DepthImage]:
        return self.images[index]

    def __iter__(self) -> Iterator[DepthImage]:
        return iter(self.images)
