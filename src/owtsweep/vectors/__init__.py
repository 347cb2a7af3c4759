"""A value of eight lanes for compiled kernels, and the memory it comes from."""
