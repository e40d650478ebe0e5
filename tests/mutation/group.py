"""The mutants of kernels, operators and backends, of many files in one build. All plugins and instantiations include
these files; the build holds the mutants only in the few objects that find most of them. Which test comes to which
expression is noted once, so that a mutant is tried by the cases alone that come to it."""

import hashlib
import json
import math
import multiprocessing
import os
import re
import resource
import shutil
import signal
import subprocess
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

from build import BuildFailed, environment, hash_of
from results import Result
from together import SWITCH, SWITCH_FILE, SWITCH_ON_DEVICE, Together
from trial import NOT_OF_THE_PROGRAM, Bench, Refused

KINDS = ("backends", "kernel", "operators")
OPTIMISATION = "-O2"  # that of the published runs; the compiler's fault with -O1 is mended (modules/MpmBuild.cmake)
SUITES = ["parity", "unit", "conformance", "verification", "config"]
DEVICE, DEVICE_SUITES = "modules/backends/device", ["device"]  # no other suite knows the device's objects
KERNELS, COMPOSER = f"{DEVICE}/kernels/", "mpm_device.dir/compose.cpp.o"  # the composer's object holds their text
COMPILING = 60  # seconds of processor time that the compiler of a program of the device may take
KEPT_PROGRAMS = ("host_programs_of_tests", "programs_of_tests")  # folders of the build (tests/device/device_support.hpp)
TABLE, TABLE_FILE = "-DMPM_KERNEL_HEADERS=", "kernel_headers.inc"
COMPILER = """#!/bin/sh
# Compiles programs of the device without warnings of changed text, and keeps what the compiler says where it refuses.
{} "$@" -w 2> "$0.$$"
status=$?
cat "$0.$$" >&2
test $status = 0 || cat "$0.$$" > "$0.messages"
rm "$0.$$"
exit $status
"""
PLUGIN_IN_A_TEST = re.compile(r'#include "(?:contacts|detections|filters|materials|normals|shapes|transfers)/')
CHECKS = re.compile(r"\b(?:is_chosen_check|check_parity|check_on_device)\(")
INSTANTIATION = re.compile(r"_([23]_(?:float|double))\.cpp\.o$")


def cases_of(build, suites, most_checks):
    """The quick cases of the suites; of one that makes many checks of a scene each is a case of its own, up to so many."""
    cases, counted = [], build.work / "checks.json"
    counts = json.loads(counted.read_text()) if counted.is_file() else {}
    for suite in [suite for suite in (*SUITES, *DEVICE_SUITES) if suite in build.suites]:
        for path in sorted((build.tree / "tests" / suite).glob("*.cpp")):
            name = f"{suite}.{path.stem}"
            if name in NOT_OF_THE_PROGRAM or suite not in suites and name not in suites:
                continue
            listed = subprocess.run([build.folder / "bin" / f"test_{suite}", "-#", "--list-test-names-only",
                                     f"[#{path.stem}]~[slow]"], cwd=build.folder, env=environment(),
                                    capture_output=True, text=True)  # fmt: skip
            text = path.read_text()
            for case in [Case(suite, path.stem, title, text) for title in listed.stdout.split("\n") if title.strip()]:
                if case.key not in counts:
                    counts[case.key] = checks_of(build, case) if CHECKS.search(text) else 0
                count = counts[case.key]
                each = range(1, count + 1, math.ceil(count / most_checks)) if count > 1 else [None]
                cases += [Case(suite, path.stem, case.title, text, check) for check in each]
    counted.write_text(json.dumps(counts))
    return cases


def checks_of(build, case):
    """How many checks a case makes; it is run without them, and without a compiler, so that no program of the device is
    compiled for it."""
    file = build.work / "checks"
    file.write_bytes(b"")
    subprocess.run([build.folder / "bin" / f"test_{case.suite}", *case.call], cwd=build.folder, capture_output=True,
                   env={**environment(), "MPM_CHECKS_COUNTED": str(file), "PATH": str(build.work)})  # fmt: skip
    return file.stat().st_size


def in_overlay(listed, tree, overlay):
    """A list of included files of the tree, with those that the overlay has in their place."""
    def place(found):
        own = overlay / os.path.relpath(found[1], tree)
        return f'#include "{own if own.is_file() else found[1]}"'

    return re.sub(r'(?m)^#include "([^"]+)"', place, listed)


class Case:
    """A quick case, or one check of it, with what is known of it: how long it takes and which expressions it comes to. One
    that takes longer than --longest is broken off there, and what it checks before that counts."""

    def __init__(self, suite, file, title, text, check=None):
        self.suite, self.file, self.title, self.check = suite, file, title, check
        self.name = f"{suite}.{file}"
        self.key = f"{self.name} {hash_of(text)} {title}" + (f" {check}" if check else "")
        self.seconds, self.comes_to, self.usable, self.broken_off = None, frozenset(), None, False
        self.kills, self.tries, self.at = Counter(), Counter(), {}

    def learn(self, kept):
        self.seconds, self.usable, self.broken_off = kept["seconds"], kept["usable"], kept["broken_off"]
        self.comes_to = frozenset(kept["comes_to"])

    def learnt(self):
        return {"seconds": self.seconds, "usable": self.usable, "broken_off": self.broken_off,
                "comes_to": sorted(self.comes_to)}  # fmt: skip

    @property
    def call(self):
        # Signs that Catch would read as its own.
        return [re.sub(r'([\\,\[\]"*~])', r"\\\1", self.title), "--abort"]

    @property
    def variables(self):
        return {"MPM_CHECK": str(self.check)} if self.check else {}

    def note(self, mutant, killed):
        self.tries[mutant.file] += 1
        self.kills[mutant.file] += killed
        self.at.setdefault((mutant.file, mutant.line // 4), []).append(killed)

    def promise(self, mutant, passed):
        """How likely it kills a mutant, for a second of processor time: as it did those of the file, and above all those
        of the lines about it. Checks of a case that has passed before are likely to pass as well."""
        near = self.at.get((mutant.file, mutant.line // 4), ())
        kills = self.kills[mutant.file] + 0.2 * self.kills.total() + 0.2 + 3 * sum(near)
        tries = self.tries[mutant.file] + 0.2 * self.tries.total() + 1 + 3 * len(near)
        return kills / tries * 0.7 ** passed[self.title] / ((0.5 if self.seconds is None else self.seconds) + 0.05)


class Group:
    """`mutants` are all of the build, whether or not they are tried in this call: objects once made serve again."""

    def __init__(self, build, mutants, longest, patience, instantiations, suites, alone, checks, first, say):
        self.build, self.mutants, self.longest, self.patience = build, mutants, longest, patience
        self.instantiations, self.suites, self.alone, self.say = instantiations, suites, alone, say
        self.first = first
        self.bench = Bench(build, build.work / "group")
        self.of_the_device = any(mutant.file.startswith(DEVICE) for mutant in mutants)
        self.read_programs()
        self.texts, self.number_of, self.noted_as = {}, {}, {}
        for file in dict.fromkeys(mutant.file for mutant in mutants):
            of_file = [mutant for mutant in mutants if mutant.file == file]
            first = len(self.number_of) + 1
            self.texts[file] = Together((build.tree / file).read_text(), of_file, first)
            self.texts[file].refuse_constants()
            self.number_of |= {mutant: number for number, mutant in enumerate(of_file, first)}
            self.noted_as |= self.texts[file].expression_of()
        self.kernels = [file for file in self.texts if file.startswith(KERNELS)]
        words = [SWITCH, SWITCH_ON_DEVICE, *instantiations, *(f"{m.name}\n{m.code}" for m in mutants), *(t.text for t in self.texts.values())]
        self.kept = build.work / "kept" / hashlib.sha256("\n".join(words).encode()).hexdigest()[:16]
        self.kept.mkdir(parents=True, exist_ok=True)
        self.objects = self.chosen_objects(set(self.texts))
        self.make()
        self.programs = {}
        self.cases = cases_of(build, suites, checks)
        self.known, self.kept_at = self.kept / "cases.json", 0
        kept = json.loads(self.known.read_text()) if self.known.is_file() else {}
        for case in self.cases:
            if case.key in kept:
                case.learn(kept[case.key])

    def results(self, mutants, jobs):
        """(mutant, result) as they come, of `jobs` processes side by side. Those of the device are tried case by case: most
        of a case's time goes to what it compares the device with."""
        global sharer
        sharer = self
        if self.of_the_device:
            yield from self.results_by_case(mutants, jobs)
            return
        if jobs == 1:
            for mutant in mutants:
                yield mutant, self.result(mutant)
            return
        for suite in self.build.suites:
            self.program_of(suite)
        unseen = [place for place, case in enumerate(self.cases) if case.usable is None]
        for place, learnt in side_by_side(jobs, look, unseen):
            self.take(self.cases[place], learnt)
            self.keep_now_and_then()
        self.keep()
        places = {mutant: place for place, mutant in enumerate(self.mutants)}
        for place, result in side_by_side(jobs, try_one, [places[mutant] for mutant in mutants]):
            yield self.mutants[place], result

    # ---- the build ---------------------------------------------------------------------------------------------

    def chosen_objects(self, files):
        """Of what is made from the files: libraries that include one in their own text, the cpu backend in the chosen
        dimensions and precisions, the device backend for its own files, tests that include one or a plugin in their own text."""
        chosen = []
        for name in sorted(set(self.of_device(files)).union(*(self.build.objects_of.get(file, ()) for file in files))):
            source = os.path.relpath(self.build.source_of[name], self.build.tree)
            found = INSTANTIATION.search(name)
            if name.startswith("tests/"):
                test = self.build.test_of(name)
                names = [f"{test[0]}.{file.stem}" for file in self.build.files_together(name)] or [".".join(test)] if test else []
                asked = test and (test[0] in self.suites or set(names) & set(self.suites))
                wanted = asked and (self.includes_one(name, files) or PLUGIN_IN_A_TEST.search(self.text_of(name)))
            elif found or "mpm_fused_backend.dir" in name:
                wanted = found and found[1] in self.instantiations
            elif "mpm_device.dir" in name or "mpm_device_backend.dir" in name:
                wanted = name in self.of_device(files)
            elif self.build.plugin_of(name) or not name.startswith("modules/"):
                wanted = False
            else:
                wanted = source in files or "mpm_reference_backend.dir" in name or self.includes_one(name, files)
            if wanted and "modules/bench" not in name:
                chosen.append(name)
        return chosen

    def of_device(self, files):
        """What is made from those of the files that are the device's: these alone are worth the time there."""
        own = [file for file in files if file.startswith(DEVICE + "/")]
        composer = [name for name in self.build.compile_of if name.endswith(COMPOSER) and any(f.startswith(KERNELS) for f in own)]
        return set(composer).union(*(self.build.objects_of.get(file, ()) for file in own))

    def text_of(self, name):
        return (self.build.folder / self.build.source_of[name]).read_text()

    def includes_one(self, name, files):
        """Whether a source or its own header, the one of its name, includes one of the files."""
        header = (self.build.folder / self.build.source_of[name]).with_suffix(".hpp")
        text = self.text_of(name) + (header.read_text() if header.is_file() else "")
        return any(f'#include "{file.removeprefix("modules/")}"' in text for file in files)

    def make(self):
        """Compiles the objects, without the mutants that the compiler refuses here. An object made before a refusal
        holds that mutant as well, but no program is told to be it."""
        state = self.kept / "refused.json"
        if state.is_file():
            kept = {name: set(numbers) for name, numbers in json.loads(state.read_text()).items()}
            for text in self.texts.values():
                own = set(text.numbers())
                text.refused |= kept["refused"] & own
                text.of_other_type |= kept["of_other_type"] & own
                text.no_program |= kept["no_program"] & own
        # What refuses a kernel's mutant takes it out of the texts that the composer's object holds, which is made last.
        for name in sorted(self.objects, key=lambda name: name.endswith(COMPOSER)):
            while not self.path_of(name).is_file():
                self.write_texts(self.bench.folder / "overlay", {file: t.written() for file, t in self.texts.items()})
                output = self.compile(name, self.path_of(name), self.bench.folder / "overlay")
                if output is None:
                    self.say(f"mutation: made {os.path.basename(name)}")
                    break
                if not any([text.refuse(output) for text in self.texts.values()]):
                    raise Refused(output)
                self.note_refused()

    def note_refused(self):
        refused = {n for m, n in self.number_of.items() if n not in self.texts[m.file].numbers()}
        self.say(f"mutation: {len(refused)} of {len(self.mutants)} mutants are refused among the others")
        kept = {"refused": sorted(refused)}
        for name in ("of_other_type", "no_program"):
            kept[name] = sorted(set().union(*(getattr(text, name) for text in self.texts.values())))
        (self.kept / "refused.json").write_text(json.dumps(kept))

    def path_of(self, name):
        """A test's object is made anew when its text has changed."""
        text = ""
        if name.startswith("tests/"):
            text = hash_of(self.text_of(name) + "".join(f.read_text() for f in self.build.files_together(name))) + "_"
        return self.kept / (text + name.replace("/", "_"))

    def write_texts(self, overlay, texts):
        shutil.rmtree(overlay, ignore_errors=True)
        for file, text in texts.items():
            changed = overlay / file
            if not changed.parent.is_dir():  # neighbours come along: they are included by their names alone
                shutil.copytree((self.build.tree / file).parent, changed.parent, dirs_exist_ok=True)
        for file, text in texts.items():
            (overlay / file).write_text(text)
        (overlay / "modules" / SWITCH_FILE).write_text(SWITCH)
        if self.kernels:
            self.write_table(overlay, texts)

    def write_table(self, overlay, texts):
        """The table of texts that the device's programs are composed of, with these in the place of the build's."""
        composer = next(words for name, words in self.build.compile_of.items() if name.endswith(COMPOSER))
        define = next(word for word in composer if word.startswith(TABLE))
        entry = '{{"{}", R"MPM_SOURCE({})MPM_SOURCE"}}'.format
        table = Path(define.removeprefix(TABLE).strip('"')).read_text()
        for file in [file for file in self.kernels if file in texts]:
            name, old = file.removeprefix("modules/"), (self.build.tree / file).read_text()
            if entry(name, old) not in table:
                raise Refused(f"the build is older than {file}")
            table = table.replace(entry(name, old), entry(name, texts[file]))
        (overlay / TABLE_FILE).write_text(table + entry(SWITCH_FILE, SWITCH_ON_DEVICE) + ",\n")

    def compile(self, name, out, overlay):
        """The compiler's messages where it refuses."""
        words = [word for word in self.build.compile_of[name] if word != "-Werror"]
        words[words.index("-o") + 1] = str(out.with_suffix(".new"))
        words[words.index("-c") + 1] = self.source_in(overlay, name)
        words.insert(1, f"-I{overlay / 'modules'}")
        if self.kernels:
            words = [f'{TABLE}"{overlay / TABLE_FILE}"' if word.startswith(TABLE) else word for word in words]
        code, output = self.bench.run([*words, "-w", OPTIMISATION], 900)
        if code != 0:
            return output
        out.with_suffix(".new").replace(out)
        return None

    def source_in(self, overlay, name):
        """An object's source, that of the overlay where it has one. Of files that are compiled as one it is their list."""
        source = self.build.source_of[name]
        own = overlay / os.path.relpath(source, self.build.tree)
        if own.is_file():
            return str(own)
        if "/Unity/unity_" not in source:
            return source
        together = overlay / f"{name.replace('/', '_')}.cpp"
        together.write_text(in_overlay(self.text_of(name), self.build.tree, overlay))
        return str(together)

    def program_of(self, suite, changed=None):
        """A suite's program with the changed objects before all others: what several define is taken from the first."""
        known = {name: str(self.path_of(name)) for name in self.objects} if changed is None else changed
        if changed is None and suite in self.programs:
            return self.programs[suite]
        program = f"test_{suite}"
        own = {n: p for n, p in known.items() if not self.build.test_of(n) or self.build.test_of(n)[0] == suite}
        words = [own.get(word, word) for word in self.build.links[program]]
        out = self.bench.folder / "bin" / f"{program}_changed" if changed is None else self.own(f"bin/{program}_alone")
        words[words.index("-o") + 1] = str(out)
        words = [words[0], *own.values(), *(word for word in words[1:] if word not in own.values())]
        code, output = self.bench.run([*words, "-Wl,--allow-multiple-definition"], 300)
        if code != 0:
            raise Refused(output)
        if changed is None:
            self.programs[suite] = out
        return out

    # ---- programs of the device ----------------------------------------------------------------------------------

    def read_programs(self):
        """Begins with the programs that the build has compiled for its tests of the device."""
        self.programs_kept = self.build.work / "programs"
        for name in KEPT_PROGRAMS if self.of_the_device else ():
            if (self.build.folder / name).is_dir() and not (self.programs_kept / name).is_dir():
                shutil.copytree(self.build.folder / name, self.programs_kept / name)
        self.programs_kept.mkdir(exist_ok=True)
        compiler = self.bench.folder / "tools/c++"
        compiler.parent.mkdir()
        compiler.write_text(COMPILER.format(shutil.which("c++")))
        compiler.chmod(0o755)
        self.messages = compiler.with_name("c++.messages")
        self.tools = f"{compiler.parent}:{os.environ['PATH']}"

    def own(self, name):
        """A path of this process alone."""
        return self.bench.folder / f"{name}_{os.getpid()}"

    def run(self, case, program, seconds, programs, **variables):
        """Runs a case that finds programs of the device in a folder, and has one for temporary files that it leaves empty."""
        scratch = self.own("scratch")
        shutil.rmtree(scratch, ignore_errors=True)
        scratch.mkdir()
        return self.bench.run([program, *case.call], seconds, MPM_PROGRAMS_OF_TESTS=str(programs), TMPDIR=str(scratch),
                              **({"PATH": self.tools} if self.kernels else {}), **case.variables, **variables)[0]  # fmt: skip

    def compositions_refuse(self):
        """Takes out the mutants of kernels that the compiler of the device's programs refused; whether there were any."""
        output = self.messages.read_text() if self.messages.is_file() else ""
        self.messages.unlink(missing_ok=True)
        if not any([self.texts[file].refuse(output) for file in self.kernels]):
            return False
        for name in self.objects:
            if name.endswith(COMPOSER):
                self.path_of(name).unlink()
        self.note_refused()
        self.programs.clear()
        self.make()
        return True

    def programs_of_mutant(self):
        """Programs as the unchanged device compiled them, in a folder of their own: a mutant may keep wrong ones."""
        folder = self.own("programs")
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.programs_kept, folder, copy_function=os.link)
        return folder

    # ---- one mutant --------------------------------------------------------------------------------------------

    def spent(self):
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    def look_at(self, case):
        """What is to be learnt of a case: whether it passes unchanged, how long it takes, what it comes to. Programs of the
        device are compiled in a run of their own, whose compiler may take longer than --longest."""
        seen = self.own("seen")
        most = self.longest + (COMPILING if self.of_the_device else 0)
        while True:
            seen.write_bytes(bytes(len(self.mutants) + 1))
            kept, before = self.count_programs(), self.spent()
            code = self.run(case, self.program_of(case.suite), most, self.programs_kept,
                            MPM_MUTANT="-1", MPM_MUTANT_SEEN=str(seen))  # fmt: skip
            seconds = self.spent() - before
            if code not in (0, None) and self.compositions_refuse():
                continue
            if self.count_programs() == kept:
                if most == self.longest or seconds <= self.longest:
                    break
                most = self.longest
        return {"seconds": seconds, "broken_off": code is None, "usable": code in (0, None),
                "comes_to": [n for n, byte in enumerate(seen.read_bytes()) if byte]}  # fmt: skip

    def count_programs(self):
        return sum(1 for _ in self.programs_kept.glob("*/*"))

    def take(self, case, learnt):
        case.learn(learnt)
        if not case.usable:
            self.say(f"mutation: {case.name} ({case.title}) fails on the unchanged program as it is compiled here, and is left out")

    def keep(self):
        self.kept_at = time.monotonic()
        self.known.write_text(json.dumps({case.key: case.learnt() for case in self.cases if case.usable is not None}))

    def learn_of(self, case):
        self.take(case, self.look_at(case))
        self.keep_now_and_then()

    def keep_now_and_then(self):
        if time.monotonic() > self.kept_at + 10:
            self.keep()

    def result(self, mutant):
        """What became of a mutant; none where it can only be compiled alone and changes too many objects."""
        number = self.number_of[mutant]
        if number in self.texts[mutant.file].no_program:
            return Result(Result.UNCOMPILED)
        if number not in self.texts[mutant.file].numbers():
            return self.result_alone(mutant)
        return self.tried(mutant, number, self.program_of, self.noted_as[number])

    def results_by_case(self, mutants, jobs):
        """(mutant, result): each case tries all that are left and come to it, in processes that begin where its scene of
        the device does (tests/support/trials.hpp)."""
        left = {}
        for mutant in mutants:
            number = self.number_of[mutant]
            if number in self.texts[mutant.file].numbers():
                left[number] = mutant
            elif number in self.texts[mutant.file].no_program:
                yield mutant, Result(Result.UNCOMPILED)
            else:
                yield mutant, self.result_alone(mutant)
        came, tried = Counter(), set()
        if not self.kernels:  # whose programs take long to compile: these are looked at when their turn comes
            for case in [case for case in self.cases if case.usable is None]:
                self.learn_of(case)
            self.keep()
        ordered = sorted(self.cases, key=lambda case: (case.name not in self.first, case.seconds or 0))
        # One that has passed a few cases seldom fails in a like one: others first.
        for most, case in [(3, case) for case in ordered] + [(math.inf, case) for case in ordered]:
            numbers = [n for n in self.numbers_that_come_to(case, left) if came[n] < most and (n, case) not in tried]
            if not numbers:
                continue
            killed, passed = self.killed_by(case, numbers, jobs)
            came.update(passed)
            tried.update((number, case) for number in numbers)
            self.say(f"mutation: {len(killed)} of {len(numbers)} killed by {case.name} ({case.title} {case.check or ''})")
            for number, status in killed.items():
                yield left.pop(number), Result(status, case.name, case.title)
        for number, mutant in left.items():
            count = came[number]
            yield mutant, Result(Result.SURVIVED, check=f"by {count} cases, all of those chosen that come to it" if count else "no case comes to it")

    def numbers_that_come_to(self, case, left):
        """Those of the mutants that are left. A composition that is compiled may take some of them out of all programs."""
        if case.usable is None:
            self.learn_of(case)
        held = {n for mutant in set(left.values()) for n in [self.number_of[mutant]] if n in self.texts[mutant.file].numbers()}
        return [n for n in left if n in held and self.noted_as[n] in case.comes_to] if case.usable else []

    def killed_by(self, case, numbers, jobs):
        """What became of those that do not pass, by their numbers, and which ones pass. The first process is the unchanged
        program. All find the programs of the device that were there before them."""
        programs = self.programs_of_mutant()
        listed, ended = self.own("numbers"), self.own("ended")
        listed.write_text(" ".join(map(str, [0, *numbers])))
        ended.unlink(missing_ok=True)
        # The time is that of the process which waits for the others.
        self.run(case, self.program_of(case.suite), 3600, programs, MPM_MUTANTS=str(listed),
                 MPM_MUTANTS_ENDED=str(ended), MPM_MUTANTS_AT_ONCE=str(jobs), MPM_MUTANT_SECONDS=str(10 * math.ceil(case.seconds) + 5))  # fmt: skip
        if not ended.is_file():  # it makes no scene of the device
            return self.killed_one_by_one(case, numbers)
        statuses = dict(map(int, line.split()) for line in ended.read_text().splitlines())
        if statuses.get(0) != 0:
            self.say(f"mutation: {case.name} ({case.title}) fails on the unchanged program where processes share its beginning")
            return {}, []
        signals = {n: os.WTERMSIG(status) for n, status in statuses.items() if os.WIFSIGNALED(status)}
        # One that has slept too long may have met a machine with much to do.
        killed = {n: Result.TIMED_OUT if signals.get(n) in (signal.SIGXCPU, signal.SIGKILL) else Result.KILLED
                  for n, status in statuses.items() if status != 0 and signals.get(n) != signal.SIGALRM}  # fmt: skip
        return killed, [n for n in numbers if statuses.get(n) == 0]

    def killed_one_by_one(self, case, numbers):
        killed = {}
        for number in numbers:
            code = self.run(case, self.program_of(case.suite), 10 * case.seconds + 5, self.programs_of_mutant(), MPM_MUTANT=str(number))
            if code != 0:
                killed[number] = Result.TIMED_OUT if code is None else Result.KILLED
        return killed, [number for number in numbers if number not in killed]

    def result_alone(self, mutant):
        objects = [name for name in self.chosen_objects({mutant.file}) if not self.build.test_of(name)]
        if not objects or len(objects) > self.alone or mutant.file in self.kernels:  # without one the program would be the unchanged one
            return None
        overlay = self.own("overlay")
        self.write_texts(overlay, {mutant.file: mutant.applied(self.texts[mutant.file].text)})
        changed = {}
        for number, name in enumerate(objects):
            out = self.own(f"alone_{number}").with_suffix(".o")
            changed[name] = str(out)
            if self.compile(name, out, overlay) is not None:
                return Result(Result.UNCOMPILED)
        programs = {}

        def program_of(suite):
            if suite not in programs:
                programs[suite] = self.program_of(suite, changed)
            return programs[suite]

        return self.tried(mutant, 0, program_of, None)

    def near(self, mutant):
        """The noted expressions nearest to a mutant that is compiled alone and noted nowhere: a case that comes to one of
        them most likely comes to it."""
        held = set(self.texts[mutant.file].numbers())
        noted = [(abs(other.line - mutant.line), self.noted_as[n]) for other, n in self.number_of.items()
                 if n in held and n in self.noted_as]  # fmt: skip
        least = min((distance for distance, _ in noted), default=0)
        return {number for distance, number in noted if distance == least}

    def namesakes(self, mutant):
        """The few cases whose names share the rarest words with a mutant's line, by the words' first letters: a line about
        melting, which every case comes to, is wrong in those alone where something melts."""
        words = {word[:5].lower() for word in re.findall(r"[A-Za-z]{4,}", mutant.code)}
        scores = Counter()
        for word in words:
            having = [case for case in self.cases if word in f"{case.name} {case.title}".lower()]
            for case in having:
                scores[case] += 1 / len(having)
        return {case for case, score in scores.most_common(4) if score > 0.02}

    def tried(self, mutant, number, program_of, noted):
        near, namesakes = self.near(mutant) if noted is None else set(), self.namesakes(mutant)
        for case in [case for case in self.cases if near and case.usable is None]:
            self.learn_of(case)
        begin, came, programs, passed = self.spent(), 0, self.programs_of_mutant(), Counter()
        left = [case for case in self.cases if case.usable is None or case.usable and (noted is None or noted in case.comes_to)]
        while left:
            case = max(left, key=lambda case: (case.name in self.first, case in namesakes, bool(near & case.comes_to), case.promise(mutant, passed)))
            left.remove(case)
            if case.usable is None:
                before = self.spent()
                self.learn_of(case)
                begin += self.spent() - before
                if not case.usable or noted is not None and noted not in case.comes_to:
                    continue
            came += 1
            most = self.longest if case.broken_off else 3 * case.seconds + 1
            code = self.run(case, program_of(case.suite), most, programs, MPM_MUTANT=str(number))
            if code is None and not case.broken_off:  # a machine with much to do makes processor time longer
                code = self.run(case, program_of(case.suite), 4 * most, programs, MPM_MUTANT=str(number))
            if code is None and case.broken_off:
                code = 0
            case.note(mutant, code != 0)
            passed[case.title] += 1
            if code != 0:
                return Result(Result.TIMED_OUT if code is None else Result.KILLED, case.name, case.title)
            if self.spent() - begin > self.patience:
                return Result(Result.SURVIVED, check=f"by {came} cases, {len(left)} not tried")
        return Result(Result.SURVIVED, check=f"by {came} cases, all of those chosen that come to it" if came else "no case comes to it")


sharer = None  # the group that the processes of results() share


def side_by_side(jobs, function, places):
    """What a function answers, as it comes, from so many processes that begin with what is known now."""
    with ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("fork")) as pool:
        try:
            for answer in as_completed([pool.submit(function, place) for place in places]):
                yield answer.result()
        except BrokenProcessPool as broken:
            raise BuildFailed("a process that tried mutants has ended, perhaps for want of memory; --resume goes on") from broken
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def look(place):
    return place, sharer.look_at(sharer.cases[place])


def try_one(place):
    return place, sharer.result(sharer.mutants[place])
