"""Draw why a scheme wins: its error against the motion's frequency, and from noise alone.

    python -m experiments.error_spectra [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

from experiments.drawing import draw_figure

draw_figure("error_spectra")
