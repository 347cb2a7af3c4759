"""Figure 14 of Ren et al. (2019): accelerometer bias estimates at 3.8 s.

    python -m experiments.ren2019.figure_14 [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

from experiments.drawing import draw_figure

draw_figure("figure_14_bias")
