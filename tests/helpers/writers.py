"""Writers of the formats, each made from the documented layout alone, for the tests."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

Table = dict[str, tuple[str, np.ndarray]]  # name -> (unit, values), time first


def fast_binary(path: Path, table: Table, kind: int, length: int = 18) -> Path:
    """.outb after OpenFAST's WrBinFAST."""
    names = list(table)
    time = table[names[0]][1]
    data = np.array([table[name][1] for name in names[1:]]).T
    length = length if kind == 4 else 10
    low, high = data.min(axis=0), data.max(axis=0)
    scale = (65535.0 / np.where(high > low, high - low, 1.0)).astype("<f4")
    offset = (-32768.0 - low * scale.astype(float)).astype("<f4")
    out = struct.pack("<h", kind)
    if kind == 4:
        out += struct.pack("<h", length)
    out += struct.pack("<ii", data.shape[1], len(time))
    time_scale = 2.0**31 / (time[-1] - time[0] + 1.0)
    time_offset = -time[0] * time_scale
    step = (time[-1] - time[0]) / (len(time) - 1)
    out += struct.pack("<dd", *((time_scale, time_offset) if kind == 1 else (time[0], step)))
    if kind != 3:
        out += scale.tobytes() + offset.tobytes()
    text = b"made by the tests"
    out += struct.pack("<i", len(text)) + text
    out += b"".join(name.encode().ljust(length)[:length] for name in names)
    out += b"".join(f"({table[name][0]})".encode().ljust(length)[:length] for name in names)
    if kind == 1:
        out += np.rint(time * time_scale + time_offset).astype("<i4").tobytes()
    if kind == 3:
        out += data.astype("<f8").tobytes()
    else:
        packed = data * scale.astype(float) + offset.astype(float)
        out += np.clip(np.rint(packed), -32768, 32767).astype("<i2").tobytes()
    path.write_bytes(out)
    return path


def fast_text(path: Path, table: Table) -> Path:
    """.out: preamble, names, units, numbers between tabs."""
    lines = ["", "Predictions were made by the tests", "linked with nothing", "", "A case", ""]
    lines.append("\t".join(f"{name:<10}" for name in table))
    lines.append("\t".join(f"{f'({unit})':<10}" for unit, _ in table.values()))
    columns = [values for _, values in table.values()]
    lines += ["\t".join(f"{v:15.8E}" for v in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join(lines) + "\n")
    return path


def hawc2(folder: Path, table: Table, kind: str) -> Path:
    """.sel and .dat; time starts at the first step, as HAWC2's does."""
    data = np.array([values for _, values in table.values()])
    count, scans = data.shape
    rule = "_" * 100
    lines = [rule, "  Version ID : tests", "", "", rule, "  Result file : record.dat", rule]
    lines.append("   Scans    Channels    Time [sec]      Format")
    duration = scans * (data[0, 1] - data[0, 0])
    lines.append(f"{scans:11d}{count:7d}{duration:15.3f}       {kind}")
    lines += ["", "  Channel   Variable Description               ", ""]
    for place, (name, (unit, _)) in enumerate(table.items()):
        lines.append(f"{place + 1:6d}      {name:<31}{unit:<11}{name} described at length")
    lines += [rule]
    if kind == "BINARY":
        factors = np.abs(data).max(axis=1) / 32000.0
        safe = np.where(factors > 0, factors, 1.0)
        lines += ["Scale factors:", *(f"{value:13.5E}" for value in safe)]
        printed = np.array([float(f"{value:13.5E}") for value in safe])
        packed = np.rint(data / printed[:, None]).astype("<i2")
        (folder / "record.dat").write_bytes(packed.tobytes())
    else:
        rows = ["".join(f"{value:14.5E}" for value in row) for row in data.T]
        (folder / "record.dat").write_text("\n".join(rows) + "\n")
    path = folder / "record.sel"
    path.write_text("\n".join(lines) + "\n")
    return path


def gtsdf(path: Path, table: Table, *, packed: bool, blocks: int = 2) -> Path:
    """HDF5 in the general time series data format, in several blocks."""
    import h5py

    names = list(table)[1:]
    time = table[next(iter(table))][1]
    data = np.array([table[name][1] for name in names]).T
    with h5py.File(path, "w") as file:
        file.attrs["type"] = "General time series data format"
        file.attrs["no_blocks"] = blocks
        file.create_dataset("attribute_names", data=[name.encode() for name in names])
        file.create_dataset("attribute_units", data=[table[name][0].encode() for name in names])
        for number, rows in enumerate(np.array_split(np.arange(len(time)), blocks)):
            group = file.create_group(f"block{number:04d}")
            group.attrs["time_start"] = time[rows[0]]
            group.attrs["time_step"] = (time[-1] - time[0]) / (len(time) - 1)
            part = data[rows]
            if packed:
                low = np.nanmin(part, axis=0)
                gain = np.maximum(np.nanmax(part, axis=0) - low, 1e-12) / (2**16 - 2)
                counts = np.where(np.isnan(part), 2**16 - 1, np.rint((part - low) / gain))
                group.create_dataset("data", data=counts.astype(np.uint16))
                group.create_dataset("gains", data=gain)
                group.create_dataset("offsets", data=low)
            else:
                group.create_dataset("data", data=part)
    return path
