"""The measurements behind `ibr-ref bench`, and those beside other renderers and comparators."""
