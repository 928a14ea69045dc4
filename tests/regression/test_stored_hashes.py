"""Small models end with the stored state hashes, whatever the machine, the compiler and the C library."""

import json
import re

import pytest
import stored_hashes
from law_models import plugins

# Kinds of plugins that change no hash: test_state_hash.py shows it of partitioners, test_observed_bits.py of observers,
# and measures only look.
OTHERS = {"balance_policy", "measure", "observer", "partitioner"}
RENEW = "after a change of physics on purpose: python tests/regression/stored_hashes.py --renew"


@pytest.fixture(scope="module")
def summaries(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stored")
    return {name: stored_hashes.summary_of(name, folder) for name in stored_hashes.MODELS}


@pytest.mark.parametrize("name", stored_hashes.MODELS)
def test_hash_is_as_stored(summaries, name):
    assert summaries[name]["state_hash"] == json.loads(stored_hashes.STORED.read_text())[name], RENEW


@pytest.mark.parametrize("name", ["bar", "perforation"])
def test_hash_does_not_depend_on_the_forms_that_the_c_library_chooses(summaries, tmp_path, name):
    # glibc takes other exp, log, sin where the processor fuses multiplication and addition; here it is told not to.
    plain = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F"}
    assert stored_hashes.summary_of(name, tmp_path, plain)["state_hash"] == summaries[name]["state_hash"]


def test_models_use_every_law():
    names = plugins()
    assert {"eos", "material", "solid"} <= set(names)
    text = json.dumps(stored_hashes.MODELS)
    used = set(re.findall(r'"type": "(\w+)"', text))
    assert not {name for kind in set(names) - OTHERS for name in names[kind]} - used
    for word in ("viscous", "stiffness", "double", "single"):
        assert f'"{word}"' in text


def test_every_criterion_has_eroded_elements(summaries):
    # Otherwise the hashes would not depend on all of them.
    eroded = {}
    for summary in summaries.values():
        for criterion, count in summary["eroded"]["by_criterion"].items():
            eroded[criterion] = eroded.get(criterion, 0) + count
    assert not {name for name in plugins()["erosion"] if eroded.get(name, 0) == 0}
