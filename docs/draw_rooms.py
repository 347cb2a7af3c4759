"""Write docs/images/rooms.svg: `python docs/draw_rooms.py`.

The picture shows the rooms of the package, floor upon floor, as pyproject.toml lists them for
import-linter.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
FILE = ROOT / "docs" / "images" / "rooms.svg"
WIDTH, FLOOR, GAP = 600, 26, 4


def list_floors() -> list[str]:
    """Return the rooms of each floor as one text, the top floor first."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    (layers,) = (each["layers"] for each in contracts if each["type"] == "layers")
    return [layer.replace(" : ", " · ") for layer in layers]


def draw(floors: list[str]) -> str:
    """Return the picture as SVG."""
    height = len(floors) * (FLOOR + GAP)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        f'width="{WIDTH}" height="{height}" font-family="sans-serif" font-size="13">',
        f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
    ]
    for floor, rooms in enumerate(floors):
        top = floor * (FLOOR + GAP)
        lines += [
            f'<rect x="40" y="{top}" width="{WIDTH - 41}" height="{FLOOR}" rx="4" '
            'fill="#eaf0f6" stroke="#4a6a8a"/>',
            f'<text x="{20 + WIDTH / 2:g}" y="{top + 18}" text-anchor="middle">{rooms}</text>',
        ]
    lines += [
        f'<path d="M20 2 V{height - 12}" stroke="#4a6a8a" stroke-width="2"/>',
        f'<path d="M14 {height - 14} h12 l-6 12 z" fill="#4a6a8a"/>',
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    FILE.write_text(draw(list_floors()), encoding="utf-8")
