"""One reader per file format; `open_table` chooses by the extension, then by the content."""

from owtsweep.motion.recorded.formats.pick import open_table
from owtsweep.motion.recorded.formats.table import ChannelTable

__all__ = ["ChannelTable", "open_table"]
