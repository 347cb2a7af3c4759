"""
Send a result
=============

A run as one page, ``report.html``, for a colleague without Python: it opens offline, in any
browser.
"""

import matplotlib.pyplot as plt

import owtsweep

run = owtsweep.run(
    [
        "grid.natural_period=[3,4,5,6]",
        "grid.amplitude=[0.1,0.2,0.5,1]",
        "grid.replicates=8",
        "record.duration=200",
        "name=to_send",
    ]
)
page = run.write_report()
print(page, f"{page.stat().st_size / 1e6:.1f} MB")

# %%
# The pictures of the run can be sent alone, too, as PNG and SVG.
picture = run.draw("figure_18_best_scheme")[0]
figure, axes = plt.subplots(figsize=(8, 6), layout="constrained")
axes.imshow(plt.imread(picture))
axes.axis("off")
plt.show()
