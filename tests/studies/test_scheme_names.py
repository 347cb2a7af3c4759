"""Keys of another study: what a user types out of habit is refused in words that help."""

from __future__ import annotations

import pytest

from owtsweep.errors import InputError
from owtsweep.studies import compose

OTHERS = ("tower", "floater", "blade", "mating")


@pytest.mark.parametrize("study", OTHERS)
def test_an_unknown_name_is_refused(study: str) -> None:
    with pytest.raises(InputError, match="schemes: there is no scheme 'mine'"):
        compose([f"study={study}", "schemes=[mine]"])


def test_a_class_of_a_users_says_where_it_would_run() -> None:
    with pytest.raises(InputError, match=r"^schemes: .* is no name; .* runs in study=blade"):
        compose(["study=mating", "schemes=[{_target_: mine.HoldLastFix}]"])


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["study=tower", "sensors.gnss.rate=5"],
         r"^sensors\.gnss\.rate: .*; sensors\.gnss is a list in m: use sensors\.gnss=\[\.\.\.\]$"),
        (["study=tower", "sensors.gnss.0=80"],
         r"^sensors\.gnss\.0: .*; sensors\.gnss is a list in m"),
        (["study=floater", "grid.snr.x=3"], r"^grid\.snr\.x: .*; grid\.snr is a list in dB"),
        (["study=blade", "sensors.gnss.rate=5"],
         r"^sensors\.gnss\.rate: .*; below sensors there are sensors\.fix_rate, "),
        *(([f"study={study}", "replicates=2"],
           r"^replicates: .* did you mean grid\.replicates( or tune\.replicates)?\?$")
          for study in OTHERS),
    ],
)  # fmt: skip
def test_a_key_of_the_hub_study_leaks_no_python(words: list[str], says: str) -> None:
    with pytest.raises(InputError, match=says) as caught:
        compose(words)
    assert "literal" not in str(caught.value)
