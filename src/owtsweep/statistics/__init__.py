"""Statistics over replicates: means, intervals, paired differences, tests, the best scheme."""
