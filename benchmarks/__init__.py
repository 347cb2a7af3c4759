"""Speed and memory of owtsweep, against its goals and against what else there is.

`python -m benchmarks` (or `make bench`) measures all and writes report.md; every part runs alone as
`python -m benchmarks.<part>`. All times come from `benchmarks.timing`.
"""
