"""Arrays for kernels begin where a cache line does."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.arrays import LINE, aligned
from owtsweep.studies.hub.kernels.layout import new_output, new_registers, new_scratch


@pytest.mark.parametrize("shape", [(1, 8), (7, 8), (3, 11, 8), (5,)])
def test_aligned_arrays_are_zero_and_plain(shape):
    for _ in range(5):  # an allocator gives good addresses by chance
        array = aligned(*shape)
        assert array.shape == shape
        assert array.flags.c_contiguous
        assert array.flags.writeable
        assert not array.any()
        assert array.ctypes.data % LINE == 0


def test_what_kernels_read_and_write_at_each_step_is_aligned():
    memory = (new_registers(2, 19, 20), new_scratch(2, 500, 19), new_output(2, 500))
    for group in (array for part in memory for field in part for array in field):
        assert group.ctypes.data % LINE == 0
        assert group.strides == (8 * np.dtype(float).itemsize, 8)
