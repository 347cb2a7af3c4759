"""What sensors do to what they measure: noise, bias, rate, delay, losses, a clock of their own."""

#: Raised whenever a change of this room alters a number that a study stores.
NUMERICS_VERSION = 0
