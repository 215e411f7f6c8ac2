"""Plots errors of trajectories over their frames, as SVG that can be read on a light and on a dark page. Needs python3-matplotlib."""
import io
import re

import matplotlib

matplotlib.use("SVG")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib import ticker  # noqa: E402

INK = "#768390"  # half way between black and white: the pages behind are either
COLORS = ["#2f81f7", "#d9730d", "#2da44e", "#a371f7"]
COLUMNS = 3
MUCH = 5  # from the median of one line to that of another: the scale is logarithmic then

STYLE = {
    "svg.fonttype": "none",  # letters instead of outlines: smaller, and one can search them
    "svg.hashsalt": "hermite",  # the same numbers give the same file
    "font.family": "sans-serif",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.alpha": 0.25,
    "lines.linewidth": 1.3,
    **{key: INK for key in ("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color", "grid.color")},
}


def rms(values):
    return (sum(value * value for value in values) / len(values))**0.5


def write_svg(figure, path):
    text = io.StringIO()
    figure.savefig(text, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    with open(path, "w", encoding="utf-8") as file:
        file.write(re.sub(r"(\.\d\d)\d+", r"\1", text.getvalue()))  # a hundredth of a point is enough


def draw_panel(axes, name, lines, colors):
    axes.set_title(name, loc="left")
    axes.grid(True, which="major")
    axes.tick_params(which="minor", length=0)
    for at, (kind, errors_mm) in enumerate(lines.items()):
        axes.plot(range(len(errors_mm)), errors_mm, color=colors[kind])
        axes.text(1, 1.05 + 0.1 * (len(lines) - 1 - at), f"RMSE {rms(errors_mm):.1f} mm", color=colors[kind], transform=axes.transAxes,
                  ha="right", va="bottom")


def legend_of(axes, colors):
    axes.set_axis_off()
    axes.legend(handles=[plt.Line2D([], [], color=color, label=kind) for kind, color in colors.items()], loc="center left", frameon=False,
                fontsize=10, labelcolor="linecolor")


def plot_errors(path, title, panels):
    """Writes one panel for each name in `panels`: {panel: {line: [error in metres, one a frame]}}. All panels share their axes and lines."""
    panels = {name: {kind: [1000 * error for error in errors_m] for kind, errors_m in lines.items()} for name, lines in panels.items()}
    kinds = list(dict.fromkeys(kind for lines in panels.values() for kind in lines))
    colors = dict(zip(kinds, COLORS))
    middles = [sorted(errors_mm)[len(errors_mm) // 2] for lines in panels.values() for errors_mm in lines.values()]
    rows = len(panels) // COLUMNS + 1  # the last place is the legend's
    with plt.rc_context(STYLE):
        figure, grid = plt.subplots(rows, COLUMNS, figsize=(9, 2.5 * rows + 0.4), sharex=True, sharey=True, squeeze=False,
                                    layout="constrained")
        figure.suptitle(title, x=0.01, ha="left", fontsize=11)
        for axes, (name, lines) in zip(grid.flat, panels.items()):
            draw_panel(axes, name, lines, colors)
        for axes in grid.flat[len(panels):]:
            axes.set_axis_off()
        legend_of(grid.flat[-1], colors)
        if max(middles) > MUCH * min(middles):
            grid[0, 0].set_yscale("log")
            grid[0, 0].yaxis.set(major_locator=ticker.LogLocator(subs=(1, 3)), major_formatter=ticker.FormatStrFormatter("%g"),
                                 minor_formatter=ticker.NullFormatter())
        else:
            grid[0, 0].set_ylim(bottom=0)
        for axes in grid[:, 0]:
            axes.set_ylabel("error [mm]")
        for at, axes in enumerate(grid.flat):
            if at < len(panels) <= at + COLUMNS:
                axes.set_xlabel("frame")
                axes.tick_params(labelbottom=True)
        write_svg(figure, path)
        plt.close(figure)
