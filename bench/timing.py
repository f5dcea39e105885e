"""Runs engines alternately and reports their times."""

import os
import statistics


def alternate(engines, repeat):
    """Returns the seconds of `repeat` runs of each engine; engines alternate, so that all see the same machine."""
    seconds = {name: [] for name in engines}
    for engine in engines.values():
        engine.run()  # warm-up, not counted
    for _ in range(repeat):
        for name, engine in engines.items():
            seconds[name].append(engine.run())
    return seconds


def ratio(slow, fast):
    """Returns the speedup of the second over the first: the median over repetitions, paired by time."""
    return statistics.median(s / f for s, f in zip(slow, fast, strict=True))


HEADING = f"  {'engine':<23}{'µs/step':>9}{'best':>9}{'ratio':>8}{'contacts':>10}{'iterations':>12}"


def table(engines, seconds, baseline, steps):
    """Prints a line per engine and returns them as rows; `steps` counts those of all environments."""
    print(HEADING)
    rows = []
    for name, engine in engines.items():
        micro = [1e6 * s / steps for s in seconds[name]]
        row = {"engine": name, "microseconds": statistics.median(micro), "best": min(micro), "seconds": seconds[name]}
        row |= {"ratio": ratio(seconds[baseline], seconds[name])}
        row |= {"contacts_mean": engine.contacts, "iterations_mean": engine.iterations}
        rows.append(row)
        print(
            f"  {name:<23}{row['microseconds']:>9.2f}{row['best']:>9.2f}{row['ratio']:>8.2f}"
            f"{engine.contacts:>10.2f}{engine.iterations:>12.2f}",
            flush=True,
        )
    return rows


def processors():
    """Returns the number of processors available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
