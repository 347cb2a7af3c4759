"""The schemes and baselines of the hub study, each as `SCHEME` in a module of its name."""
