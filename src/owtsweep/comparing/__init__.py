"""Comparing runs of one study: best schemes, boundaries, and what changes, with intervals.

It works on rows and on what a study says of each run (`aspects.Aspects`), and knows no study.
"""
