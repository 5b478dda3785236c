"""Why a picture alone cannot show a bug."""

BELOW_A_BYTE = "the picture changes by less than half a step of 8 bits: a PNG hardly shows it"
GIVEN = "the picture is made of the maps that the case hands over"
