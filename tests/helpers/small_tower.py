"""The words for a small tower: four tubes, short records, few sensors."""

from pathlib import Path

FILE = Path(__file__).parents[1] / "studies" / "tower" / "small.yaml"
SMALL_TOWER = [
    f"structure={FILE}", "record.duration=20", "record.rate=20", "record.settling=10",
    "truth.subdivision=1", "sensors.inclinometers=[0,20,80,110]", "sensors.accelerometers=[50,110]",
]  # fmt: skip
