"""Arrays for kernels begin where a cache line does."""

from __future__ import annotations

import pytest

from owtsweep.arrays import LINE, aligned, make_rows


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
