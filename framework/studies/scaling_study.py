"""What `kerf scale` runs: one input on several numbers of ranks, several times, each run in a folder of its own.

ranks_N/repeat_R             a timed run
ranks_N/counted              a run whose messages are counted; its times mean nothing
side_by_side_N/repeat_R_copy_C   one of N serial runs at the same time
study.json                   what was asked for, for a later --collect
"""

from __future__ import annotations

import hashlib
import json
import os
import shlex
from dataclasses import dataclass, field
from pathlib import Path

from marked_yaml import Hindered, StudyError
from model_input import ModelInput, PathError, split_path
from point_folder import PointFolder, hash_of_file, read_json, write_whole
from quantities import components, scaled, value_of, vector_text, with_unit
from study import Point, cells_of_meshes

TIMED, COUNTED, SIDE = "timed", "counted", "side_by_side"
LIBRARY = "libkerf_message_counts.so"


@dataclass
class ScalingStudy:
    input: ModelInput
    ranks: list[int]
    repeats: int
    settings: dict[str, str]
    weak: list[str]  # paths of the input that grow or shrink with the ranks; none for strong scaling
    plugins: list[str]
    counts: bool
    side_by_side: bool
    launch: str  # the command that starts ranks, with @RANKS@; empty for mpirun on this machine
    program_hash: str
    library: str
    slurm_template: Path | None = None
    by_ranks: dict[int, dict[str, str]] = field(default_factory=dict)  # the settings of each number of ranks

    def __post_init__(self) -> None:
        self.by_ranks = {n: {**self.settings, **self._grown(n)} for n in self.ranks}
        seen = {}
        for n, settings in self.by_ranks.items():
            same = seen.setdefault(tuple(sorted(settings.items())), n)
            if self.weak and same != n:
                raise StudyError(f"--weak: error: the mesh of {n} ranks is that of {same} ranks, for its numbers of "
                                 "cells are too small to grow; expected a finer mesh or more distant numbers of ranks")

    @property
    def base(self) -> int:
        return self.ranks[0]

    # ---- weak scaling

    def weak_paths(self) -> list[str]:
        paths = []
        for path in self.weak:
            if path == "mesh":
                found = [name for names in cells_of_meshes(self.input) for name in names]
                if not found:
                    raise StudyError(f"{self.input.file}:1:1: error: --weak mesh finds no numbers or sizes of cells in "
                                     "the meshes of the input; expected the path of a key")
                paths += found
            else:
                paths.append(path)
        return list(dict.fromkeys(paths))

    def _grown(self, ranks: int) -> dict[str, str]:
        """Numbers of cells grow, and sizes of cells shrink, by the cube root of the ranks."""
        factor = (ranks / self.ranks[0]) ** (1.0 / 3.0)
        made: dict[str, str] = {}
        for path in self.weak_paths():
            try:
                # A named value may stand behind several keys; it changes once.
                target, text = self.input.text_at(split_path(path), self.settings)
            except PathError as error:
                raise StudyError(f"--weak: error: {error}") from error
            last = path.rsplit(".", 1)[-1]
            if not (last in ("cells", "cell_size") or last.endswith("_cells") or path.startswith("parameters.")):
                raise StudyError(f"--weak: error: {path} makes no cells; expected `mesh`, the path of a key `cells`, "
                                 "`cell_size` or `..._cells`, or a value under `parameters`")
            whole = last == "cells" or last.endswith("_cells")
            grown = grown_counts(text, factor, target) if whole else scaled(text, 1.0 / factor, False)
            if grown is None:
                raise StudyError(f"--weak: error: {path} is {text}; expected a number of cells or a length")
            made[target] = grown
        return made

    # ---- the runs

    def of_ranks(self, output: Path, n: int) -> list[ScaleFolder]:
        """The timed runs on n ranks, and the counted one."""
        runs = [ScaleFolder(self, output, TIMED, n, repeat) for repeat in range(1, self.repeats + 1)]
        return runs + ([ScaleFolder(self, output, COUNTED, n, 1)] if self.counts else [])

    def groups(self, output: Path) -> list[list[ScaleFolder]]:
        """All runs in their order. Those of one group run at the same time; all but serial runs are alone."""
        timed = [[ScaleFolder(self, output, TIMED, n, repeat)] for repeat in range(1, self.repeats + 1)
                 for n in self.ranks]
        side = [[ScaleFolder(self, output, SIDE, n, repeat, copy) for copy in range(1, n + 1)]
                for repeat in range(1, self.repeats + 1) for n in self.ranks if self.side_by_side and n > 1]
        counted = [[ScaleFolder(self, output, COUNTED, n, 1)] for n in self.ranks if self.counts]
        return timed + side + counted

    # ---- study.json

    def save(self, output: Path) -> None:
        facts = {"input": str(self.input.file), "ranks": self.ranks, "repeats": self.repeats,
                 "settings": self.settings, "weak": self.weak, "plugins": self.plugins, "counts": self.counts,
                 "side_by_side": self.side_by_side, "launch": self.launch, "program_hash": self.program_hash,
                 "library": self.library}
        write_whole(output / "study.json", json.dumps(facts, indent=1, ensure_ascii=False) + "\n")


def read_study_of(output: Path) -> ScalingStudy:
    facts = read_json(output / "study.json")
    if facts is None:
        raise Hindered(f"{output / 'study.json'}: error: the file is not there or is broken; expected the folder of an "
                       "earlier kerf scale")
    try:
        return ScalingStudy(**{**facts, "input": ModelInput(Path(facts["input"]))})
    except (TypeError, KeyError) as error:
        raise Hindered(f"{output / 'study.json'}: error: it is not of kerf scale, or of another version; expected the "
                       "folder of an earlier kerf scale") from error


def grown_counts(text: str, factor: float, path: str) -> str | None:
    """Numbers of cells times a factor, each rounded to a whole one; elements are counted later, so that rounding does
    not pass for efficiency. None for what is no number."""
    parts = components(text)
    values = [value_of(part) for part in parts or [text]]
    if any(value.number is None for value in values):
        return None
    made = [with_unit(max(1, round(value.number * factor)), value.unit).text for value in values]
    return vector_text(made, path.startswith("parameters.")) if parts else made[0]


class RanksOfStudy:
    """The study as seen by one number of ranks: what point_folder and slurm ask of a study."""

    def __init__(self, study: ScalingStudy, ranks: int):
        self.file = study.input.file
        self.input, self.plugins, self.ranks = study.input, study.plugins, ranks
        self.slurm_template = study.slurm_template or Path(__file__).with_name("scaling_slurm.sh")
        self.slurm_launch = study.launch or "srun --ntasks=@RANKS@"


class ScaleFolder(PointFolder):
    """The folder of one run."""

    program = "kerf scale"
    may_resume = False  # the times of a resumed run are those of its last part

    def __init__(self, study: ScalingStudy, output: Path, kind: str, ranks: int, repeat: int, copy: int = 0):
        self.whole, self.kind, self.group, self.repeat, self.copy = study, kind, ranks, repeat, copy
        own = study.base if kind == SIDE and study.weak else ranks
        settings = dict(study.by_ranks[own])
        # A restart file at the end serves nobody here.
        settings.setdefault("output.restart_at_end", "false")
        self.ranks = 1 if kind == SIDE else ranks
        super().__init__(RanksOfStudy(study, self.ranks), Point({}, settings), output)
        self.name = {TIMED: f"ranks_{ranks}/repeat_{repeat}", COUNTED: f"ranks_{ranks}/counted",
                     SIDE: f"side_by_side_{ranks}/repeat_{repeat}_copy_{copy}"}[kind]
        self.path = output / self.name

    @property
    def counts_path(self) -> Path:
        return self.path / "message_counts"

    def digest(self) -> str:
        """Of all that decides the result and its times."""
        more = [self.kind, self.ranks, self.group, self.whole.launch, self.whole.program_hash]
        return hashlib.sha256((super().digest() + json.dumps(more)).encode()).hexdigest()

    def prepare(self, afresh: bool) -> None:
        super().prepare(afresh)
        for file in self.path.glob("message_counts.*.json"):
            file.unlink()

    def command(self, binary: Path, ranks: int) -> list[str]:
        """For this machine; with `ranks` 1 without a launcher, as Slurm's scripts need it, which have their own."""
        words = super().command(binary, 1)
        if self.kind == COUNTED:
            words = ["env", f"LD_PRELOAD={self.whole.library}", f"KERF_MESSAGE_COUNTS={self.counts_path}", *words]
        return words if ranks == 1 else [*self.launcher(), *words]

    def launcher(self) -> list[str]:
        if self.ranks == 1:
            return []
        if self.whole.launch:
            return shlex.split(self.whole.launch.replace("@RANKS@", str(self.ranks)))
        words = ["mpirun", "-n", str(self.ranks), "--oversubscribe", "--bind-to", "none", "--quiet"]
        if os.geteuid() == 0:
            words.append("--allow-run-as-root")
        # Ranks that share a core must yield it while they wait.
        if self.ranks > len(os.sched_getaffinity(0)):
            words += ["--mca", "mpi_yield_when_idle", "1"]
        return words


def library_of_counts(binary: Path) -> Path:
    for place in (binary.parent.parent / "lib" / LIBRARY, binary.parent.parent / "lib" / "kerf" / LIBRARY):
        if place.is_file():
            return place
    raise Hindered(f"{binary.parent.parent / 'lib' / LIBRARY}: error: the library that counts messages is not there; "
                   "expected it beside the program (ninja kerf_message_counts makes it), or --no-counts")


def hash_of_program(binary: Path) -> str:
    return hash_of_file(binary)
