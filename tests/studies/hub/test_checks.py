"""Refused inputs: one line that names the argument and what would work; good ones pass."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tools import configure, from_mapping, lay_over

from owtsweep.config import as_mapping, changed
from owtsweep.errors import InputError
from owtsweep.studies import compose
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.sensors import sensors
from owtsweep.studies.hub.study import HubStudy


@pytest.fixture(scope="module")
def default() -> dict:
    return as_mapping(compose(["experiment=study", "tuning=paper"]))


def message_of(error: InputError, key: str) -> str:
    """The message, checked to be one clear line that begins with the argument."""
    message = str(error)
    assert "\n" not in message
    assert re.match(rf"{re.escape(key)}\b", message), message
    assert 20 < len(message) < 250, message
    return message


# What Hydra itself would answer with several lines, or not at all.
COMPOSED = [
    ("grid.replicate=2", "grid.replicate", r"no such key; did you mean grid\.replicates\?"),
    ("hme.smother_window=3", "hme.smother_window", r"did you mean hme\.smoother_window\?"),
    ("smoother_window=3", "smoother_window", r"did you mean hme\.smoother_window\?"),
    ("replicates=2", "replicates", r"did you mean grid\.replicates or tune\.replicates\?"),
    ("sigma=1", "sigma", r"did you mean sensors\.gnss\.sigma or sensors\.imu\.sigma\?"),
    ("schemes.rate=5", "schemes.rate", r"no such key; schemes is a list: use schemes=\[\.\.\.\]"),
    ("+extra=1", "extra", r"no such key"),
    ("++sensors.gnss.foo=1", "sensors.gnss.foo", r"no such key"),
    ("tuning=foo", "tuning", r"there is no 'foo'; use matched or paper or printed"),
    ("spectrum=jonswap", "spectrum", r"there is no 'jonswap'; use printed or translated"),
    ("grid.natural_period=[4", "grid.natural_period", r"no override; use key=value"),
    ("grid", "grid", r"no override; use key=value"),
    ("sensors=5", "sensors", r"config group"),
    ("tuning=[1,2]", "tuning", r"config group"),
    *(
        (f"spectrum=printed grid.natural_period=[{T}]", "spectrum=printed",
         rf"no finite peak at {T} s .* use spectrum=translated")
        for T in (3, 4, 5)
    ),
    ("spectrum=printed grid.natural_period=[6.5]", "spectrum=printed", r"no natural period 6\.5 s"),
    ("schemes=[{_target_: nowhere.Class}]", "schemes", r"nowhere\.Class cannot be made \(ModuleN"),
]  # fmt: skip


@pytest.mark.parametrize(("overrides", "key", "message"), COMPOSED, ids=[c[0] for c in COMPOSED])
def test_refused_by_compose(overrides: str, key: str, message: str) -> None:
    given = [overrides] if "{" in overrides else overrides.split(" ")
    with pytest.raises(InputError) as caught:
        compose(given)
    assert re.search(message, message_of(caught.value, key))


# What `compose` passes on to the typed configuration, straight to it: Hydra takes .2 s each.
VALUES = [
    ("sensors.gnss.rate=abc", "'abc' is not a number"),
    ("sensors.gnss.rate=null", "None is not a number"),
    ("grid.replicates=2.5", "2.5 is neither a whole number nor auto"),
    ("grid.replicates=true", "True is not a whole number"),
    ("measures.extremes=maybe", "'maybe' is not true or false"),
    ("grid.natural_period=4", r"4 is no list; use e.g. grid.natural_period=\[4\]"),
    ("schemes=MKF", r"'MKF' is no list; use e.g. schemes=\[MKF\]"),
    ("hme.mhe=3", "one value where keys are expected"),
    ("grid.natural_period=[]", "the list is empty; give at least one value, in s"),
    ("grid.amplitude=[]", "the list is empty; give at least one value, in m"),
    ("schemes=[]", r"the list is empty; use e.g. schemes=\[EKF,MKF\]"),
    ("grid.natural_period=[4,-4]", "-4 s must be a finite number above zero"),
    ("grid.natural_period=[0]", "0 s must be a finite number above zero"),
    ("grid.natural_period=[4,4.0]", "twice"),
    ("grid.amplitude=[0]", "0 m must be a finite number above zero"),
    ("grid.amplitude=[1,-0.5]", "-0.5 m must be a finite number above zero"),
    ("grid.amplitude=[.nan]", "nan m must be"),
    ("grid.replicates=0", "0 must be at least 1"),
    ("sensors.gnss.sigma=0", "0 m must be"),
    ("sensors.gnss.sigma=-0.03", "-0.03 m must be"),
    ("sensors.imu.sigma=0", "0 m/s.2 must be"),
    ("sensors.imu.sigma=-1", "-1 m/s.2 must be"),
    ("sensors.gnss.rate=0", "0 Hz must be"),
    ("sensors.gnss.rate=-1", "-1 Hz must be"),
    ("sensors.imu.rate=0", "0 Hz must be"),
    ("sensors.imu.rate=-100", "-100 Hz must be"),
    ("sensors.imu.bias_walk=-1e-3", "zero or above"),
    ("sensors.imu.bias_initial=.inf", "finite"),
    ("sensors.yaw=.nan", "nan deg must be a finite number"),
    ("wave_direction=.inf", "inf deg must be a finite number"),
    ("sensors.gravity=[0]", "two numbers, north and east"),
    ("sensors.gnss.rate=200", "200 Hz is above the IMU's 100 Hz"),
    ("sensors.gnss.rate=3", r"3 Hz does not divide the IMU's 100 Hz; use 2.94117\d+ or 3.0303"),
    ("sensors.gnss.rate=60", "use 50 or 100"),
    ("sensors.gnss.delay=0.123", "no multiple of the IMU step 0.01 s; use 0.12 or 0.13"),
    ("sensors.gnss.delay=0.004", "use 0 or 0.01"),
    ("sensors.gnss.delay=-0.1", "zero or above"),
    ("sensors.gnss.delay=2000", "no shorter than record.duration 2000 s"),
    ("spectrum.kind=foo", "none of translated, printed"),
    ("spectrum.bandwidth=0", "must be a finite number above zero"),
    ("band=[0.6,0.05]", r"reversed or equal; use band=\[0.05,0.6\]"),
    ("band=[0.1,0.1]", "reversed or equal"),
    ("band=[0.1]", r"two edges in Hz, e.g. band=\[0.05,0.6\]"),
    ("band=[0,0.6]", "0 Hz must be"),
    ("grid.natural_period=[1.5]", "peak at 0.667 Hz, outside band"),
    ("band=[0.05,51]", "51 Hz is not below the Nyquist frequency 50 Hz"),
    ("band=[0.0501,0.0502]", "holds no line"),
    ("record.duration=0", "0 s must be a finite number above zero"),
    ("record.duration=-5", "-5 s must be a finite number above zero"),
    ("record.duration=20", "no longer than measures.settling_time 20 s; lengthen the record"),
    ("record.duration=30.005", "no multiple of the IMU step 0.01 s; use 30 or 30.01"),
    ("measures.settling_time=-1", "zero or above"),
    ("measures.window=all", "none of full, settled"),
    ("measures.extremes=true", "add evaluation=direct"),
    ("hme.smoother_window=200000", "longer than the record of 200000 steps"),
    ("hme.smoother_window=-1", "use 0 for no smoother"),
    ("hme.mhe.smoother_window=-1", "use 0 for no smoother"),
    ("hme.mhe.horizon=2000", "longer than the record of 2000 s"),
    ("hme.mhe.horizon=0", "at least 1 GNSS interval"),
    ("hme.mhe.interval=0.03", "divides the GNSS interval 1 s; use 0.02 or 0.04"),
    ("hme.mhe.interval=2", "use 1$"),
    ("hme.mhe.interval=0", "must be a finite number above zero"),
    ("hme.mhe.arrival=foo", "none of mkf,"),
    ("hme.mhe.q_a=0", "must be a finite number above zero"),
    ("hme.mhe.p0=[1,1]", "three finite variances above zero"),
    ("schemes=[MKF,MKF]", "stands there twice"),
    (
        "schemes=[FOO]",
        "no scheme 'FOO'; use EKF, MKF, HME1, HME2, NONE, HOLD, DELTA, SKF, SKFA, SWITCH, or",
    ),
    ("schemes=[{_target_: hold_last_fix.Missing}]", "cannot be made .AttributeError"),
    ("schemes=[{_target_: hold_last_fix.HoldLastFix, gain: 2}]", "cannot be made .TypeError"),
    (
        "schemes=[{_target_: decimal.Decimal}]",
        "no class that derives from owtsweep.schemes.hub.S",
    ),
    ("schemes=[{target: foo}]", "neither a name nor"),
    ("schemes=[3]", "neither a name nor"),
    ("mkf.update_rule=foo", "none of proper, mask_columns, mask_rows, every_step"),
    ("mkf.model=sigma3", "none of sigma1, sigma2"),
    ("mkf.p0=[1,1,1,0]", "four finite variances above zero"),
    ("mkf.p0=[1,1,1,.inf]", "four finite variances above zero"),
    ("mkf.q_a=-1", "zero or above"),
    ("mkf.r_gnss.rule=foo", "none of sigma2"),
    ("mkf.r_gnss.scale=0", "must be a finite number above zero"),
    ("seed=-1", "use an integer >= 0"),
    ("engine=fast", "none of batch, reference"),
    ("evaluation=both", "none of superposed, direct"),
    ("normalise=max", "none of peak, rms"),
    ("study=foo", "no study 'foo'"),
    ("compute.workers=-1", "use 0 for all cores"),
    ("compute.backend=mpi", "none of auto"),
    ("name=a/b", "no plain folder name"),
    ("config_version=99", "99 is not known"),
]


@pytest.mark.parametrize(("override", "message"), VALUES, ids=[case[0] for case in VALUES])
def test_refused_values(default: dict, override: str, message: str | None) -> None:
    mapping = lay_over(default, [override])
    if message is None:
        from_mapping(mapping)
        return
    with pytest.raises(InputError) as caught:
        from_mapping(mapping)
    assert re.search(message, message_of(caught.value, override.partition("=")[0]))


def test_no_arrival_term_needs_three_fixes() -> None:
    with pytest.raises(InputError, match=r"^hme\.mhe\.arrival: 'none' needs at least 3 fixes"):
        configure("hme.mhe.horizon=1", "hme.mhe.arrival=none")
    configure("hme.mhe.horizon=2", "hme.mhe.arrival=none")
    configure("hme.mhe.horizon=1", "hme.mhe.arrival=mkf")


def with_gnss(config: HubConfig, **changes: float) -> HubConfig:
    """A checked copy, without OmegaConf: some hundred are made."""
    gnss = changed(config.sensors.gnss, **changes)
    copy = changed(config, sensors=changed(config.sensors, gnss=gnss))
    HubStudy().check(copy)
    return copy


def suggested(message: str) -> list[float]:
    return [
        float(hint) for hint in re.findall(r"[\d.]+(?:e-?\d+)?", message.rpartition("; use ")[2])
    ]


@settings(derandomize=True, max_examples=50, deadline=None)
@given(st.integers(0, 3000), st.floats(0.05, 0.95))
def test_delays_are_multiples_of_the_step_and_the_hints_work(steps: int, beyond: float) -> None:
    config = configure("record.duration=200", "schemes=[MKF]")  # 20 Hz
    assert sensors(with_gnss(config, delay=steps / 20).sensors).delay == steps
    with pytest.raises(InputError) as caught:
        with_gnss(config, delay=(steps + beyond) / 20)
    hints = suggested(message_of(caught.value, "sensors.gnss.delay"))
    found = [sensors(with_gnss(config, delay=hint).sensors).delay for hint in hints]
    assert found == [steps, steps + 1]


@settings(derandomize=True, max_examples=50, deadline=None)
@given(st.integers(1, 400), st.floats(0.05, 0.95))
def test_rates_divide_and_the_hints_work(ratio: int, beyond: float) -> None:
    config = configure("sensors.imu.rate=100", "schemes=[MKF]", "record.duration=100")
    assert sensors(with_gnss(config, rate=100 / ratio).sensors).fix_interval == ratio
    with pytest.raises(InputError) as caught:
        with_gnss(config, rate=100 / (ratio + beyond))
    hints = suggested(message_of(caught.value, "sensors.gnss.rate"))
    found = [sensors(with_gnss(config, rate=hint).sensors).fix_interval for hint in hints]
    assert found == [ratio + 1, ratio]


# Numbers with which nothing can be computed, and sizes that no memory holds.
TOO_MUCH = [
    ("grid.natural_period=[1e300]", "magnitude must be from 1e-30 to 1e.30"),
    ("grid.natural_period=[1e-300]", "magnitude must be"),
    ("grid.amplitude=[1e160]", "magnitude must be"),
    ("grid.amplitude=[5e-324]", "magnitude must be"),
    ("sensors.gnss.sigma=1e200", "magnitude must be"),
    ("sensors.imu.bias_walk=1e200", "magnitude must be"),
    ("sensors.imu.bias_initial=-1e200", "magnitude must be"),
    ("spectrum.bandwidth=1e-300", "magnitude must be"),
    ("mkf.p0=[1,1,1,1e300]", "magnitude must be"),
    ("sensors.gnss.rate=1e-12", "leaves 1e.14 IMU steps between fixes, more than 500000"),
    ("sensors.gnss.sigma='-5'", "-5 m must be"),
    ("record.duration=1e12", "longer than"),
    ("sensors.gnss.delay=1e9", "no shorter than record.duration"),
    ("hme.mhe.horizon=1000000000", "is more than 1000000; lower it"),
    ("hme.mhe.horizon=" + "9" * 400, "is more than 1000000; lower it"),
    ("grid.replicates=" + "9" * 400, "is more than 1000000; lower it"),
    ("grid.amplitude=[{log:[1,2,.inf]}]", "is no entry of an axis"),
    ("spectrum.bandwidth=1e-30", "leaves the peak at 3 s no width"),
]  # fmt: skip


@pytest.mark.parametrize(("override", "message"), TOO_MUCH, ids=[case[0][:40] for case in TOO_MUCH])
def test_refused_before_it_is_computed_with(default: dict, override: str, message: str) -> None:
    mapping = lay_over(default, [override])
    with pytest.raises(InputError, match=message) as caught:
        from_mapping(mapping)
    assert len(str(caught.value)) < 1200


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["grid.natural_period=[{linear:[3,9,9000]}]", "grid.amplitude=[{linear:[1,9,90000]}]"],
         r"^grid: .* need some .* GB"),
        (["grid.replicates=1000000", "grid.natural_period=[{linear:[3,8,9]}]"], r"^grid: .*"),
        (["evaluation=direct", "grid.amplitude=[{linear:[1,9,90000]}]"], r"^grid: .* blocks"),
        (["record.duration=1000000", "sensors.gnss.rate=0.1", "sensors.gnss.delay=900000",
          "hme.smoother_window=19"],
         r"^hme.smoother_window: 19 steps, and 90000000 steps of sensors.gnss.delay, need"),
        (["record.duration=1000000", "hme.smoother_window=700000"],
         r"^hme.smoother_window: 700000 steps, .* need some 4.3 GB, more than 4 GB"),
        (["record.duration=100000", "hme.mhe.horizon=9000"], r"^hme.mhe.horizon: 9000 .* GB"),
    ],
)  # fmt: skip
def test_sizes_that_keys_make_together(default: dict, overrides: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        from_mapping(lay_over(default, overrides))
