"""What a scheme of your own imports: `from owtsweep.schemes import Unable, blade`.

`blade`, `floater` and `tower` hold the study's `Setting` (what a scheme knows), `Measured` (what
it gets of a record; the tower's is an array) and `Estimates` (what it returns). A scheme of the hub
study returns `owtsweep.Estimate`. `owtsweep.testing.check_scheme` says whether a scheme keeps the
contract; `owtsweep init scheme NAME study=...` writes one that does.
"""

from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.blade import contract as blade
from owtsweep.studies.floater import contract as floater
from owtsweep.studies.hub import contract as hub
from owtsweep.studies.tower import contract as tower

__all__ = ["Unable", "blade", "floater", "hub", "tower"]
