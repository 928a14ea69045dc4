"""Fuzzes the way from an input file to a checked model with libFuzzer, and prints the coverage of framework/input.

Needs clang and libclang-rt-14-dev. The room `input` is compiled anew with Clang, with counters and the sanitizers of
addresses and undefined behaviour; the rest of the engine is that of the ordinary build.
"""

import json
import re
import shlex
import shutil
import subprocess

from harness import BUILD, HERE, KERF, SOURCE, Report

FOLDER = BUILD / "fuzz"
FLAGS = ["-std=c++20", "-O1", "-g", "-fno-omit-frame-pointer", "-fPIC", "-fprofile-instr-generate",
         "-fcoverage-mapping", "-fno-sanitize-recover=undefined", "-fno-sanitize=vptr", "-w"]
SANITIZERS = "-fsanitize=fuzzer-no-link,address,undefined"


def is_possible():
    """Whether Clang and its fuzzer are here."""
    if shutil.which("clang++") is None or shutil.which("llvm-profdata-14") is None:
        return False
    library = subprocess.run(["clang++", "-print-file-name=libclang_rt.fuzzer-x86_64.a"], capture_output=True,
                             text=True)
    runtime = subprocess.run(["clang++", "-print-resource-dir"], capture_output=True, text=True).stdout.strip()
    return library.returncode == 0 and any(
        subprocess.run(["find", runtime, "-name", "libclang_rt.fuzzer*"], capture_output=True,
                       text=True).stdout.split())


def ninja_command(target):
    done = subprocess.run(["ninja", "-C", str(BUILD), "-t", "commands", target], capture_output=True, text=True,
                          check=True)
    return done.stdout.strip().splitlines()[-1]


def build():
    """Compiles what has changed and links the fuzzer."""
    FOLDER.mkdir(exist_ok=True)
    example = shlex.split(ninja_command("framework/CMakeFiles/kerf_engine.dir/input/binder.cpp.o"))
    includes = [w for w in example if w.startswith(("-I", "-D"))]
    for i, word in enumerate(example):
        if word == "-isystem":
            includes += ["-isystem", example[i + 1]]
    objects = []
    for source in [*sorted((SOURCE / "framework" / "input").glob("*.cpp")), HERE / "fuzz_target.cpp"]:
        target = FOLDER / f"{source.stem}.o"
        objects.append(str(target))
        newest = max(p.stat().st_mtime for folder in ("input", "core", "api/kerf", "plugin")
                     for p in (SOURCE / "framework" / folder).iterdir())
        if target.exists() and target.stat().st_mtime > max(newest, source.stat().st_mtime):
            continue
        subprocess.run(["clang++", *FLAGS, SANITIZERS, *includes, "-c", str(source), "-o", str(target)], check=True)
    words = shlex.split(ninja_command("bin/kerf").removeprefix(": && ").removesuffix(" && :"))
    libraries = words[words.index("bin/kerf") + 1:]
    subprocess.run(["clang++", *FLAGS, "-fsanitize=fuzzer,address,undefined", *objects,
                    "-o", str(FOLDER / "fuzz_input"),
                    *libraries], cwd=BUILD, check=True)


def seed():
    corpus = FOLDER / "corpus"
    corpus.mkdir(exist_ok=True)
    for source in [*(SOURCE / "inputs").rglob("*.yaml"), *(SOURCE / "tests").rglob("*.yaml")]:
        if source.stat().st_size < 8000:
            shutil.copy(source, corpus / f"{source.parent.name}_{source.name}")
    schema = subprocess.run([KERF, "schema"], capture_output=True, text=True, check=True).stdout
    words = sorted(set(re.findall(r'"([A-Za-z_][A-Za-z0-9_]*)"', schema)))
    words += ["Pa", "GPa", "m/s", "kg/m3", ".inf", ".nan", "1e308", "5e-324", "$", "&a", "*a", "<<", "!!float", "? "]
    (FOLDER / "dictionary").write_text("".join(f"{json.dumps(word)}\n" for word in words))
    return corpus


def coverage():
    """Lines of framework/input that were run."""
    profile = FOLDER / "merged.profdata"
    subprocess.run(["llvm-profdata-14", "merge", "-sparse", str(FOLDER / "fuzz.profraw"), "-o", str(profile)],
                   check=True)
    done = subprocess.run(["llvm-cov-14", "report", str(FOLDER / "fuzz_input"), f"-instr-profile={profile}",
                           *map(str, sorted((SOURCE / "framework" / "input").glob("*.cpp")))],
                          capture_output=True, text=True, check=True)
    return done.stdout


def campaign(short=False):
    report = Report("fuzz_input")
    if not is_possible():
        report.failed("the machine", "clang++ or its fuzzer is missing; install clang and libclang-rt-14-dev")
        return report
    build()
    corpus, runs = seed(), 2000 if short else 1_000_000
    words = [str(FOLDER / "fuzz_input"), f"-runs={runs}", "-max_len=8192", "-timeout=20", "-rss_limit_mb=3000",
             "-print_final_stats=1", f"-dict={FOLDER / 'dictionary'}", f"-artifact_prefix={FOLDER}/", str(corpus)]
    environment = {"LLVM_PROFILE_FILE": str(FOLDER / "fuzz.profraw"), "PATH": "/usr/bin:/bin",
                   "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1"}
    done = subprocess.run(words, cwd=FOLDER, env=environment, capture_output=True, text=True, errors="replace")
    executed = re.search(r"stat::number_of_executed_units:\s*(\d+)", done.stderr)
    report.counts["inputs read or refused"] = int(executed[1]) if executed else 0
    if done.returncode != 0:
        report.failed("fuzzer", done.stderr[-4000:])
    else:
        print(coverage())
    return report
