"""Outliers, lost fixes and red noise as truths: who sees them, and that the engines agree."""

from __future__ import annotations

import numpy as np
import pytest
from tools import configure, rows_of

from owtsweep.errors import InputError
from owtsweep.studies.hub.records import make_records

pytestmark = pytest.mark.usefixtures("kernels")

OUTLIERS = "sensors.gnss.outliers.rate=0.2"
LOSS = ("sensors.gnss.loss.probability=0.1", "sensors.gnss.loss.length=3")
RED = ("sensors.gnss.correlation.sigma=0.5", "sensors.gnss.correlation.time=20")
SCHEMES = "schemes=[EKF,MKF,HME1,HME2,HOLD,DELTA]"


def added(*overrides: str) -> np.ndarray:
    return make_records(configure(*overrides), 4.0, [0]).fix_noise(0)


def test_each_fault_has_its_own_streams() -> None:
    white, outliers, red = added(), added(OUTLIERS), added(*RED)
    hit = np.any(outliers != white, axis=1)
    assert 0 < hit.sum() < len(white)
    np.testing.assert_allclose(added(OUTLIERS, *RED), outliers + red - white, atol=1e-12)
    assert not np.allclose((red - white)[0] / 0.5, white[0] / 0.03)
    kept = added(OUTLIERS, *LOSS)
    lost = np.isnan(kept).all(axis=1)
    assert 0 < lost.sum() < len(white)
    np.testing.assert_array_equal(kept[~lost], outliers[~lost])


@pytest.mark.parametrize("faults", [(OUTLIERS, *RED), LOSS])
def test_the_engines_agree_superposed_and_direct(faults: tuple[str, ...]) -> None:
    base = (*faults, SCHEMES, "record.duration=12", "grid.amplitude=[0.7]")
    batch = rows_of(configure(*base))
    reference = rows_of(configure(*base, "engine=reference"))
    direct = rows_of(configure(*base, "evaluation=direct"))
    assert len(batch) == len(reference) == len(direct)
    for key, row in batch.items():
        other = reference[key]
        for part in ("motion", "cross", "noise"):
            scale = abs(row["motion"]) + abs(row["noise"])
            assert row[part] == pytest.approx(other[part], rel=1e-7, abs=1e-7 * scale), key
        assert row["n_samples"] == other["n_samples"]
        A = 0.7
        whole = A * A * row["motion"] + 2.0 * A * row["cross"] + row["noise"]
        assert direct[key._replace(amplitude=A)]["value"] == pytest.approx(whole, rel=1e-7)


def test_what_is_lost_costs_and_is_stated() -> None:
    base = ("schemes=[MKF]", "tuning=matched", "record.duration=400", "engine=batch")
    rows = [rows_of(configure(*base, *extra, tuning="matched")) for extra in ((), LOSS)]
    mse, nees = (
        [next(row["noise"] for key, row in table.items()
              if (key.measure, key.window) == (measure, "settled")) for table in rows]
        for measure in ("position", "nees")
    )  # fmt: skip
    assert mse[1] > 1.3 * mse[0]
    assert nees[1] == pytest.approx(4.0, abs=1.5)  # the gains are those of the fixes that came


@pytest.mark.parametrize(("override", "named"), [
    (OUTLIERS, "outliers"), (LOSS[0], "loss"), (RED[0], "correlation"),
])  # fmt: skip
def test_the_expected_engine_refuses(override: str, named: str) -> None:
    from owtsweep.studies.hub.checks import check

    with pytest.raises(InputError, match=rf"^sensors\.gnss\.{named}: engine=expected knows white"):
        check(configure(override, "engine=expected"))


def test_more_outliers_than_good_fixes_are_refused() -> None:
    with pytest.raises(InputError, match=r"sensors\.gnss\.outliers\.rate: .*0\.5"):
        configure("sensors.gnss.outliers.rate=0.6")
