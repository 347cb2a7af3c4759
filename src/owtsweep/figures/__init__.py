"""Draw figures for any study: maps of the best schemes, curves, time histories, terminal maps.

The modules `style` and `palette` define the style. Functions that draw must be called inside `with
style.context():`, as `drawings.save_figure` does.
"""
