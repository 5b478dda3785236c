"""Sweeps over parameters: the settings that a scene needs so that at most so many pixels are wrong.

`sweep(method, scene, over={"linear_steps": [5, 10, 20], ...}, views=8)` renders the product of all values from all views,
measures each picture against the truth, and gives a `Sweep`: a table with one row a setting and view, the frontier of error
against cost, and `smallest(bound)`, the cheapest setting that is good enough from everywhere. The rows are made by the
workers of a Dask cluster, of this machine or of many, and are the same on any number of them but for the milliseconds. With
`out` they are kept in a Parquet file, and a sweep that was interrupted goes on from there.

`measures(method)` lists what is measured. `README.md` beside this file says how to run one on a
cluster. Needs
`pip install 'ibr_ref[sweep]'`.
"""

from ibr_ref.sweep.measures import Measure
from ibr_ref.sweep.result import Outcome, Sweep
from ibr_ref.sweep.run import measures, sweep

__all__ = ["Measure", "Outcome", "Sweep", "measures", "sweep"]
