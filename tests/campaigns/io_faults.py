"""Lets every call of output fail in turn, on each rank: the run stops on all ranks with exit code 1 and a sentence.

The sentence names the file and the cause. Frames and rows from before stay as they are, and the run can be resumed.
"""

import errno
import os
import re

from harness import Reference, Report, count_calls, every, run, workplace
from kills import SITUATIONS, prepare

KINDS = {"full": errno.ENOSPC, **{str(e): e for e in (errno.EIO, errno.EDQUOT, errno.EROFS)}}
KINDS_OF_SHORT_FORM = ("full", str(errno.EIO))


def sentence_of(error):
    """What the program has to say where a call fails with this errno."""
    return (r'case\.yaml: error: the run stopped: cannot [a-z ]+ ("[^"]+"|to the standard output)[^\n]*: ' +
            re.escape(os.strerror(error)))


def judge(report, reference, folder, done, case, error):
    what = case.split(":")[0]
    wrong = ""
    if done.hung or done.signal():
        wrong = done.signal() or "hangs"
    elif done.code == 0 and "note: " in done.out and "--resume" in case:
        what = what + ", went on from the file before"
    elif done.code == 0 and what.startswith("full") and (folder / "out" / "summary.json").exists():
        what = what + ", after the last call that needs space"
    elif done.code == 2 and f"the folder for the results cannot be made: {os.strerror(error)}" in done.err:
        what = what + ", no folder: name another"
    elif done.code == 1:
        if len(re.findall(sentence_of(error), done.err)) != 1:
            wrong = f"says: {done.err[-400:]}"
    else:
        wrong = f"exit code {done.code}: {done.err[-400:]}"
    wrong = wrong or reference.complaint(folder / "out") or reference.resume(folder)
    if wrong:
        report.failed(case, wrong)
    else:
        report.passed(what)


def campaign(short=False):
    report = Report("io_faults")
    with workplace() as parent:
        reference = Reference(parent)
        for ranks in (1, 2):
            for situation in SITUATIONS:
                folder, words = prepare(situation, reference, parent)
                for rank, n in enumerate(count_calls(folder, ranks, words)):
                    for kind, error in KINDS.items():
                        if short and kind not in KINDS_OF_SHORT_FORM:
                            continue
                        for at in every(n, short, 3 if ranks == 1 else 1):
                            folder, words = prepare(situation, reference, parent)
                            done = run(folder, ranks, words, {"AT": at, "KIND": kind, "RANK": rank})
                            name = kind if kind == "full" else errno.errorcode[error]
                            case = f"{name}, {ranks} ranks: {situation} {' '.join(words)}, rank {rank}, call {at}"
                            judge(report, reference, folder, done, case, error)
    return report
