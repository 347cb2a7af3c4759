"""Figure 18 of Ren et al. (2019): the best scheme over natural period and amplitude.

    python -m experiments.ren2019.figure_18 [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

from experiments.drawing import draw_figure

draw_figure("figure_18_best_scheme")
