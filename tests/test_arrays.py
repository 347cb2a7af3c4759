"""Arrays for kernels begin where a cache line does."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.arrays import LINE, Past, aligned, make_rows


@pytest.mark.parametrize("shape", [(1, 8), (7, 8), (3, 11, 8), (5,)])
def test_aligned_arrays_are_zero_and_plain(shape):
    for _ in range(5):  # an allocator gives good addresses by chance
        array = aligned(*shape)
        assert array.shape == shape
        assert array.flags.c_contiguous
        assert array.flags.writeable
        assert not array.any()
        assert array.ctypes.data % LINE == 0


def test_the_rows_of_kernels_are_aligned_and_plain():
    made = make_rows(3, 24, "p", "v")
    assert made.shape == (3,)
    assert made.flags.c_contiguous
    assert made["v"].shape == (3, 24)
    assert made.ctypes.data % LINE == 0
    assert made.strides[0] % LINE == 0
    assert not made["p"].any()


def test_the_past_is_the_last_columns_however_they_come():
    rng, all_of_it = np.random.default_rng(1), np.zeros((2, 0))
    past = Past(2, 10)
    for count in rng.integers(0, 11, 50):
        more = rng.standard_normal((2, count))
        past.add(list(more))
        all_of_it = np.hstack([all_of_it, more])
        assert np.array_equal(past.values, all_of_it[:, -10:])
    past.values[0] = 7.0  # what is kept can be changed
    assert np.array_equal(past.values, [np.full(10, 7.0), all_of_it[1, -10:]])
