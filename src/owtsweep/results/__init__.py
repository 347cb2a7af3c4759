"""What the rows of a run amount to: a cube over its conditions, tables, boundaries."""
