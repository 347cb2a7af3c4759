"""What moved: the hub's motion, composed from the platform's motion and the tower's bending."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import writers
from scipy.linalg import polar
from scipy.spatial.transform import Rotation

from owtsweep.errors import InputError
from owtsweep.motion.recorded import describe, read

HEIGHT = 87.6
TIME = np.arange(0.0, 300.0, 0.1)
#: Channels of FAST that a floating turbine has; all six motions of the platform and the bending.
ALL = (
    "PtfmSurge", "PtfmSway", "PtfmRoll", "PtfmPitch", "PtfmYaw", "TTDspFA", "TTDspSS", "YawBrTDzt",
)  # fmt: skip


def float_about(*, amplitude: float = 1.0) -> tuple[writers.Table, np.ndarray]:
    """Channels of a floating turbine, and the truth: displacement of the tower top, (n, 2) in m.

    The platform moves slowly and with the waves, with tilts of several degrees; `amplitude` 0 holds
    it still. The truth is made by scipy's rotations.
    """
    slow, wave, bend = (2 * np.pi * TIME / period for period in (80.0, 10.0, 3.1))
    surge = 4.0 + 3.0 * np.sin(slow) + 0.8 * np.sin(wave)
    sway = 0.7 * np.sin(slow + 1.0) + 0.2 * np.cos(wave)
    roll = 1.0 + 0.8 * np.sin(wave + 0.5)
    pitch = 4.0 + 2.5 * np.sin(slow + 0.3) + 1.1 * np.cos(wave)
    yaw = 3.0 * np.sin(slow + 2.0)
    b = np.array([0.3 + 0.12 * np.sin(bend), 0.03 * np.cos(bend), -0.01 + 0.002 * np.sin(bend)])
    angles = amplitude * np.stack([yaw, pitch, roll], axis=1)
    turn = Rotation.from_euler("ZYX", angles, degrees=True)  # about the turned axes, yaw first
    top = turn.apply(b.T + np.array([0.0, 0.0, HEIGHT]))
    truth = top[:, :2] + amplitude * np.stack([surge, sway], axis=1)
    values = [surge, sway, roll, pitch, yaw]
    table = {
        name: ("deg" if k > 1 else "m", amplitude * v)
        for k, (name, v) in enumerate(zip(ALL[:5], values, strict=True))
    }
    return {
        "Time": ("s", TIME),
        **table,
        **{n: ("m", v) for n, v in zip(ALL[5:], b, strict=True)},
    }, truth


def without(table: writers.Table, *names: str) -> writers.Table:
    return {name: item for name, item in table.items() if name not in names}


def refusal(path: Path, **options) -> str:
    with pytest.raises(InputError) as caught:
        read(path, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("kind", ["out", "outb", "npz"])
def test_the_hubs_motion_is_composed_to_a_thousandth(tmp_path: Path, kind: str) -> None:
    table, truth = float_about()
    if kind == "out":
        path = writers.fast_text(tmp_path / "floating.out", table)
    elif kind == "outb":
        path = writers.fast_binary(tmp_path / "floating.outb", table, 2)
    else:  # without units: the platform's angles are in deg in FAST's own channels
        path = tmp_path / "floating.npz"
        np.savez(path, **{name: values for name, (_, values) in table.items()})
    recording = read(path, tower_height=HEIGHT)
    got = np.stack([recording.channels["position_x"], recording.channels["position_y"]], axis=1)
    rms = np.std(truth, axis=0)
    assert np.all(np.sqrt(np.mean((got - truth) ** 2, axis=0)) < 1e-3 * rms)
    bending = np.std(table["TTDspFA"][1])
    assert bending < 0.1 * rms[0]  # the bending alone would have been another motion
    assert not any(role.startswith(("platform", "tower")) for role in recording.channels)
    (note,) = [note for note in recording.notes if "composed" in note]
    for word in ("PtfmSurge", "Ry(PtfmPitch)", "TTDspFA", "87.6 m"):
        assert word in note
    assert note in " ".join(describe(path, tower_height=HEIGHT).split())


def test_small_angles_turn_by_the_orthonormal_matrix_nearest_to_them(tmp_path: Path) -> None:
    """The polar factor of I + [a]x, as FAST turned its platforms, by scipy."""
    table, _ = float_about(amplitude=3.0)
    path = writers.fast_text(tmp_path / "old.out", table)
    got = read(path, tower_height=HEIGHT, rotation="small").channels
    for row in (10, 500, 2000):
        at = {name: values[row] for name, (_, values) in table.items()}
        roll, pitch, yaw = (np.deg2rad(at[name]) for name in ALL[2:5])
        small = np.array([[1.0, -yaw, pitch], [yaw, 1.0, -roll], [-pitch, roll, 1.0]])
        top = polar(small)[0] @ [at["TTDspFA"], at["TTDspSS"], HEIGHT + at["YawBrTDzt"]]
        assert got["position_x"][row] == pytest.approx(at["PtfmSurge"] + top[0], abs=1e-6)
        assert got["position_y"][row] == pytest.approx(at["PtfmSway"] + top[1], abs=1e-6)
    assert "none of zyx, small" in refusal(path, tower_height=HEIGHT, rotation="xyz")


def test_a_moving_platform_needs_height_and_parts_unless_told_otherwise(tmp_path: Path) -> None:
    table, truth = float_about()
    path = writers.fast_text(tmp_path / "floating.out", table)
    said = refusal(path)
    assert "columns.tower_height" in said
    assert "columns.motion=tower" in said
    assert said.partition(": ")[2] in " ".join(describe(path).split())
    tower = read(path, motion="tower")
    np.testing.assert_allclose(tower.channels["position_x"], table["TTDspFA"][1], atol=1e-7)
    assert any("relative to the tower base" in note for note in tower.notes)
    platform = read(path, motion="platform").channels
    np.testing.assert_allclose(platform["position_y"], table["PtfmSway"][1], atol=1e-7)
    rigid = read(path, motion="rigid", tower_height=HEIGHT).channels["position_x"]
    assert np.std(rigid - truth[:, 0]) == pytest.approx(np.std(table["TTDspFA"][1]), rel=0.05)
    for lost, role in (("PtfmPitch", "platform_pitch"), ("PtfmSway", "platform_sway")):
        part = writers.fast_text(tmp_path / "part.out", without(table, lost))
        assert f"{role} ({lost})" in refusal(part, tower_height=HEIGHT)
    stiff = writers.fast_text(tmp_path / "stiff.out", without(table, *ALL[5:]))
    assert "tower_x" in (said := refusal(stiff, tower_height=HEIGHT))
    assert "columns.motion=rigid" in said
    planar = writers.fast_text(tmp_path / "planar.out", without(table, *ALL[1:3], ALL[4], ALL[6]))
    assert set(read(planar, tower_height=HEIGHT).channels) == {"position_x"}


def test_a_fixed_foundation_moves_as_the_tower_bends(tmp_path: Path) -> None:
    table, _ = float_about(amplitude=0.0)
    still = read(writers.fast_text(tmp_path / "still.out", table))
    np.testing.assert_allclose(still.channels["position_x"], table["TTDspFA"][1], atol=1e-7)
    assert any("the platform does not move" in note for note in still.notes)
    alone = writers.fast_text(tmp_path / "alone.out", without(table, *ALL[:4]))  # but PtfmYaw
    recording = read(alone)
    assert recording.names["position_y"] == "TTDspSS"
    assert any("relative to the tower base" in note for note in recording.notes)


def test_whole_positions_come_first_and_of_several_gauges_none(tmp_path: Path) -> None:
    table, truth = float_about()
    own = {f"{name}{axis}i": ("m", values) for name in ("TwHt1TP", "TwrTpTD") for axis, values in
           zip("xy", truth.T, strict=True)}  # fmt: skip
    top = writers.fast_text(tmp_path / "top.out", {**table, **own})
    assert read(top).names["position_x"] == "TwrTpTDxi"
    gauge = {**table, **without(own, "TwrTpTDxi", "TwrTpTDyi")}
    one = writers.fast_text(tmp_path / "one.out", gauge)
    recording = read(one)
    assert recording.names["position_y"] == "TwHt1TPyi"
    assert any("a gauge at a height" in note for note in recording.notes)
    assert "PtfmSurge" in read(one, tower_height=HEIGHT).names["position_x"]
    two = {**without(gauge, *ALL), "TwHt2TPxi": ("m", truth[:, 0])}
    several = writers.fast_text(tmp_path / "two.out", two)
    assert "name the highest, e.g. columns.position_x=TwHt2TPxi" in refusal(several)
    assert read(several, columns={"position_x": "TwHt2TPxi"}).names["position_x"] == "TwHt2TPxi"


def test_parts_of_other_names_are_composed_too(tmp_path: Path) -> None:
    table, truth = float_about()
    names = dict(zip(ALL, ("a", "b", "c", "d", "e", "x", "y", "z"), strict=True))
    own = {names.get(name, name): item for name, item in table.items()}
    path = writers.fast_text(tmp_path / "own.out", own)
    roles = ("platform_surge", "platform_sway", "platform_roll", "platform_pitch", "platform_yaw",
             "tower_x", "tower_y", "tower_z")  # fmt: skip
    columns = dict(zip(roles, names.values(), strict=True))
    got = read(path, columns=columns, tower_height=HEIGHT).channels["position_y"]
    np.testing.assert_allclose(got, truth[:, 1], atol=1e-6)
    assert "give one of them" in refusal(path, columns={**columns, "position_x": "x"})
    named = read(path, columns={"position_x": "x", "position_y": ""})
    assert named.names["position_x"] == "x"


def test_a_bending_that_the_user_names_is_taken_and_said(tmp_path: Path) -> None:
    path = writers.fast_text(tmp_path / "floating.out", float_about()[0])
    recording = read(path, columns={"position_x": "TTDspFA"})
    assert recording.names["position_x"] == "TTDspFA"
    assert any("PtfmPitch" in note and "left out" in note for note in recording.notes)


def test_of_several_bodies_the_first_is_taken_and_said(tmp_path: Path) -> None:
    name, x = "State pos x  coo: global", np.sin(TIME)
    np.savez(tmp_path / "a.npz", **{"Time": TIME, name: x, f"{name} (2)": 2 * x})
    recording = read(tmp_path / "a.npz")
    assert recording.names["position_x"] == name
    assert any("the first of 2 channels" in note for note in recording.notes)


def test_beside_a_force_the_motion_is_the_reference_and_may_be_left_out(tmp_path: Path) -> None:
    table, truth = float_about()
    force = {"acc_x": ("m/s^2", np.sin(TIME))}
    path = writers.fast_text(tmp_path / "a.out", {**table, **force})
    got = read(path, tower_height=HEIGHT).channels["reference_x"]
    np.testing.assert_allclose(got, truth[:, 0], atol=1e-6)
    bare = read(path)
    assert not bare.has("reference")
    assert any("columns.tower_height" in note for note in bare.notes)
    left = {"reference_x": "", "reference_y": ""}
    assert not read(path, columns=left, tower_height=HEIGHT).has("reference")
    gauge = writers.fast_text(
        tmp_path / "b.out", {**force, **table, "TwHt1TPxi": ("m", truth.T[0])}
    )
    assert read(gauge).names["reference_x"] == "TwHt1TPxi"
