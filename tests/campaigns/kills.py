"""Ends the run at every call of output in turn, on each rank, and at random moments; then looks at what is left.

Every file is absent, or as an earlier run left it, or readable and right as far as it goes; and --resume either says
that there is nothing to resume, or comes to the same bits as a run that nobody disturbed.
"""

import random
import shutil
import time

from harness import (Reference, Report, count_calls, every, fresh, kill_all, run, start, workplace)

SITUATIONS = ("new folder", "over an earlier run", "resumed")


def prepare(situation, reference, parent):
    """A folder in which a run is about to be started, and the words that start it."""
    folder = fresh(parent)
    if situation == "over an earlier run":
        shutil.copytree(reference.folder / "out", folder / "out")
    if situation == "resumed":
        shutil.copytree(killed(reference, parent) / "out", folder / "out")
        return folder, ["--resume"]
    return folder, []


def killed(reference, parent):
    """A run that was killed after its second restart file, with frames and rows that a resumed run has to drop."""
    folder = parent / "killed"
    if not folder.exists():
        fresh(parent, "killed")
        n = count_calls(reference.folder, 1)[0]
        run(folder, 1, fault={"AT": n - 24, "KIND": "kill"})
        assert (folder / "out" / "restart" / "restart_previous.h5").exists()
        assert not (folder / "out" / "summary.json").exists()
    return folder


def examine(report, reference, folder, case):
    wrong = reference.complaint(folder / "out") or reference.resume(folder)
    if wrong:
        report.failed(case, wrong)
    else:
        report.passed(case.split(":")[0])


def at_every_call(report, reference, parent, ranks, short):
    for situation in SITUATIONS:
        folder, words = prepare(situation, reference, parent)
        counts = count_calls(folder, ranks, words)
        for rank, n in enumerate(counts):
            for kind in ("kill", "tear"):
                if short and ranks > 1 and kind != ("kill", "tear")[rank]:
                    continue
                for at in every(n, short, 4 if ranks == 1 else 1):
                    folder, words = prepare(situation, reference, parent)
                    done = run(folder, ranks, words, {"AT": at, "KIND": kind, "RANK": rank})
                    case = f"{situation}, {ranks} ranks, {kind}: rank {rank}, call {at}"
                    if done.hung or done.code == 0:
                        report.failed(case, "hangs" if done.hung else "was not killed")
                    else:
                        examine(report, reference, folder, case)


def at_random(report, reference, parent, number):
    """Kills all processes of a run at once, whatever they are at."""
    chance = random.Random(1)
    longest = {}
    for ranks in (1, 2):
        began = time.time()
        run(fresh(parent), ranks)
        longest[ranks] = time.time() - began
    for i in range(number):
        ranks = 1 if chance.random() < 0.7 else 2
        folder, words = prepare(chance.choice(SITUATIONS), reference, parent)
        process = start(folder, ranks, words)
        time.sleep(longest[ranks] * chance.uniform(0.1, 1.0))
        kill_all(process)
        process.communicate()
        examine(report, reference, folder, f"random moment, {ranks} ranks: {i}")


def campaign(short=False):
    report = Report("kills")
    with workplace() as parent:
        reference = Reference(parent)
        for ranks in (1, 2):
            at_every_call(report, reference, parent, ranks, short)
        at_random(report, reference, parent, 4 if short else 300)
    return report
