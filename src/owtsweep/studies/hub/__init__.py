"""The hub-motion study: the sensitivity study of Ren et al. (2019), sections 5.3-5.4."""
