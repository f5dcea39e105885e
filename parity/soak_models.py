"""Compares many random models: `python parity/soak_models.py [SEED] [COUNT]`.

Seeds start at SEED · 1,000,000. Each model that differs is reduced, printed, and stored in parity/differences.
"""

import sys

from random_models.search import FOLDER, search

APART = 1_000_000


def main(seed=1, count=20_000):
    shown = lambda result: print(f"seed {result.seed}: {result.difference}", flush=True)
    findings = search(range(seed * APART, seed * APART + count), report=shown)
    print(findings)
    if findings.differences:
        sys.exit(f"the models that differ are in {FOLDER}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
