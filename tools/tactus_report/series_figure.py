"""Figures of measured points, many series in one, told apart by colour and shape together."""

import dataclasses
import math

import matplotlib
from matplotlib.ticker import LogLocator, NullLocator

from .figures import COLOURS, as_svg, new_figure

MARKERS = ("o", "s", "^")  # from one round of colours to the next
PLOT_HEIGHT_IN, LEGEND_STEP_IN = 3.2, 0.175
LEFT = 0.12  # of the figure's width: room for 1e-16 and the label beside it


@dataclasses.dataclass
class Series:
    label: str
    x: list
    y: list  # as many as x


def series_figure(name, series, labels, scales, has_lines):
    """`labels` and `scales` ("linear" or "log") of x and y. What has no place on a logarithmic axis is
    left out."""
    with matplotlib.rc_context():
        figure, axes = new_figure(max(PLOT_HEIGHT_IN, LEGEND_STEP_IN * len(series)))
        box = axes.get_position()
        axes.set_position((LEFT, box.y0, box.x1 - LEFT, box.height))
        shown = [[(x, y) for x, y in zip(entry.x, entry.y) if fits(x, scales[0]) and fits(y, scales[1])]
                 for entry in series]
        for number, (entry, places) in enumerate(zip(series, shown)):
            axes.plot([x for x, _ in places], [y for _, y in places],
                      color=COLOURS[number % len(COLOURS)], label=entry.label,
                      marker=MARKERS[number // len(COLOURS) % len(MARKERS)], markersize=4.5,
                      linewidth=1.4, linestyle="-" if has_lines else "")
        axes.set_xscale(scales[0])
        axes.set_yscale(scales[1])
        for place, (axis, set_limits) in enumerate(((axes.xaxis, axes.set_xlim),
                                                    (axes.yaxis, axes.set_ylim))):
            values = [point[place] for places in shown for point in places]
            if not values:
                set_limits(0.1, 1.0)
            elif scales[place] == "log":
                set_log_ticks(axis, values)
            else:
                set_limits(min(0.0, min(values)), None)
        axes.set_xlabel(labels[0], parse_math=False)
        axes.set_ylabel(labels[1], parse_math=False)
        add_legend(axes)
        return as_svg(figure, name)


def fits(value, scale):
    return math.isfinite(value) and (scale == "linear" or value > 0.0)


def set_log_ticks(axis, values):
    decades = math.log10(max(values) / min(values))
    axis.set_major_locator(LogLocator(subs=(1.0,) if decades > 2.0 else (1.0, 2.0, 5.0)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(NullLocator())


def add_legend(axes):
    legend = axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), frameon=False, fontsize=8.5,
                         labelspacing=0.35, borderaxespad=0.0)
    for text in legend.get_texts():
        text.set_parse_math(False)
