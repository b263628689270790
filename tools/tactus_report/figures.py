"""Line figures as SVG text that takes its colours from the page, light or dark."""

import dataclasses
import html
import io
import re

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

# Matplotlib wants colours as numbers; these stand for the page's and are replaced in the SVG.
INK, GRID, RED, GREEN, BLUE, ORANGE, PURPLE, TEAL, PINK, OLIVE = (
    f"#0000{number:02x}" for number in range(1, 11))
PAGE_COLOURS = {INK: "currentColor", GRID: "var(--grid,#ccc)", RED: "var(--red,#c8352b)",
                GREEN: "var(--green,#157f43)", BLUE: "var(--blue,#2563c9)",
                ORANGE: "var(--orange,#c96a00)", PURPLE: "var(--purple,#7d3fc0)",
                TEAL: "var(--teal,#0f7f8c)", PINK: "var(--pink,#b0307e)",
                OLIVE: "var(--olive,#6b6b1e)"}
# For series that have no colour of their own.
COLOURS = (BLUE, RED, GREEN, ORANGE, PURPLE, TEAL, PINK, OLIVE)

STYLE = {
    "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 10,
    "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": INK,
    "xtick.color": INK, "ytick.color": INK, "axes.linewidth": 0.7,
    "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.6,
    "path.simplify_threshold": 0.05,
}
WIDTH_IN, PLOT_HEIGHT_IN, MARGIN_IN = 7.6, 2.48, (0.12, 0.5)  # margins: top, bottom
LABEL_GAP_IN = 0.19
POINTS_PER_CURVE = 1600


@dataclasses.dataclass
class Curve:
    label: str
    colour: str
    line: object  # matplotlib line style: tells curves apart without colour
    time_s: np.ndarray
    value: np.ndarray


def line_figure(name, curves, y_label, unit, log_axis=False, label_peak=False):
    """Curves over time, each labelled at its end with its last or its largest value."""
    with matplotlib.rc_context():
        figure, axes = new_figure(max(PLOT_HEIGHT_IN, LABEL_GAP_IN * len(curves)))
        for curve in curves:
            axes.plot(*thinned(curve.time_s, curve.value), color=curve.colour, linewidth=1.6,
                      linestyle=curve.line)
        if log_axis:
            use_log_axis(axes)
        else:
            axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        axes.set_xlabel("time in s")
        axes.set_ylabel(y_label)
        axes.set_xlim(0.0, max(curve.time_s[-1] for curve in curves))
        label_ends(axes, [(curve.time_s[-1], curve.value[-1],
                           label_text(curve, unit, label_peak), curve.colour)
                          for curve in curves])
        return as_svg(figure, name)


def scatter_figure(name, points, x_label, y_label):
    """Points (x, y, label) on a logarithmic y axis, each named beside the axes."""
    with matplotlib.rc_context():
        figure, axes = new_figure(max(PLOT_HEIGHT_IN, LABEL_GAP_IN * len(points)))
        use_log_axis(axes)
        axes.set_xlabel(x_label)
        axes.set_ylabel(y_label)
        for x, y, _ in points:
            axes.plot([x], [y], "o", color=BLUE, markersize=5, clip_on=False)
        axes.set_xlim(0.0, 1.1 * max((x for x, _, _ in points), default=1.0))
        label_ends(axes, [(x, y, label, INK) for x, y, label in points])
        return as_svg(figure, name)


def new_figure(plot_height_in=PLOT_HEIGHT_IN):
    matplotlib.rcdefaults()  # whatever matplotlibrc this machine has
    matplotlib.rcParams.update(STYLE)
    height_in = plot_height_in + sum(MARGIN_IN)
    figure = Figure(figsize=(WIDTH_IN, height_in))
    axes = figure.add_axes((0.085, MARGIN_IN[1] / height_in, 0.63, plot_height_in / height_in))
    return figure, axes


def use_log_axis(axes):
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_locator(NullLocator())


def thinned(x, y):
    """Fewer points for the same picture: the extremes of each slice stay."""
    slice_length = 2 * len(x) // POINTS_PER_CURVE
    if slice_length < 4:
        return x, y
    keep = {0, len(x) - 1}
    for start in range(0, len(x), slice_length):
        part = y[start:start + slice_length]
        keep |= {start + int(part.argmin()), start + int(part.argmax())}
    indices = sorted(keep)
    return x[indices], y[indices]


def label_ends(axes, labels):
    """Texts (x, y, text, colour) right of the axes at the height of their points, apart enough to
    be read, with a thin line to the point."""
    gap = LABEL_GAP_IN / (axes.get_position().height * axes.figure.get_figheight())
    to_axes = axes.transData + axes.transAxes.inverted()
    placed = [(*to_axes.transform((x, y)), text, colour) for x, y, text, colour in labels]
    placed.sort(key=lambda item: item[1])
    for (x, y, text, colour), height in zip(placed, spread([item[1] for item in placed], gap)):
        axes.plot([x, 1.015, 1.035], [y, height, height], transform=axes.transAxes, clip_on=False,
                  color=colour, linewidth=0.6, alpha=0.7)
        axes.text(1.045, height, text, transform=axes.transAxes, color=colour, va="center",
                  fontsize=9.5, parse_math=False)


def spread(heights, gap):
    """The sorted heights, moved as little as it takes to be `gap` apart, within 0..1 if they fit."""
    groups = []  # [sum of the members' wishes, number of members], merged while they overlap
    for height in heights:
        groups.append([height, 1])
        while len(groups) > 1 and lowest(groups[-2], gap) + gap * groups[-2][1] > lowest(
                groups[-1], gap):
            total, count = groups.pop()
            groups[-1][0] += total
            groups[-1][1] += count
    return [lowest(group, gap) + gap * place for group in groups for place in range(group[1])]


def lowest(group, gap):
    """Lowest height of labels that are centred on the mean of their points."""
    total, count = group
    height = total / count - gap * (count - 1) / 2
    return max(0.0, min(height, 1.0 - gap * (count - 1)))


def label_text(curve, unit, label_peak):
    value = curve.value.max() if label_peak else curve.value[-1]
    return f"{curve.label}, {'peak ' if label_peak else ''}{rounded(value)} {unit}".rstrip()


def rounded(value):
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:#.3g}" if abs(value) >= 1e-3 else "0"


def as_svg(figure, name):
    """One <svg> element, the same to the byte for the same data."""
    matplotlib.rcParams["svg.hashsalt"] = name
    text = io.StringIO()
    figure.savefig(text, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    svg = text.getvalue()
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", svg, count=1)
    svg = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", svg, count=1)
    # Ids must be unique in the page.
    svg = re.sub(r'\bid="', f'id="{name}-', svg)
    svg = re.sub(r'(url\(#|href="#)', rf"\1{name}-", svg)
    for colour, page_colour in PAGE_COLOURS.items():
        svg = svg.replace(colour, page_colour)
    return svg


def as_figure(name, drawing, title, what_to_see):
    drawing = drawing.replace(
        "<svg", f'<svg role="img" aria-labelledby="{name}-title {name}-text"', 1)
    return (f'<figure id="{name}">\n{drawing}\n<figcaption><b id="{name}-title">'
            f'{html.escape(title)}</b> <span id="{name}-text">{html.escape(what_to_see)}</span>'
            "</figcaption>\n</figure>")
