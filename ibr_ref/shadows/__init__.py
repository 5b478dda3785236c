"""Shadows by image warping (Kang & Ihm 2002): the map for an object's place, warped from nine that were made beforehand."""
