"""Figure 16 of Ren et al. (2019): MSE over amplitude at a natural period of 6 s.

    python -m experiments.ren2019.figure_16 [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

from experiments.ren2019.mse_over_amplitude import draw_mse

draw_mse(6.0)
