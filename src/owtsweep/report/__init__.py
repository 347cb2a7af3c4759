"""Makes report.html: one page on a run, which opens from disk, offline, in any browser.

Python writes what stands there without JavaScript: the answer, the map, the table, where the run
comes from. The scripts beside these modules make it interactive. The page knows no study: it shows
`owtsweep.results.contents.Contents`, tables and texts.
"""
