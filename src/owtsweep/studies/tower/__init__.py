"""The tower study: input-state estimation of a substructure (Simpson et al. 2025)."""
