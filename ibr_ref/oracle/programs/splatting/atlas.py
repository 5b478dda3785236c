"""Stage 2: the reference images side by side on pages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.oracle.programs.splatting.case import Case, Floats, Image, Ints

Texels = Any
Pages = tuple[Texels, ...]


class Atlas(Case):
    """Rectangles, and the three maps of each page."""

    def atlas(self) -> dict[str, Any]:
        """The stage's arrays but for the normals, which are packed likewise."""
        places, images = self.places(), self.scene.images
        return {
            "atlas.rects": self.rects(places),
            "atlas.color": self.color_pages(places, [self.color_texels(image) for image in images]),
            "atlas.depth": self.pages(places, [self.depth_texels(image) for image in images]),
        }

    def places(self) -> Ints:
        """(N, 5) page, x, y, width, height: shelves from left to right and from top to bottom, in input order."""
        page, x, y, shelf = 0, 0, 0, 0
        places = []
        for height, width in (image.arrays[2].shape for image in self.scene.images):
            if not self.fits(x, width):
                x, y, shelf = 0, y + shelf, 0
            if not self.fits(y, height):
                page, x, y, shelf = page + 1, 0, 0, 0
            places.append((page, x, y, width, height))
            x, shelf = x + width, self.shelf_height(shelf, height)
        return np.array(places, np.int32)

    def fits(self, start: int, extent: int) -> bool:
        """Whether an image that starts there ends on the page, along one axis."""
        return bool(start + extent <= self.params.max_atlas_size)

    def shelf_height(self, shelf: int, height: int) -> int:
        """The height of a shelf with one more image on it."""
        return max(shelf, height)

    def rects(self, places: Ints) -> Ints:
        """(N, 5) int32, as they are handed in and read by the vertex stage."""
        return places

    def color_texels(self, image: Image) -> Texels:
        """(H, W, 3); 0 off the mask. A byte is fetched as k/255, a quotient."""
        color, _, mask = image.arrays
        return self.do.widened(self.do.texels(np.where(mask[:, :, None], color, 0.0)), quotients=1)

    def depth_texels(self, image: Image) -> Texels:
        """(H, W) along the view axis; 0 off the mask."""
        return self.do.texels(image.arrays[1])

    def color_pages(self, places: Ints, textures: Sequence[Texels]) -> Pages:
        """The pages of colours."""
        return self.pages(places, textures)

    def pages(self, places: Ints, textures: Sequence[Texels]) -> Pages:
        """One array a page, cropped to what it holds."""
        pages = []
        for page in range(places[:, 0].max() + 1):
            held = np.flatnonzero(places[:, 0] == page).tolist()
            width, height = (places[held, 1:3] + places[held, 3:5]).max(axis=0)
            texels: Floats = self.do.blank(textures[0], (height, width, *np.shape(textures[0])[2:]))
            for number in held:
                _, x, y, w, h = places[number]
                texels = self.do.replaced(texels, (slice(y, y + h), slice(x, x + w)), textures[number])
            pages.append(texels)
        return tuple(pages)
