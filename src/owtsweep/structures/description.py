"""The description of a support structure: tubes, point masses, blades, soil and water.

A description is a YAML file; conf/structure holds those of the project. It holds values only, in SI
units (angles in degrees).
"""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import (
    Finite,
    NotNegative,
    Positive,
    Section,
    changed,
    conf_directory,
    key,
    require,
    typed,
)
from owtsweep.config.stored import read_stored
from owtsweep.errors import InputError
from owtsweep.gravity import GRAVITY
from owtsweep.io.reading import expand_home

#: Friction angles (degrees) that the fits of owtsweep.structures.sections hold for.
ANGLES = (28.0, 40.0)
#: Names of structures, which may be part of a file's name.
NAME = re.compile(r"\w[\w .+-]{0,59}")
#: Greatest length of a structure, m.
LONGEST = 1000.0
#: Largest gap between two tubes that counts as none, m.
TOUCH = 1e-9
#: Most tubes of a structure, bodies on it, and layers of its soil: matrices are dense.
MOST_PARTS = 300
#: Shortest tube, and shortest piece of a tube that is computed by itself, m. Elements far shorter
#: than this would spoil the stiffness by rounding.
SHORTEST = 1e-3
#: Largest numbers that a structure may have, far above those of any: mass in kg, moment of inertia
#: in kg m^2, density in kg/m^3, distance in m. Larger ones cannot be computed with.
MOST_MASS, MOST_INERTIA, MOST_DENSITY, MOST_OFFSET = 1e9, 1e14, 1e5, 1e3


class Tube(Section):
    """A tube between two heights; diameter and thickness are those at bottom and top."""

    name: str = key("name of the tube, for messages")
    bottom: Finite = key("height of the lower end above mean sea level", unit="m")
    top: Finite = key("height of the upper end", unit="m")
    diameter: list[Positive] = key("outer, at bottom and top", unit="m", min_length=2, max_length=2)
    thickness: list[Positive] = key("wall, at bottom and top", unit="m", min_length=2, max_length=2)
    density: Positive = key("of the wall, with paint and flanges", unit="kg/m^3", le=MOST_DENSITY)
    youngs_modulus: Positive = key("Young's modulus", unit="Pa", default=2.1e11)
    poissons_ratio: float = key("Poisson's ratio", default=0.3, ge=0.0, lt=0.5)

    def outer(self, height: Array) -> Array:
        """Outer diameter at heights (m), m."""
        return np.interp(height, [self.bottom, self.top], self.diameter)

    def inner(self, height: Array) -> Array:
        """Inner diameter at heights (m), m."""
        wall = np.interp(height, [self.bottom, self.top], self.thickness)
        return np.asarray(self.outer(height) - 2.0 * wall)

    def area(self, height: Array) -> Array:
        """Compute the area of the wall's cross-section, m^2, at heights in m."""
        return np.asarray(np.pi / 4.0 * (self.outer(height) ** 2 - self.inner(height) ** 2))

    def inertia(self, height: Array) -> Array:
        """Compute the second moment of area about a diameter, m^4, at heights in m."""
        return np.asarray(np.pi / 64.0 * (self.outer(height) ** 4 - self.inner(height) ** 4))

    def check(self) -> None:
        where = f"structure.tubes.{self.name}"
        require(
            self.top - self.bottom >= SHORTEST,
            f"{where}: top {self.top:g} m must be above bottom {self.bottom:g} m, by {SHORTEST:g} "
            "m or more",
        )
        ends = zip(self.diameter, self.thickness, ("bottom", "top"), strict=True)
        for diameter, thickness, end in ends:
            require(
                2.0 * thickness <= diameter,
                f"{where}: thickness {thickness:g} m at the {end} exceeds the radius of "
                f"{diameter / 2.0:g} m",
            )


class Point(Section):
    """A rigid body on the structure's axis or above it, e.g. a nacelle."""

    name: str = key("name of the body, for messages")
    height: Finite = key("where the body is fixed to a tube", unit="m")
    mass: NotNegative = key("mass", unit="kg", le=MOST_MASS)
    offset: Finite = key(
        "of the centre of mass above `height`", unit="m", default=0.0,
        ge=-MOST_OFFSET, le=MOST_OFFSET,
    )  # fmt: skip
    inertia: NotNegative = key(
        "mass moment of inertia about the horizontal axis through the centre of mass",
        unit="kg m^2",
        default=0.0,
        le=MOST_INERTIA,
    )
    inertia_side: NotNegative | None = key(
        "of motion across the wind; null: as `inertia`, which then holds for every direction",
        unit="kg m^2",
        default=None,
        le=MOST_INERTIA,
    )


class Blade(Section):
    """One blade on the hub, as a body on the structure's top.

    A blade bends, so the tower's vibration accelerates it by more than the hub. `flap_factor` is
    how much more: 1 / (1 - (f / f_flap)^2) for a tower at f and a first flapwise mode at f_flap. It
    multiplies the mass and the inertia.
    """

    mass: Positive = key("mass of one blade", unit="kg", le=MOST_MASS)
    offset: Finite = key(
        "of the hub above the top of the structure", unit="m", default=0.0,
        ge=-MOST_OFFSET, le=MOST_OFFSET,
    )  # fmt: skip
    inertia: NotNegative = key(
        "of one blade about the hub's lateral axis, mean over the rotor's positions",
        unit="kg m^2",
        default=0.0,
        le=MOST_INERTIA,
    )
    flap_factor: float = key(
        "growth of mass and inertia by the blade's bending", default=1.0, ge=1, le=1e3
    )


class Layer(Section):
    """A layer of sand, from the layer above down to `bottom`."""

    bottom: Positive = key("depth of the lower end below the mudline", unit="m")
    friction_angle: float = key(
        "angle of internal friction", unit="deg", ge=ANGLES[0], le=ANGLES[1]
    )


class Soil(Section):
    """Layers of sand below the mudline, with springs by the API's p-y curves."""

    layers: list[Layer] = key("from the mudline downwards", min_length=1)
    fit: Literal["power", "parabola"] = key(
        "reading of the API's diagram of stiffness over friction angle", default="power"
    )

    def with_angle(self, friction_angle: float) -> Soil:
        """Return the soil with one friction angle (degrees) in every layer."""
        layers = [changed(layer, friction_angle=friction_angle) for layer in self.layers]
        return changed(self, layers=layers)


class Foundation(Section):
    """Springs at the lower end that stand for all of the soil: a macro-element.

    The force and the moment on the structure are -K0 [w, theta], K0 = [[lateral, coupling],
    [coupling, rotation]], where theta = dw/dz is positive if the structure leans the way it moves.
    With this sign the coupling of a pile is negative.
    """

    lateral: Positive = key("force per displacement", unit="N/m")
    coupling: Finite = key("force per rotation, and moment per displacement", unit="N")
    rotation: Positive = key("moment per rotation", unit="N m")

    def matrix(self) -> Array:
        """Stiffness of sway and rotation, shape (2, 2); N/m, N, N m."""
        return np.array([[self.lateral, self.coupling], [self.coupling, self.rotation]])


class Water(Section):
    """The water around the structure, from the mudline to mean sea level."""

    density: Positive = key("density", unit="kg/m^3", default=1025.0, le=MOST_DENSITY)
    added_mass: NotNegative = key("coefficient C_a of the water outside", default=1.0, le=1e3)
    drag: NotNegative = key("coefficient C_D of Morison's equation", default=1.0)
    level: Finite = key(
        "up to which height water adds mass; waves are about mean sea level, whatever it is",
        unit="m",
        default=0.0,
    )


class Structure(Section):
    """A support structure, with what stands on it.

    The lowest tube stands in the soil or is clamped at its lower end. The hub is the top of the
    highest tube; there motion is given and an IMU is mounted.
    """

    name: str = key("name of the structure")
    source: str = key("where the numbers are from")
    mudline: Finite = key("height of the mudline; water reaches from there to 0", unit="m")
    tubes: list[Tube] = key("from below upwards, end to end", min_length=1)
    points: list[Point] = key("rigid bodies", default_factory=list)
    blade: Blade | None = key("one blade; null: no blades can be mounted", default=None)
    soil: Soil | None = key(
        "springs below the mudline; null: clamped at the lower end", default=None
    )
    foundation: Foundation | None = key(
        "springs at the lower end in place of soil; null: none", default=None
    )
    clamped: bool = key("whether the lower end is clamped", default=False)
    water: Water | None = key("null: no water", default=None)
    damping: float = key("ratio of every mode", ge=0.0, lt=1.0)
    gravity: NotNegative = key("acceleration of gravity", unit="m/s^2", default=GRAVITY)

    @property
    def bottom(self) -> float:
        """The height of the structure's lower end, m."""
        return self.tubes[0].bottom

    @property
    def hub(self) -> float:
        """The height of the structure's top, m, where motion is given."""
        return self.tubes[-1].top

    def ends(self) -> list[float]:
        """Return the ends of pieces of tubes that neither mudline, sea level nor points divide, m.

        The heights are from the lower end upwards. A piece begins where the piece below ends; so a
        gap of rounding between two tubes is closed. No piece is shorter than `SHORTEST`: a cut that
        is nearer to the last one, or to the tube's top, is left out.
        """
        cuts = sorted((self.mudline, 0.0, *(p.height for p in self.points)))
        ends = [self.bottom]
        for tube in self.tubes:
            for cut in cuts:
                if ends[-1] + SHORTEST <= cut <= tube.top - SHORTEST:
                    ends.append(cut)
            ends.append(tube.top)
        return ends

    def check(self) -> None:
        """Raise `InputError` if the numbers do not describe a structure that stands."""
        require(
            NAME.fullmatch(self.name) is not None,
            f"structure.name: {self.name!r} cannot be part of a file's name; use letters, "
            "digits, blanks, . _ - +, and begin with a letter or digit",
        )
        layers = [] if self.soil is None else self.soil.layers
        for name, parts in (("tubes", self.tubes), ("points", self.points), ("soil", layers)):
            require(
                len(parts) <= MOST_PARTS,
                f"structure.{name}: it has {len(parts)} parts, more than {MOST_PARTS}; join some",
            )
        for tube in self.tubes:
            tube.check()
        require(
            self.hub - self.bottom <= LONGEST,
            f"structure: {self.hub - self.bottom:g} m from foot to hub is more than {LONGEST:g} m; "
            "heights are in m",
        )
        for lower, upper in pairwise(self.tubes):
            require(
                abs(lower.top - upper.bottom) <= TOUCH,
                f"structure.tubes.{upper.name}: begins at {upper.bottom:g} m, but "
                f"{lower.name} ends at {lower.top:g} m",
            )
        require(
            self.clamped
            or self.foundation is not None
            or (self.soil is not None and self.bottom < self.mudline),
            "structure: it floats, because it has neither soil around its lower end, nor a "
            "foundation, nor clamped: true",
        )
        if self.foundation is not None:
            require(
                not self.clamped and self.soil is None,
                "structure.foundation: it stands for the soil; leave out soil and clamped",
            )
            require(
                float(np.linalg.det(self.foundation.matrix())) > 0.0,
                "structure.foundation: lateral x rotation must exceed coupling^2, or it pushes "
                "instead of holding",
            )
        require(
            self.gravity > 0.0 or self.water is None,
            "structure.gravity: 0 m/s^2 leaves no waves on the structure's water; give a number "
            "above zero, or leave out water",
        )
        if self.soil is not None:
            depths = [layer.bottom for layer in self.soil.layers]
            require(
                all(a < b for a, b in pairwise(depths)),
                f"structure.soil.layers: bottoms must increase with depth, not {depths}",
            )
            require(
                depths[-1] >= self.mudline - self.bottom,
                f"structure.soil.layers: end {depths[-1]:g} m below the mudline, but the lowest "
                f"tube reaches {self.mudline - self.bottom:g} m; add a layer",
            )
        for point in self.points:
            require(
                self.bottom <= point.height <= self.hub,
                f"structure.points.{point.name}: height {point.height:g} m must be between "
                f"{self.bottom:g} and {self.hub:g} m",
            )


def read_structure(path: str | Path) -> Structure:
    """Read and check a description of a structure from a YAML file.

    Raise `InputError` if the file cannot be read, a key is unknown or missing, or the numbers do
    not describe a structure that stands.
    """
    plain, _ = read_stored(Path(path))
    try:
        structure = typed(Structure, plain)
        structure.check()
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return structure


def find_structure(name: str) -> Structure:
    """Read a structure by its name in conf/structure, or by the path of a YAML file.

    Raise `InputError` if there is neither, or the file does not describe a structure that stands.
    """
    folder = conf_directory() / "structure"
    if name.endswith((".yaml", ".yml")):
        return read_structure(expand_home(name))
    names = sorted(path.stem for path in folder.glob("*.yaml"))
    require(
        name in names,
        f"structure: there is no {name!r}; use {', '.join(names)}, or a file that ends in .yaml",
    )
    return read_structure(folder / f"{name}.yaml")
