"""The parts of the posterior against brute force: direct runs, known densities, known functions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from experiments.ren2019.evidence import SCHEMES, TABLE_CELLS
from experiments.ren2019.posterior import (
    components,
    emulator,
    held_out,
    looks,
    predict,
    records,
    tables,
)
from experiments.ren2019.posterior.check import read_reading
from experiments.ren2019.posterior.evidence import Posterior
from experiments.ren2019.posterior.inference import SEARCHED, name_settings
from experiments.ren2019.posterior.likelihood import Likelihood
from experiments.ren2019.posterior.settings import (
    ACCURACIES,
    LENGTHS,
    NAMES,
    OF_SCHEME,
    SETTINGS,
    Reading,
    columns_of,
    from_unit,
    make_tuning,
)
from owtsweep.config import as_mapping
from owtsweep.config.typed import value_at
from owtsweep.studies import compose
from owtsweep.studies.hub.kernels.layout import WIDTH

#: The records of `simulate_records` and the components are of other seeds; so is what differs.
READING = Reading()


@pytest.fixture(scope="module")
def mkf() -> Iterator[components.Components]:
    """Components of two motions: the four sources of noise come with the first four feeds."""
    names = [setting.name for setting in OF_SCHEME["MKF"]]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(components, "MOTIONS", components.MOTIONS[:2])
        components._list_feeds.cache_clear()
        yield components.simulate("MKF", [{name: SEARCHED[name] for name in names}])[0]
    components._list_feeds.cache_clear()


@pytest.fixture(scope="module")
def numbers() -> np.ndarray:
    return records.simulate_records(READING, SEARCHED, range(WIDTH))


@pytest.mark.usefixtures("kernels")
def test_components_add_up_to_the_error_of_whole_records(mkf, numbers):
    """Superposition: motion, noises and bias, each alone, against records that have all."""
    length = LENGTHS.index(READING.length)
    sizes = np.square([0.03, 0.15, SEARCHED["bias_walk"], SEARCHED["bias_initial"]])
    noise = sizes @ mkf.noise[:, length, 0, 0]
    for line, (table, cell) in enumerate(TABLE_CELLS.items()):
        period = components.PERIODS.index(cell.natural_period)
        along = cell.amplitude**2 * mkf.motion[0, period, length, 0, 0]
        expected = np.array([0.75 * along + noise, 0.25 * along + noise])
        whole = numbers.reshape(4, 4, 4, WIDTH)[line, SCHEMES.index("MKF"), :2]
        assert whole.mean(axis=-1) == pytest.approx(expected, rel=0.35), table


@pytest.mark.usefixtures("kernels")
def test_nested_windows_are_means_over_their_steps(mkf):
    """The settled part's mean and the start's make the whole's; a start that counts adds error."""
    whole, settled = mkf.noise[3, :, 0, 0], mkf.noise[3, :, 1, 0]  # of the bias at the start
    assert (whole > settled).all()
    assert (np.diff(whole) < 0.0).all()  # it is forgotten: the longer, the less


def test_the_print_is_in_the_order_of_the_arrays():
    table = records.print_of_tables()
    assert len(table) == 64
    scheme = [SCHEMES[place // 4 % 4] for place in range(64)]
    assert table["scheme"].tolist() == scheme
    assert table["measure"].tolist() == ["x", "y", "vx", "vy"] * 16
    assert table["table"].tolist() == np.repeat([6, 7, 8, 9], 16).tolist()
    misprint = table[(table["table"] == 7) & (table["scheme"] == "EKF")].iloc[2]
    assert misprint["published"] == 1.98e-3
    # 1.98e-3 is known to half of 1e-5: a uniform error of that width
    assert misprint["rounding"] == pytest.approx((1e-5 / 1.98e-3) ** 2 / 12.0)


def test_students_density_is_that_of_scipy():
    generator = np.random.default_rng(3)
    matrix = np.cov(generator.standard_normal((5, 50)))
    point, freedom = generator.standard_normal(5), 7.0
    factor = np.linalg.cholesky(matrix)
    solved = np.linalg.solve(factor, point)
    ours = records.log_student(solved @ solved, 5, freedom) - np.log(np.diag(factor)).sum()
    shape = matrix * (freedom - 2.0) / freedom  # with this scale the covariance is `matrix`
    assert ours == pytest.approx(stats.multivariate_t(shape=shape, df=freedom).logpdf(point))


def test_freedom_is_found_again():
    drawn = stats.multivariate_t(shape=np.eye(8) * 4.0 / 6.0, df=6.0).rvs(4000, random_state=1)
    assert records.fit_freedom(drawn.T, np.eye(8)) == pytest.approx(6.0, rel=0.15)


def test_shrinking_helps_and_keeps_variances():
    generator = np.random.default_rng(5)
    truth = 0.1 + 0.9 * np.eye(30)
    missed = []
    for _ in range(20):
        rows = generator.multivariate_normal(np.zeros(30), truth, 40)
        shrunk, plain = records.shrink(rows), np.cov(rows.T)
        assert np.diag(shrunk) == pytest.approx(np.diag(plain))
        assert np.linalg.eigvalsh(shrunk)[0] > 0.0
        missed.append([np.linalg.norm(each - truth) for each in (shrunk, plain)])
    assert np.mean(missed, axis=0)[0] < 0.7 * np.mean(missed, axis=0)[1]


def test_the_emulator_meets_a_smooth_function_and_knows_its_error():
    design = tables.make_design("MKF", 128)
    other = np.random.default_rng(2).random((200, design.shape[1]))

    def smooth(points):
        return np.stack(
            [np.sin(2.0 * points[:, 0]) + points[:, 1] ** 2, points.sum(axis=1)], axis=1
        )

    fitted, _ = emulator.fit(design, smooth(design))
    missed = np.array([fitted.predict(point) for point in other]) - smooth(other)
    assert np.abs(missed).max() < 0.05
    assert np.sqrt(np.mean(missed**2, axis=0)) == pytest.approx(fitted.error, rel=3.0, abs=1e-3)


def test_points_where_a_scheme_diverges_are_left_out():
    design = tables.make_design("MKF", 64)
    outputs = design.sum(axis=1, keepdims=True)
    outputs[3], outputs[5] = np.nan, 100.0
    fitted, _ = emulator.fit(design, outputs)
    assert len(fitted.points) == 62


def test_the_unit_cube_is_the_prior():
    ends = from_unit(np.array([np.zeros(len(SETTINGS)), np.ones(len(SETTINGS))]))
    assert ends[0] == pytest.approx([setting.low for setting in SETTINGS])
    assert ends[1] == pytest.approx([setting.high for setting in SETTINGS])
    for scheme in SCHEMES:
        assert [NAMES[place] for place in columns_of(scheme)] == [s.name for s in OF_SCHEME[scheme]]


def make_likelihood(**changes) -> Likelihood:
    """A likelihood whose schemes have an error of 1 (a logarithm of 0) wherever they are."""
    scatter = records.Scatter(np.zeros(64), 0.01 * np.eye(64), 50.0)
    return replace(Likelihood(READING, fit_flat_schemes(), scatter), **changes)


@cache
def fit_flat_schemes() -> dict[str, emulator.Emulator]:
    fitted = {}
    for scheme, settings in OF_SCHEME.items():
        design = np.random.default_rng(1).random((60, len(settings)))
        fitted[scheme], _ = emulator.fit(design, np.zeros((60, 14)) + 1e-9 * design[:, :1])
    return fitted


def test_the_likelihood_adds_components_by_the_directions_of_the_waves():
    likelihood = make_likelihood()
    point = np.full(likelihood.dimensions, 0.5)
    mean, _ = likelihood.predict(point)
    values = dict(zip(NAMES, from_unit(point[: len(NAMES)]), strict=True))
    noise = 0.03**2 + 0.15**2 + values["bias_walk"] ** 2 + values["bias_initial"] ** 2
    by_hand = [
        np.log(cell.amplitude**2 * share + noise)
        for cell in TABLE_CELLS.values()
        for _ in SCHEMES
        for share in (0.75, 0.25, 0.75, 0.25)
    ]
    assert mean == pytest.approx(by_hand, abs=1e-4)


def test_a_discrepancy_is_equal_in_x_and_y_and_widens_one_scheme_alone():
    likelihood = make_likelihood()
    point = np.full(likelihood.dimensions, 0.5)
    point[len(NAMES) :] = [1e-9, 1e-9, 0.6827, 1e-9]  # HME1's scale is the prior's, .3
    added = likelihood.covariance(point, np.zeros(64)) - likelihood.fixed
    hme1 = np.arange(64) // 4 % 4 == SCHEMES.index("HME1")
    assert np.diag(added)[hme1] == pytest.approx(0.09, rel=1e-3)
    assert np.abs(added[~hme1]).max() < 1e-12
    first = int(np.argmax(hme1))
    assert added[first, first + 1] == pytest.approx(0.09, rel=1e-3)  # x and y
    assert added[first, first + 2] == 0.0  # x and vx


def test_without_discrepancy_the_last_four_numbers_do_not_matter():
    likelihood = make_likelihood(discrepant=False)
    low, high = np.full(likelihood.dimensions, 0.5), np.full(likelihood.dimensions, 0.5)
    high[len(NAMES) :] = 0.9
    assert likelihood(low) == likelihood(high)


@pytest.mark.parametrize(
    ("less", "expected"),
    [
        ((4.0, 0.0, -1.0), 0.5),  # HME2 is the better below half a metre
        ((3.0, 1.0, -1.0), 1.0 / 3.0),
        ((1.0, 0.0, 1.0), 0.0),  # HME1 is, everywhere
        ((-1.0, 0.0, -1.0), np.inf),
    ],
)
def test_boundaries_are_where_the_errors_are_equal(less, expected):
    found = held_out.find_boundaries(np.array(less)[:, None])
    assert found == pytest.approx(expected)


def test_statements_hold_in_a_map_made_to_hold_them():
    """A map as the paper tells of it: EKF least, MKF at two cells, HME2 then HME1."""
    periods, amplitudes = len(held_out.GRID), len(held_out.AMPLITUDES)
    grid = np.ones((2, periods, amplitudes, 4, 1)) * np.array([2.0, 1.2, 1.1, 1.0])[:, None]
    boundary = np.array([0.2, 0.3, 0.6, 1.0, 1.5, 2.0])
    for line, amplitude in enumerate(held_out.AMPLITUDES):
        above = amplitude > boundary
        grid[:, above, line, 2], grid[:, above, line, 3] = 1.0, 1.1
    grid[:, :, 0, 0] = 0.5
    grid[:, 1:3, held_out.AMPLITUDES.index(0.5), 1] = 0.95
    history = np.full((4, 4, 1), 1e-4)
    history[3, 0], history[3, 2] = 2e-4, 0.5e-4
    made = held_out.Map(grid, np.repeat(boundary[None, :, None], 2, axis=0), history)
    assert all(held.all() for held in held_out.judge(made, 1).values())
    worse = made._replace(boundary=made.boundary * 3.0)
    judged = held_out.judge(worse, 1)
    assert not judged["F3"].any()
    assert not judged["F4"].any()
    assert judged["F5"].all()  # 6 m at 8 s: still a boundary, and rising


def test_scatter_is_about_each_draws_own_mean():
    """Draws differ in their means by factors; that is no scatter of one record."""
    generator = np.random.default_rng(4)
    levels = generator.standard_normal((10, 64, 1))
    logs = levels + 0.2 * generator.standard_normal((10, 64, 200))
    found = records.find_scatter(np.exp(logs), READING)
    assert np.diag(found.covariance) == pytest.approx(0.04, rel=0.15)
    # a log-normal mean lies half a variance above the median
    assert found.offset == pytest.approx(-0.02, abs=0.02)
    few = records.find_scatter(np.exp(logs[:, :, :4]), READING)  # each draw's mean is of four
    assert np.mean(np.diag(few.covariance)) == pytest.approx(0.04, rel=0.1)


@pytest.mark.usefixtures("kernels")
def test_records_are_numbered(numbers):
    other = records.simulate_records(READING, SEARCHED, range(5, 5 + WIDTH))
    assert np.allclose(other[:, : WIDTH - 5], numbers[:, 5:], rtol=1e-12)


def test_ratios_of_what_the_motion_causes_are_found_again():
    generator = np.random.default_rng(6)
    motion, noise = generator.uniform(1.0, 2.0, (2, 4, 4, 2))  # of a table, scheme and quantity
    motion[2] = motion[1]  # tables 7 and 8 have one period
    squares = np.array([cell.amplitude**2 for cell in TABLE_CELLS.values()])
    total = motion * squares[:, None, None] + noise[0]
    numbers = (total[..., None] * [0.6, 0.4]).ravel()  # x and y
    expected = motion[..., 1] / motion[..., 0]
    assert predict.find_ratios(numbers) == pytest.approx(expected)


def make_look(evidence: float, **changes) -> looks.Look:
    points = np.linspace(0.0, 1.0, 50)[:, None] * np.ones(len(NAMES) + len(SCHEMES))
    likelihood = make_likelihood(reading=replace(READING, **changes))
    return looks.Look(likelihood, Posterior(evidence, 0.5, points, points[:, 0]))


def test_a_reading_is_followed_until_its_evidence_stays(monkeypatch):
    """The first moves by 4, 2 and 1, so that it is settled; the second never is."""
    steps = {"level": [4.0, 2.0, 1.0, 9.0], "against": [5.0] * 9}

    def turn(_, some):
        found = []
        for look in some:
            moved = steps[look.reading.force][look.turns]
            now = look.posterior._replace(evidence=look.posterior.evidence + moved)
            found.append(looks.Look(look.likelihood, now, look.turns + 1, moved))
        return found

    monkeypatch.setattr(looks, "take_turn", turn)
    first, second = looks.follow(None, [make_look(0.0), make_look(0.0, force="against")])
    assert (first.turns, first.moved, first.posterior.evidence) == (3, 1.0, 7.0)
    assert (second.turns, second.posterior.evidence) == (looks.TURNS, 5.0 * looks.TURNS)


def test_a_twin_with_shared_seeds_is_not_settled_by_the_evidence_of_the_own_ones():
    twin = looks.share_seeds(make_look(3.0))
    assert twin.reading.seeds == "shared"
    assert np.isnan(twin.posterior.evidence)
    assert not looks.is_settled(twin._replace(turns=1, moved=3.0 - twin.posterior.evidence))


def test_half_of_the_draws_are_of_the_look_before():
    look, other = make_look(0.0), make_look(1.0)
    points = look.posterior.points
    assert look.draws == list(map(name_settings, points[: records.DRAWS]))
    before = other.posterior._replace(points=points[::-1])
    half = records.DRAWS // 2
    expected = [*points[::-1][:half], *points[:half]]
    assert look._replace(before=before).draws == list(map(name_settings, expected))


def test_a_turn_samples_with_the_draws_before_it(monkeypatch):
    asked = []
    sampled = make_look(5.0).posterior

    def take_own(_, some):
        asked.extend(look.draws for look in some)
        return [look.likelihood for look in some]

    monkeypatch.setattr(looks, "take_own", take_own)
    monkeypatch.setattr(looks, "sample_all", lambda some, live: [sampled for _ in some])
    last = make_look(3.0)
    (turned,) = looks.take_turn(None, [last])
    assert asked == [last.draws]
    assert (turned.turns, turned.moved) == (1, 2.0)
    assert turned.posterior is sampled
    assert turned.before is last.posterior


def test_the_closest_readings_have_a_level_one_of_each_kind_of_seeds():
    some = [make_look(-number, force="against") for number in range(looks.CLOSEST + 2)]
    level = [make_look(-9.0), make_look(-8.0, seeds="shared"), make_look(-10.0)]
    chosen = [look.posterior.evidence for look in looks.choose_closest([*some, *level])]
    assert chosen == [*(-float(number) for number in range(looks.CLOSEST)), -8.0, -9.0]
    assert len(looks.choose_near([*some, *level], 8.5)) == looks.CLOSEST + 3


def test_experiment_paper_is_the_mode_of_the_best_reading():
    """Its three digits. Filters are told the reading's sensors, so all variances have its share."""
    folder = Path(__file__).parents[2] / "results/reference/posterior"
    reading = read_reading(pd.read_csv(folder / "evidence.csv"))
    mode = pd.read_csv(folder / "settings.csv").set_index("setting")["mode"].to_dict()
    expected = dict(reading.motion)
    expected["record.duration"] = reading.length
    expected |= {f"sensors.imu.{name}": mode[name] for name in ("bias_initial", "bias_walk")}
    share = ACCURACIES[reading.accuracy]
    for scheme, own in OF_SCHEME.items():
        expected |= make_tuning(scheme, {each.name: mode[each.name] for each in own})
    config = compose(["experiment=paper", "tuning=paper"])
    assert config.sensors.deviations == pytest.approx(1.0 / share)
    plain = as_mapping(config)
    for key, value in expected.items():
        found = value_at(plain, key)
        if isinstance(value, dict):
            assert found["rule"] == value["rule"]
            found, value = found["scale"], value["scale"]
        elif key.endswith((".q_a", ".q_b", ".p0")):
            value = np.multiply(value, share**2)
        assert found == pytest.approx(value, rel=5e-3), key
