"""The conditions of the tower study: the axes of its grid."""

from owtsweep.results.conditions import Condition

NOISE = Condition("noise", "sensor noise", "%", scale="log", plural="noises", enters="sensors")
SOIL_FACTOR = Condition(
    "soil_factor",
    "soil stiffness of the model over the true one",
    scale="log",
    enters="knowledge",
)
CONDITIONS = (SOIL_FACTOR, NOISE)
