"""Statistics of replicates: means, confidence intervals, differences, tests, the best scheme."""
