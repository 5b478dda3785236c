"""The tables and figures of the papers, measured: what `ibr-ref reproduce` runs."""
