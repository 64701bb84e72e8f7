"""Time against vertices, from the tables of RESULTS.md.

    plot.py RESULTS.md surfaces.png
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as pyplot  # noqa: E402

MARKS = ("<!-- surfaces: begin -->", "<!-- surfaces: end -->")
TITLES = {
    "disjoint_balls": "Eight disjoint balls",
    "overlapping_spheres": "Overlapping spheres, with curves",
    "grains": "30 grains, with curves",
    "brain_atlas_mni_prob": "Brain atlas",
    "soft_brain_ants19_prob": "Soft brain",
}
# Column of the table, name, colour, marker.
LINES = (
    ("Mesh_3 s", "Mesh_3", "#b2182b", "s"),
    ("P1 s", "Mesh_3, Parallel_tag, one core", "#ef8a62", "^"),
    ("ours s", "ours, with certificate", "#2166ac", "o"),
    ("refinement s", "ours, refinement alone", "#67a9cf", "v"),
    ("bulk s", "bulk insertion of our points", "#777777", "D"),
)


def read_table(text, heading):
    """Rows, as dictionaries, of the first table below a heading."""
    lines = iter(text.split(heading, 1)[1].splitlines())
    rows = []
    names = None
    for line in lines:
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|"):
            if names:
                break
        elif names is None:
            names = cells
        elif not set(line) <= set("|-: "):
            rows.append(dict(zip(names, cells)))
    return rows


def read_number(text):
    """A cell's number; None: a dash."""
    try:
        return float(text)
    except ValueError:
        return None


def draw_scene(axes, scene, rows):
    """One line for each column."""
    for column, name, color, marker in LINES:
        pairs = [(read_number(row["vertices"]), read_number(row[column])) for row in rows]
        pairs = [(x, y) for x, y in pairs if x and y]
        x = [pair[0] for pair in pairs]
        y = [pair[1] for pair in pairs]
        axes.loglog(x, y, color=color, marker=marker, markersize=4, linewidth=1.3, label=name)
    axes.set_title(TITLES.get(scene, scene), fontsize=10)
    axes.set_xlabel("vertices", fontsize=9)
    axes.set_ylabel("seconds of the processor", fontsize=9)
    axes.grid(True, which="major", color="#cccccc", linewidth=0.6)
    axes.grid(True, which="minor", color="#eeeeee", linewidth=0.4)
    axes.tick_params(which="both", labelsize=8)


def main():
    """Draws the rows of the file's section on surfaces."""
    source, target = sys.argv[1:]
    with open(source, encoding="utf-8") as file:
        text = file.read().split(MARKS[0], 1)[1].split(MARKS[1], 1)[0]
    rows = read_table(text, "Seconds for the same number of vertices:")
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    # One place is the legend's.
    across = min(len(scenes) + 1, 3)
    down = len(scenes) // across + 1
    figure, grid = pyplot.subplots(down, across, figsize=(3.7 * across, 3.3 * down), squeeze=False)
    for axes in grid.flat[len(scenes):]:
        axes.axis("off")
    for axes, scene in zip(grid.flat, scenes):
        draw_scene(axes, scene, [row for row in rows if row["scene"] == scene])
    handles, names = grid.flat[0].get_legend_handles_labels()
    grid.flat[-1].legend(handles, names, loc="center", fontsize=9)
    figure.tight_layout()
    figure.savefig(target, dpi=110, metadata={"Software": None})


if __name__ == "__main__":
    main()
