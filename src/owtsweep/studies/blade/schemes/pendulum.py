"""PENDULUM: MEKF that knows how the blade swings below a hook at rest.

While the hook moves, e.g. hoists, it is wrong without knowing it (docs/blade.md, section 4).
"""

from __future__ import annotations

from owtsweep.studies.blade.schemes.mekf import NavigatorScheme

SCHEME = NavigatorScheme("PENDULUM", swing=True)
