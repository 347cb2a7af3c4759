"""Statistics over replicates: means, intervals, paired differences, tests, and who is best."""
