"""Every registered material, equation of state, solid and criterion in small impacts of two bodies: the same bits on
one rank, and on three that hand elements to each other, stop half-way, and are resumed by two. The samples are those
of tests/data/sample_laws.yaml."""
import json
import re
import subprocess

import pytest
import yaml
from law_models import KERF, SAMPLES, impacts, laws_of, plugins


def run(folder, name, case, *arguments):
    folder.mkdir(exist_ok=True)
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(case, sort_keys=False))
    process = subprocess.run([KERF, "run", path, "--output", folder / name, *map(str, arguments)], capture_output=True,
                             text=True, timeout=300)
    assert process.returncode == 0, process.stderr + process.stdout
    return json.loads((folder / name / "summary.json").read_text())


def difference(folder, laws):
    """What a run on one rank, and one on three that stops half-way and goes on with two, do not have in common."""
    case = impacts(laws)
    whole = run(folder, "whole", case)
    run(folder, "stopped", case, "--ranks", 3, "--set", "time.maximum_cycles=15")
    resumed = run(folder, "stopped", case, "--ranks", 2, "--resume")
    assert whole["cycles"] == resumed["cycles"] == 30 and re.fullmatch("[0-9a-f]+", whole["state_hash"])
    assert any(balance["elements_moved"] > 0 for balance in resumed["rebalances"])
    return {key: (whole[key], resumed[key]) for key in ("state_hash", "energy", "eroded", "momentum", "parts")
            if whole[key] != resumed[key]}


def test_every_law_has_a_sample():
    for kind, name in laws_of(plugins()):
        assert name in SAMPLES.get(kind, {}), f"{kind} {name} has no sample; give it one in tests/data/sample_laws.yaml"


def test_ranks_migration_and_restart_leave_the_bits_alone(tmp_path):
    """All laws in one model, which is quick; where something differs, one after the other, to name the law."""
    laws = laws_of(plugins())
    if not difference(tmp_path, laws):
        return
    found = {name: difference(tmp_path / name, [(kind, name)]) for kind, name in laws}
    assert not any(found.values()), {name: keys for name, keys in found.items() if keys}
    pytest.fail("the laws differ only together")
