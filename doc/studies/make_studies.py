#!/usr/bin/env python3
"""Makes a study of doc/studies anew: runs, tables in its Markdown page, figures beside it.

  build/venv/bin/python doc/studies/make_studies.py classical
  build/venv/bin/python doc/studies/make_studies.py erosion

Runs are kept in results/studies and are not repeated while the program is the same. --quick takes small models and
writes into a scratch folder, for tests. Exit code 0: done; 1: a run has failed or states differ; 2: wrong arguments.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import classical  # noqa: E402
import erosion  # noqa: E402
from study_tools import ROOT, StudyError, put_tables  # noqa: E402

PAGES = {"classical": (classical, "classical_speedup.md"), "erosion": (erosion, "erosion_imbalance.md")}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study", choices=sorted(PAGES))
    parser.add_argument("--quick", action="store_true", help="small models, and nothing is written to doc")
    parser.add_argument("--output", type=Path, help="folder of the runs (default: results/studies; with --quick a "
                        "temporary folder, in which page and figures are written, too)")
    args = parser.parse_args()
    study, name = PAGES[args.study]
    runs = args.output or (Path(tempfile.mkdtemp(prefix="kerf_studies_")) if args.quick else ROOT / "results/studies")
    runs = runs.resolve()
    runs.mkdir(parents=True, exist_ok=True)
    pages = HERE
    if args.quick:
        pages = runs / "pages"
        pages.mkdir(exist_ok=True)
        shutil.copy(HERE / name, pages / name)
    try:
        put_tables(pages / name, study.make(runs / args.study, pages, args.quick))
    except StudyError as error:
        print(error, file=sys.stderr)
        return 1
    print(f"written: {pages / name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
