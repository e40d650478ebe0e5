"""Mutants of what the device's programs are composed of, each alone in the text of these programs: kernels, what they
include, and the functors of plugins. A program is compiled in seconds, so that constants of compile time, which cannot be
among other mutants, are tried here. The host's side keeps what it was: a number that both sides read is changed for one."""

import json
import os
import shutil
import sys
import threading
from collections import Counter
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from build import BuildFailed
from group import COMPILING, cases_of
from results import Result
from trial import Bench

# In the place of the compiler of programs: it changes the text before, and notes whether that changed the instructions.
COMPILER = """#!{python} -B
import hashlib, os, shutil, subprocess, sys
sys.path.insert(0, {folder!r})
from programs import changed_composition, read_change

words, notes = sys.argv[1:], os.environ.get("MPM_NOTES")
if notes and "-c" in words:
    source, out = words[words.index("-c") + 1], words[words.index("-o") + 1]
    text = open(source).read()
    with open(notes + ".sections", "a") as file:
        file.writelines(line for line in text.splitlines(True) if line.startswith("#line 1 "))
    changed = changed_composition(text, read_change(os.environ["MPM_CHANGE"])) if "MPM_CHANGE" in os.environ else text
    if changed is not None:
        kept = os.path.join({kept!r}, hashlib.sha256(text.encode()).hexdigest())
        if not os.path.isfile(kept):
            new = out + ".unchanged.o"
            if subprocess.call([{compiler!r}, *words, "-w", "-o", new]) == 0:
                shutil.move(new, kept)
        open(source, "w").write(changed)
        status = subprocess.call([{compiler!r}, *words, "-w"])
        same = status == 0 and os.path.isfile(kept) and open(out, "rb").read() == open(kept, "rb").read()
        with open(notes, "a") as file:
            refused = status > 0 and os.path.isfile(kept)  # else the compiler was ended, or refuses the unchanged text as well
            file.write("refused\\n" if refused else "ended\\n" if status else "same\\n" if same else "changed\\n")
        sys.exit(status)
os.execv({compiler!r}, [{compiler!r}, *words, "-w"])
"""


def section_of(file):
    """What the composer calls a file's text (modules/backends/device/compose.cpp)."""
    kind, name = file.removeprefix("modules/").split("/")[:2]
    plural = {"shapes": "shape", "transfers": "transfer", "filters": "filter", "contacts": "contact", "normals": "normal",
              "detections": "detection", "materials": "material"}  # fmt: skip
    return f"{plural[kind]} plugin {name}" if kind in plural else file.removeprefix("modules/")


def change_of(mutant, text):
    """The lines that a mutant changes in its file: section, first line from 0, the old lines and the new ones."""
    old, new = text.split("\n"), mutant.applied(text).split("\n")
    first = next(at for at, (a, b) in enumerate(zip(old, new)) if a != b)
    behind = next(at for at, (a, b) in enumerate(zip(reversed(old), reversed(new))) if a != b)
    behind = min(behind, len(old) - first, len(new) - first)
    return {"section": section_of(mutant.file), "first": first, "old": old[first : len(old) - behind],
            "new": new[first : len(new) - behind]}  # fmt: skip


def changed_composition(text, change):
    """The composition with the change, none where it has not that file, or has none of its lines there."""
    mark = f'#line 1 "{change["section"]}"\n'
    at = text.find(mark)
    if at < 0:
        return None
    head, lines = text[: at + len(mark)], text[at + len(mark) :].split("\n")
    behind = change["first"] + len(change["old"])
    if lines[change["first"] : behind] != change["old"]:
        return None
    return head + "\n".join([*lines[: change["first"]], *change["new"], *lines[behind:]])


def read_change(path):
    return json.loads(Path(path).read_text())


class InPrograms:
    """Tries mutants by the quick cases of the suites, the likeliest first, until `patience` seconds of cases have passed."""

    def __init__(self, build, longest, patience, suites, checks, first, say):
        self.build, self.longest, self.patience, self.first, self.say = build, longest, patience, first, say
        self.bench, self.lock = Bench(build, build.work / "programs_bench"), threading.Lock()
        self.cases = cases_of(build, suites, checks)
        kept = build.work / "unchanged_objects"
        kept.mkdir(parents=True, exist_ok=True)
        compiler = self.bench.folder / "tools/c++"
        compiler.parent.mkdir()
        compiler.write_text(COMPILER.format(python=sys.executable, folder=str(Path(__file__).parent), kept=str(kept),
                                            compiler=shutil.which("c++")))  # fmt: skip
        compiler.chmod(0o755)
        self.tools = f"{compiler.parent}:{os.environ['PATH']}"

    def learn(self, jobs):
        """Runs each case unchanged: those that compile nothing, or fail, are of no use here."""
        known = self.build.work / "programs.json"
        kept = json.loads(known.read_text()) if known.is_file() else {}
        unknown = [case for case in self.cases if case.key not in kept]
        with ThreadPoolExecutor(jobs) as pool:
            try:
                for case, learnt in zip(unknown, pool.map(lambda case: self.run(case, self.longest, None), unknown)):
                    code, _, seconds, sections = learnt
                    if code == 0:
                        kept[case.key] = {"seconds": seconds, "usable": True, "comes_to": sorted(sections)}
                        known.write_text(json.dumps(kept))
                    elif code is not None:
                        self.say(f"mutation: {case.name} ({case.title}) fails on the unchanged program, and is left out")
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                Bench.stop_all()
                raise
        self.cases = [case for case in self.cases if case.key in kept]
        for case in self.cases:
            case.learn({"broken_off": False, **kept[case.key]})
        self.cases = [case for case in self.cases if case.usable and case.comes_to]
        if not self.cases:
            raise BuildFailed(f"no case of these suites compiles a program of the device in {self.longest} seconds")
        self.say(f"mutation: {len(self.cases)} cases and checks compile programs of the device and take at most {self.longest} seconds")

    def run(self, case, most, change):
        """Exit code, what the compiler noted, how long it took, and the names of the texts that its programs had, of a case that
        finds no program of an earlier run."""
        folder = self.bench.folder / f"run_{threading.get_ident()}"
        shutil.rmtree(folder, ignore_errors=True)
        (folder / "scratch").mkdir(parents=True)
        variables = {"MPM_NOTES": str(folder / "notes")}
        if change is not None:
            (folder / "change.json").write_text(json.dumps(change))
            variables["MPM_CHANGE"] = str(folder / "change.json")
        before = os.times()
        code, _ = self.bench.run([self.build.folder / "bin" / f"test_{case.suite}", *case.call], most, PATH=self.tools,
                                 MPM_PROGRAMS_OF_TESTS=str(folder), TMPDIR=str(folder / "scratch"), **case.variables,
                                 **variables)  # fmt: skip
        after = os.times()
        notes, sections = [path.read_text() if path.is_file() else "" for path in (folder / "notes", folder / "notes.sections")]
        return code, Counter(notes.split()), after.elapsed - before.elapsed, {line.split('"')[1] for line in sections.splitlines()}

    def results(self, mutants, jobs):
        """(mutant, result) as they come."""
        self.learn(jobs)
        with ThreadPoolExecutor(jobs) as pool:
            waiting = {pool.submit(self.result, mutant): mutant for mutant in mutants}
            try:
                for ended in as_completed(waiting):
                    yield waiting[ended], ended.result()
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                Bench.stop_all()
                raise

    def result(self, mutant):
        """What became of a mutant; none where no program that was compiled in time has its line, or is changed by it."""
        change = change_of(mutant, (self.build.tree / mutant.file).read_text())
        passed, seen, spent = Counter(), Counter(), 0.0
        left = [case for case in self.cases if change["section"] in case.comes_to]
        while left and spent < self.patience:
            with self.lock:
                case = max(left, key=lambda case: (case.name in self.first, case.promise(mutant, passed)))
            left.remove(case)
            code, notes, seconds, _ = self.run(case, 2 * case.seconds + COMPILING / 4, change)
            spent += seconds
            seen += notes
            if notes["refused"]:
                return Result(Result.UNCOMPILED)
            killed = notes["changed"] > 0 and code != 0
            if notes["changed"]:
                with self.lock:
                    case.note(mutant, killed)
                passed[case.title] += 1
            if killed:
                return Result(Result.TIMED_OUT if code is None else Result.KILLED, case.name, case.title)
        if not seen:
            return None
        if not seen["changed"] and left:  # others might have been changed
            return None
        if not seen["changed"]:
            return Result(Result.SAME_CODE, check=f"in {seen['same']} programs of the device")
        return Result(Result.SURVIVED, check=f"by {passed.total()} cases whose programs of the device it changes")
