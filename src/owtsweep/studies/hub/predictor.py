"""The predictor of HME1 and HME2 as the numbers that the batch engine's kernels take."""

from __future__ import annotations

from dataclasses import replace

from owtsweep.estimation.discretisation import Discrete
from owtsweep.estimation.predictor import powers
from owtsweep.studies.hub.kernels.layout import LeanTerms, PredictorArrays


def predictor_arrays(model: Discrete | None, steps: int, step: float) -> PredictorArrays:
    """Make the numbers by which the kernels predict over `steps` steps of `step` seconds.

    `model` is the predictor's model over one step, with the states position, velocity and bias, or
    None without a predictor. Its input is held over a step or linear (`model.B_next`).
    """
    if model is None or steps == 0:
        return PredictorArrays(0, step, 0.0, 0.0, 0.0, 0.0, 0.0)
    A = powers(model.A, steps)[steps]
    if model.B_next is not None:
        # x[k+1] - N u[k+1] = A (x[k] - N u[k]) + (B + A N) u[k], where N is B_next: a model of
        # x - N u whose input is held
        first, new = (A @ model.B_next)[:, 0], model.B_next[:, 0]
        held = replace(model, B=model.B + model.A @ model.B_next, B_next=None)
        return predictor_arrays(held, steps, step)._replace(
            linear=True,
            new_p=float(new[0]),
            new_v=float(new[1]),
            first_p=float(first[0]),
            first_v=float(first[1]),
        )
    half = float(model.B[0, 0])
    arrays = PredictorArrays(
        steps=steps, step=step, half=half, pv=A[0, 1], pb=A[0, 2], vb=A[1, 2],
        old_p=half + steps * step * step,
    )  # fmt: skip
    if model.A[1, 0] == 0.0:
        return arrays
    left = A @ model.B[:, 0]
    one = model.A
    return arrays._replace(
        old_p=left[0],
        old_v=left[1] - step,
        pp=A[0, 0] - 1.0,
        vp=A[1, 0],
        vv=A[1, 1] - 1.0,
        lean=LeanTerms(
            pp=one[0, 0] - 1.0,
            pv=one[0, 1] - step,
            pu=0.0,  # `half` has it
            vp=one[1, 0],
            vv=one[1, 1] - 1.0,
            vu=float(model.B[1, 0]) - step,
        ),
    )
