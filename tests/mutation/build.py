"""The build of the unchanged program in the work folder: which commands make which object of which source, which
objects depend on a file, and which tests there are and how long they take."""

import hashlib
import json
import math
import os
import re
import resource
import shlex
import subprocess
from dataclasses import dataclass
from pathlib import Path

SUITES = ["conformance", "config", "unit", "parity", "verification"]  # those that try plugins


class BuildFailed(Exception):
    pass


@dataclass(frozen=True)
class Test:
    """The quick cases of one file of a suite, an entry of ctest."""

    suite: str
    file: str
    seconds: float
    text: str

    @property
    def name(self):
        return f"{self.suite}.{self.file}"

    @property
    def program(self):
        return f"test_{self.suite}"

    @property
    def call(self):
        return ["-#", f"[#{self.file}]~[slow]", "--abort"]


class Build:
    def __init__(self, tree, folder, work, longest, say, suites=()):
        """`suites` are wanted beside those that try plugins."""
        self.tree, self.folder, self.work, self.longest, self.say = tree, folder, work, longest, say
        self.wanted = [*SUITES, *(suite for suite in suites if suite not in SUITES)]

    # ---- what cmake and ninja know -----------------------------------------------------------------------------

    def make(self):
        self.say("mutation: building the unchanged program in", self.folder)
        if not (self.folder / "build.ninja").is_file():
            self.must("cmake", "-S", self.tree, "-B", self.folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                      "-DMPM_FILES_TOGETHER=1")  # a mutant is an object of its own
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL")
        targets = ["mpm_sandbox", "plugins", *(f"test_{suite}" for suite in self.wanted)]
        self.must("ninja", "-C", self.folder, *(["-j", jobs] if jobs else []), *targets)

    def read(self, may_be_together=False):
        """Learns what there is. Mutants of the device alone may be tried in a build that compiles several files as one."""
        cache = (self.folder / "CMakeCache.txt").read_text()
        if "MPM_FILES_TOGETHER:STRING=1\n" not in cache and not may_be_together:
            raise BuildFailed(f"{self.folder} compiles several files as one: configure it with -DMPM_FILES_TOGETHER=1")
        self.compile_of = {}
        for entry in json.loads((self.folder / "compile_commands.json").read_text()):
            words = shlex.split(entry["command"])
            self.compile_of[words[words.index("-o") + 1]] = words
        self.source_of = {name: words[words.index("-c") + 1] for name, words in self.compile_of.items()}
        self.read_dependencies()
        self.suites = [suite for suite in self.wanted if (self.folder / f"bin/test_{suite}").is_file()]
        if self.suites != self.wanted:
            self.say("mutation: only the suites", *self.suites, "are built and tried")
        programs = ["mpm", *(f"test_{suite}" for suite in self.suites)]
        self.links = {program: self.link_of(f"bin/{program}") for program in programs}

    def must(self, *command):
        words = [str(word) for word in command]
        ended = subprocess.run(words, cwd=self.work, capture_output=True, text=True)
        if ended.returncode != 0:
            raise BuildFailed(f"{shlex.join(words)} failed:\n{ended.stdout[-4000:]}{ended.stderr[-4000:]}")
        return ended.stdout

    def read_dependencies(self):
        """Objects by the file of the tree that they are made from."""
        self.objects_of = {}
        name = None
        for line in self.must("ninja", "-C", self.folder, "-t", "deps").split("\n"):
            if line and not line.startswith(" "):
                name = line.split(": #deps")[0]
            elif line.strip() and name in self.compile_of:
                path = os.path.normpath(self.folder / line.strip())
                self.objects_of.setdefault(os.path.relpath(path, self.tree), set()).add(name)

    def link_of(self, target):
        command = self.must("ninja", "-C", self.folder, "-t", "commands", target).strip().split("\n")[-1]
        return shlex.split(command.removeprefix(": && ").removesuffix(" && :"))

    def plugin_of(self, name):
        """KIND_ID of a plugin's object, of which a material has two; none for another object."""
        found = re.match(r"modules/CMakeFiles/(\w+?)(?:_second_part)?\.dir/", name)
        return found and found[1]

    def test_of(self, name):
        """(suite, file) of a test's object; none for another object."""
        found = re.match(r"tests/CMakeFiles/test_(\w+)\.dir/(?:together/)?\w+/(\w+)\.cpp\.o", name)
        return found and (found[1], found[2])

    def files_together(self, name):
        """The files that an object is compiled from as one; none where it has a source of its own."""
        if "/together/" not in name:
            return []
        text = (self.folder / self.source_of[name]).read_text()
        return [Path(file) for file in re.findall(r'(?m)^#include "(/[^"]+\.cpp)"', text)]

    # ---- tests -------------------------------------------------------------------------------------------------

    def read_tests(self):
        """The quick tests and the processor time that each takes on the unchanged program: runs those never timed."""
        kept = self.work / "times.json"
        times = json.loads(kept.read_text()) if kept.is_file() else {}
        self.tests = []
        for suite in [suite for suite in self.suites if suite in SUITES]:
            for path in sorted((self.tree / "tests" / suite).glob("*.cpp")):
                text = path.read_text()
                if text.count("TEST_CASE") <= text.count("[slow]"):
                    continue
                test = Test(suite, path.stem, 0, text)
                key = f"{test.name} {hash_of(text)}"
                if key not in times:
                    times[key] = self.time_of(test)
                    kept.write_text(json.dumps(times, indent=1))
                if times[key] <= self.longest:
                    self.tests.append(Test(suite, path.stem, times[key], text))

    def time_of(self, test):
        """Processor time in seconds; without end where it takes more than --longest."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        ended = subprocess.run([self.folder / "bin" / test.program, *test.call], cwd=self.folder, env=environment(),
                               capture_output=True, text=True, preexec_fn=limited_to(self.longest))  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken = round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 2)
        if ended.returncode < 0 and taken > 0.9 * self.longest:
            return 1e9
        if "No tests ran" in ended.stdout:
            raise BuildFailed(f"{test.program} has no case of {test.file}: it is older than the tree")
        if ended.returncode != 0:
            raise BuildFailed(f"{test.name} fails on the unchanged program:\n{ended.stdout[-4000:]}")
        return taken


def limited_to(seconds):
    """What a process does before it starts, so that it is ended when it has taken this much processor time."""
    most = max(1, math.ceil(seconds))
    return lambda: resource.setrlimit(resource.RLIMIT_CPU, (most, most))


def hash_of(text):
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def environment():
    """As tests/CMakeLists.txt has it."""
    kept = {k: v for k, v in os.environ.items() if k not in ("MPM_PLUGIN_PATH", "MPM_BUILD_DIR")}
    return {**kept, "OMP_WAIT_POLICY": "passive"}
