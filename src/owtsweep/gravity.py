"""The acceleration of gravity, m/s^2: that at structures, and that of the unit g.

They differ by .03 %. At a structure it depends on the place, and 9.81 is a rounded number for it. A
unit g in data is 9.80665 by definition, whatever the place of the recording.
"""

#: At structures: for waves, weight, and an accelerometer that leans.
GRAVITY = 9.81
#: The unit g of recorded accelerations, by definition (CGPM 1901).
STANDARD_GRAVITY = 9.80665
