"""Damages restart files, one fault each: the run goes on to the right bits from a good one, or refuses with a sentence.

The faults are flipped bits, zeroed blocks, truncations and extensions, in the newest file, the one before it, or both.
"""

import json
import random
import shutil

from harness import Reference, Report, run, workplace
from kills import killed

KINDS = ("bit flip", "zeroed block", "truncation", "extension")


def damage(path, kind, chance):
    data = bytearray(path.read_bytes())
    before = bytes(data)
    while bytes(data) == before:
        at = chance.randrange(len(data))
        if kind == "bit flip":
            data[at] ^= 1 << chance.randrange(8)
        elif kind == "zeroed block":
            size = min(2 ** chance.randrange(13), len(data) - at)
            data[at:at + size] = bytes(size)
        elif kind == "truncation":
            del data[at:]
        else:
            data += bytes(chance.randrange(256) for _ in range(1 + chance.randrange(5000)))
    path.write_bytes(data)


def judge(done, out, which, reference):
    """(what happened, what is wrong)"""
    if done.hung or done.signal():
        return "", done.signal() or "hangs"
    if done.code == 0:
        if json.loads((out / "summary.json").read_text())["state_hash"] != reference.hash:
            return "", "SILENT: another state"
        if "note: " in done.out:
            if "is damaged: " not in done.out and "was not written by this version of Kerf" not in done.out \
                    and "is no file of Kerf's" not in done.out:
                return "", f"a note without its reason: {done.out[:300]}"
            return "the newest refused, the older taken", ""
        return "harmless: the newest is good, or a byte between its blocks was hit", ""
    if done.code == 2 and which == "both" and "there is no restart file that can be used" in done.err:
        return "both refused", ""
    return "", f"exit code {done.code}: {done.err[-300:]}"


def campaign(short=False):
    report = Report("damaged_restarts")
    chance = random.Random(5)
    with workplace() as parent:
        reference = Reference(parent)
        source, folder = killed(reference, parent), parent / "case"
        for i in range(40 if short else 2000):
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(source, folder)
            restart = folder / "out" / "restart"
            kind, which = chance.choice(KINDS), chance.choice(("newest",) * 6 + ("older", "both"))
            names = {"newest": ["restart"], "older": ["restart_previous"], "both": ["restart", "restart_previous"]}
            for name in names[which]:
                damage(restart / f"{name}.h5", kind, chance)
            done = run(folder, 2 if i % 10 == 9 else 1, ["--resume"])
            what, wrong = judge(done, folder / "out", which, reference)
            if wrong:
                report.failed(f"{i}: {kind} in {which}", wrong)
            else:
                report.passed(f"{kind}: {what}")
    return report
