"""Comparing runs of one study: best schemes, boundaries, and what changes, with intervals.

It works on rows and on the study's description of each run (`aspects.Aspects`), and does not depend
on any study.
"""
