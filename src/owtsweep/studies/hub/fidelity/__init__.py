"""Judge how well a run reproduces the results of Ren et al. (2019): score, statements, report."""
