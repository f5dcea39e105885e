"""Writes docs/families.md and its plots from the figures of families.py, and the plot of public_models.py."""

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt

plt.rcParams |= {"svg.hashsalt": "clench", "font.size": 8, "axes.spines.top": False, "axes.spines.right": False}

COLORS = {"mujoco": "#888888", "clench": "#c04020", "clench f64": "#c04020", "clench f32": "#e0a030"}
FIELDS = [("contacts_mean", ".0f"), ("iterations_mean", ".1f")]
THREADED = "clench, all threads"  # one environment whose steps use all threads
SMALL = 0.03  # fraction of a step: stages that never take more are drawn as one


PAGE = """# Scenes of manipulation and of many bodies

For users whose scenes have arms, heaps or crowds: how fast Clench is compared with MuJoCo {mujoco}, on {machine}.
`cargo xtask bench --only families --docs` writes this page; `bench/families.py` describes the method.

One environment: microseconds a step, MuJoCo's time over Clench's on one thread, Clench's time on one thread over that on all ({processors}), and mean
contacts and solver iterations a step (MuJoCo's and Clench's).

{alone}

Environments in a batch, one thread: MuJoCo's time (its own batch) over Clench's.

{many}

A ratio is missing if MuJoCo takes too long.

![Where a step of one environment spends its time](families-stages.svg)

![Time a step by bodies, contacts, environments and threads](families-growth.svg)
"""


def draw(record, folder):
    """Writes families.md, families-stages.svg and families-growth.svg."""
    scenes = list(dict.fromkeys(row["scene"] for row in record["rows"] if row["family"] != "environments"))
    machine = "{processors} processors ({machine})".format(**record["machine"])
    parts = {"machine": machine, "processors": record["machine"]["processors"], "mujoco": record["machine"]["mujoco"], "alone": alone(record["rows"], scenes), "many": many(record["rows"], scenes)}
    (folder / "families.md").write_text(PAGE.format(**parts))
    stages(record["stages"], folder / "families-stages.svg")
    growth(record["rows"], folder / "families-growth.svg")


def alone(rows, scenes):
    """Returns the table of one environment, a line per scene."""
    lines = ["| scene | dofs | MuJoCo µs | Clench µs | ratio | threads | contacts | iterations |", "| --- " * 8 + "|"]
    for scene in scenes:
        found = {row["engine"]: row for row in rows if row["scene"] == scene and row["envs"] == 1 and row["family"] != "environments"}
        theirs, ours = found.get("mujoco"), found["clench"]
        micro = f"{theirs['microseconds']:.1f}" if theirs else ""
        ratio = f"{ours['ratio']:.2f}" if theirs else ""
        both = lambda name, form: " / ".join(format(row[name], form) for row in (theirs, ours) if row)
        shared = found.get(THREADED)
        faster = f"{ours['microseconds'] / shared['microseconds']:.2f}" if shared else ""
        numbers = [f"{ours['microseconds']:.1f}", ratio, faster, *(both(*field) for field in FIELDS)]
        lines.append(f"| {scene} | {ours['nv']} | {micro} | " + " | ".join(numbers) + " |")
    return "\n".join(lines)


def many(rows, scenes):
    """Returns the table of batches, a line per scene."""
    columns = [(envs, engine) for envs in (64, 256) for engine in ("clench f64", "clench f32")]
    heads = [f"{envs}, {engine.removeprefix('clench ')}" for envs, engine in columns]
    lines = ["| scene | " + " | ".join(heads) + " |", "| --- " * (1 + len(heads)) + "|"]
    for scene in scenes:
        of_scene = [row for row in rows if row["scene"] == scene and row["family"] != "environments"]
        found = {(row["envs"], row["engine"]): f"{row['ratio']:.2f}" for row in of_scene if row["ratio"]}
        if any(column in found for column in columns):
            lines.append(f"| {scene} | " + " | ".join(found.get(column, "") for column in columns) + " |")
    return "\n".join(lines)


def stages(profiles, path):
    """Draws the share of each stage in a step of one environment, a bar per scene."""
    share = {scene: {stage: time / sum(profile.values()) for stage, time in profile.items()} for scene, profile in profiles.items()}
    names = list(dict.fromkeys(stage for profile in share.values() for stage in profile))
    drawn = [name for name in names if max(profile.get(name, 0) for profile in share.values()) >= SMALL]
    figure, axes = plt.subplots(figsize=(8, 0.3 * len(share) + 1.5))
    scenes = list(share)[::-1]
    left = [0.0] * len(scenes)
    colors = plt.get_cmap("tab20").colors
    for color, name in enumerate(drawn):
        widths = [100 * share[scene].get(name, 0) for scene in scenes]
        axes.barh(scenes, widths, left=left, label=name, color=colors[color % len(colors)])
        left = [a + b for a, b in zip(left, widths, strict=True)]
    axes.barh(scenes, [100 - x for x in left], left=left, label="the rest", color="#dddddd")
    axes.set_xlabel("% of a step of one environment")
    axes.set_xlim(0, 100)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    save(figure, path)


def growth(rows, path):
    """Draws the time of a step by bodies, by contacts, by environments and by threads."""
    figure, axes = plt.subplots(2, 2, figsize=(8, 6))
    single = [row for row in rows if row["envs"] == 1 and row["family"] == "large"]
    piles = [row for row in single if row["scene"].startswith("pile")]
    for engine in ("mujoco", "clench"):
        line(axes[0, 0], [row for row in piles if row["engine"] == engine], lambda row: row["nv"] / 6, engine)
        dots = [row for row in single if row["engine"] == engine and row["contacts_mean"] > 0]
        axes[0, 1].plot(*points(dots, lambda row: row["contacts_mean"]), "o", color=COLORS[engine], label=engine, markersize=4)
    copies = [row for row in rows if row["family"] == "environments"]
    one = [row for row in copies if row["threads"] == 1]
    for engine in ("mujoco", "clench f64", "clench f32"):
        line(axes[1, 0], [row for row in one if row["engine"] == engine], lambda row: row["envs"], engine)
    max_envs = max((row["envs"] for row in copies), default=0)
    for engine in ("clench f64", "clench f32"):
        line(axes[1, 1], [row for row in copies if row["engine"] == engine and row["envs"] == max_envs], lambda row: row["threads"], engine)
    titles = ["bodies of a pile", "contacts of large scenes", "environments of an arm and a box", f"threads, {max_envs} environments of it"]
    for axis, title in zip(axes.flat, titles, strict=True):
        axis.set_xlabel(title)
        axis.set_ylabel("µs a step")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.legend(frameon=False)
    save(figure, path)


def public(rows, columns, path):
    """Draws MuJoCo's time over Clench's by the time of a step, a dot a model, coloured by package; a plot a column."""
    figure, axes = plt.subplots(1, len(columns), figsize=(8, 3), sharey=True)
    packages = sorted({row["model"].split("/")[0] for row in rows})
    for axis, (column, title) in zip(axes, columns.items(), strict=True):
        for package in packages:
            of_package = [row for row in rows if row["model"].startswith(f"{package}/")]
            axis.plot([row[f"{column}_microseconds"] for row in of_package], [row[column] for row in of_package], "o", markersize=3, label=package)
        axis.axhline(1, color="#888888", linewidth=0.8)
        axis.set_title(title)
        axis.set_xlabel("µs a step of Clench")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.yaxis.set_major_formatter("{x:g}")
    axes[0].set_ylabel("MuJoCo's time over Clench's")
    axes[-1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    save(figure, path)


def line(axis, rows, across, engine):
    axis.plot(*points(rows, across), "o-", color=COLORS[engine], label=engine, markersize=4)


def points(rows, across):
    ordered = sorted((across(row), row["microseconds"]) for row in rows)
    return [x for x, _ in ordered], [y for _, y in ordered]


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
