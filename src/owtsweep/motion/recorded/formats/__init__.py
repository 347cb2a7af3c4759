"""One reader per file format; `open_table` picks it by the extension, then by the content."""

from owtsweep.motion.recorded.formats.pick import open_table
from owtsweep.motion.recorded.formats.table import Table

__all__ = ["Table", "open_table"]
