"""Figure 12 of Ren et al. (2019): velocity estimates at 3.8 s, zoomed in.

    python -m experiments.ren2019.figure_12 [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

from experiments.drawing import draw_figure

draw_figure("figure_12_velocity_zoom")
