"""One mutant: the objects that it changes are compiled with the changed file in a folder that the compiler searches
first, linked with all others of the unchanged build, and run."""

import os
import re
import shutil
import signal
import subprocess
import threading
from collections import Counter
from pathlib import Path

from build import environment, limited_to
from results import Result
from together import SWITCH, SWITCH_FILE, Together

FIRST_LOOK = "-O1"  # checks of the plugin alone run on a build that is made faster
# What test-plugin has done already; what tests the checks themselves; what compares a plugin with its own text.
NOT_OF_THE_PROGRAM = ("unit.verification_page",)  # compares pages with the texts of tests
NOT_OF_PLUGINS = ("conformance.every_plugin", "conformance.device_pass")
SLACK = 10  # times the processor time of a test on the unchanged program, after which it hangs


class Bench:
    """A folder with programs and plugins of its own, as a build folder has them, and processes that can be stopped."""

    running, lock, stopped = set(), threading.Lock(), False

    def __init__(self, build, folder):
        self.build, self.folder = build, folder
        shutil.rmtree(folder, ignore_errors=True)
        for name in ("bin", "plugins", "overlay", "objects"):
            (folder / name).mkdir(parents=True)
        for program in build.links:
            shutil.copy2(build.folder / "bin" / program, folder / "bin" / program)
        for plugin in (build.folder / "plugins").glob("*.so"):
            (folder / "plugins" / plugin.name).symlink_to(plugin)
        if (build.folder / "backends").is_dir():
            (folder / "backends").symlink_to(build.folder / "backends")

    def clear(self, changed_plugins):
        for name in ("overlay", "objects"):
            shutil.rmtree(self.folder / name)
            (self.folder / name).mkdir()
        for plugin in changed_plugins:
            path = self.folder / "plugins" / f"{plugin}.so"
            path.unlink(missing_ok=True)
            path.symlink_to(self.build.folder / "plugins" / path.name)

    def run(self, words, seconds, **variables):
        """Exit code and output; no code where it took more processor time. All that it started ends with it."""
        if Bench.stopped:
            raise KeyboardInterrupt
        process = subprocess.Popen([str(w) for w in words], cwd=self.build.folder, text=True, errors="replace",
                                   env={**environment(), **variables}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   start_new_session=True, preexec_fn=limited_to(seconds))  # fmt: skip
        with Bench.lock:
            Bench.running.add(process.pid)
        try:
            output, _ = process.communicate(timeout=15 * seconds + 5)  # what sleeps takes no processor time
            if Bench.stopped:  # it was ended from outside, which says nothing of the mutant
                raise KeyboardInterrupt
            return None if process.returncode in (-signal.SIGKILL, -signal.SIGXCPU) else process.returncode, output
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return None, ""
        except BaseException:  # Ctrl-C: the program has a session of its own
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            raise
        finally:
            with Bench.lock:
                Bench.running.discard(process.pid)

    @classmethod
    def stop_all(cls):
        with cls.lock:
            cls.stopped = True
            for pid in cls.running:
                os.killpg(pid, signal.SIGKILL)


class Trial:
    """A mutant that is compiled alone. `tried` are tests that it is known to pass."""

    def __init__(self, build, bench, mutant, tried=()):
        self.build, self.bench, self.mutant, self.tried = build, bench, mutant, tried
        self.objects = build.objects_of.get(mutant.file, set())
        names = sorted({build.plugin_of(name) for name in self.objects} - {None})
        self.plugins = {name: [part for part in build.compile_of if build.plugin_of(part) == name] for name in names}
        self.libraries = sorted(n for n in self.objects if not build.plugin_of(n) and not build.test_of(n))
        self.tests = {build.test_of(name): name for name in self.objects if build.test_of(name)}

    def result(self):
        self.bench.clear(self.plugins)
        mutated = self.bench.folder / "overlay/modules" / Path(self.mutant.file).relative_to("modules")
        # Its neighbours come along: sources beside a header include it by its name alone.
        shutil.copytree((self.build.tree / self.mutant.file).parent, mutated.parent)
        mutated.write_text(self.mutant.applied((self.build.tree / self.mutant.file).read_text()))
        try:
            return self.look_for_same_code() or self.look_at_plugins() or self.look_at_tests()
        except Refused:
            return Result(Result.UNCOMPILED)

    # ---- compiling ---------------------------------------------------------------------------------------------

    def compiled(self, name, *flags):
        """The object made with the changed file."""
        out = self.bench.folder / "objects" / (name.replace("/", "_") + "".join(flags))
        if out.exists():
            return out
        words = [word for word in self.build.compile_of[name] if word != "-Werror"]
        source = self.build.source_of[name]
        own = self.bench.folder / "overlay" / os.path.relpath(source, self.build.tree)
        words[words.index("-o") + 1] = str(out)
        words[words.index("-c") + 1] = str(own) if own.is_file() else source
        words.insert(1, f"-I{self.bench.folder / 'overlay/modules'}")
        code, output = self.bench.run([*words, "-w", *flags], 600)
        if code != 0:
            raise Refused(output)
        return out

    def plugin_made(self, name, *flags):
        """Puts the changed plugin in the place of the unchanged one."""
        plugin = self.bench.folder / "plugins" / f"{name}.so"
        plugin.unlink(missing_ok=True)
        parts = self.plugins[name]
        made = [self.compiled(part, *flags) if part in self.objects else self.build.folder / part for part in parts]
        code, output = self.bench.run([self.build.compile_of[parts[0]][0], "-shared", "-o", plugin, *made], 100)
        if code != 0:
            raise Refused(output)
        return plugin

    def program_with(self, program, first):
        """A program linked with these objects before all others: what they define is taken from them."""
        if not first:
            return self.bench.folder / "bin" / program
        out = self.bench.folder / "bin" / f"{program}_changed"
        own = {name for name in self.tests.values()}
        words = list(self.build.links[program])
        replaced = {name: str(self.compiled(name)) for name in first}
        words = [replaced.get(word, word) for word in words]
        words[words.index("-o") + 1] = str(out)
        at = 1
        for name in first:
            if name not in own:
                words.insert(at, replaced[name])
        # Functions that several objects define are taken from the first.
        changed = [word for word in words if word in replaced.values()]
        words = [words[0], *changed, *(word for word in words[1:] if word not in changed)]
        code, output = self.bench.run(words, 300)
        if code != 0:
            raise Refused
        return out

    # ---- looks, from the cheapest on ---------------------------------------------------------------------------

    def verdict_on(self, plugin, mpm, number=0):
        """The result where the checks of a plugin fail. Its text for the device is the unchanged one and would always differ."""
        code, output = self.bench.run([mpm, "test-plugin", "--no-device", "--seconds", "600", plugin], 60, MPM_MUTANT=str(number))
        if code == 0:
            return None
        failed = re.search(r"FAILED (\w+)", output)
        kind = Result.TIMED_OUT if code is None else Result.KILLED
        return Result(kind, "test-plugin", failed[1] if failed else output.strip().split("\n")[0][:60])

    def look_at_plugins(self):
        if self.tried:
            return None
        for name in self.plugins:
            plugin = self.plugin_made(name, FIRST_LOOK)
            verdict = self.verdict_on(plugin, self.program_with("mpm", self.libraries))
            if verdict:
                return verdict
        return None

    def look_for_same_code(self):
        """The same instructions from both. (The plugin carries the unchanged text of its functor in either case.)"""
        for name in self.objects:
            if self.build.test_of(name) and self.plugins:
                continue
            if self.compiled(name).read_bytes() != (self.build.folder / name).read_bytes():
                return None
        return Result(Result.SAME_CODE)

    def look_at_tests(self):
        tests = self.ordered_tests()
        for name in self.plugins if tests else []:
            self.plugin_made(name)
        for test in tests:
            first = self.libraries + ([self.tests[test.suite, test.file]] if (test.suite, test.file) in self.tests else [])
            program = self.program_with(test.program, first)
            code, output = self.bench.run([program, *test.call], SLACK * test.seconds + 5)
            if code != 0:
                return Result(Result.TIMED_OUT if code is None else Result.KILLED, test.name)
        return Result(Result.SURVIVED)

    def ordered_tests(self):
        """Tests that know the changed file first, then those that name the plugin, then all others; short ones first.
        Of the others only those that take less than a quarter of --longest."""
        ids = [name.partition("_")[2] for name in self.plugins]

        def place(test):
            named = not ids or any(f'"{id}' in test.text for id in ids)
            return ((test.suite, test.file) not in self.tests, not named, test.seconds)

        useful = [t for t in self.build.tests if t not in self.tried and t.name not in NOT_OF_THE_PROGRAM]
        useful = [t for t in useful if place(t)[:2] != (True, True) or t.seconds <= self.build.longest / 4]
        if self.plugins and not self.libraries:  # few tests of the suite unit load plugins or include them
            useful = [t for t in useful if t.suite != "unit" or (t.suite, t.file) in self.tests or "plugins()" in t.text]
        if self.plugins:
            useful = [t for t in useful if t.name not in NOT_OF_PLUGINS]
        return sorted(useful, key=place)


class Shared:
    """Plugin and test programs of one file that hold most of its mutants, made once. Of a header that more than one
    plugin is made from only the tests that include it are made."""

    def __init__(self, build, folder, file, mutants):
        self.build, self.file, self.bench = build, file, Bench(build, folder)
        self.text = Together((build.tree / file).read_text(), mutants)
        self.trial = Trial(build, self.bench, mutants[0])
        self.plugin, self.programs, self.tests, self.number_of, self.kills = None, {}, [], {}, Counter()
        self.everywhere = len(self.trial.plugins) > 1
        if self.everywhere:
            self.trial.plugins, self.trial.libraries = {}, []
        if self.make_plugin() if self.trial.plugins else self.make_libraries():
            self.make_programs()
            self.number_of = {mutants[number - 1]: number for number in self.text.numbers()}

    def write_text(self):
        self.bench.clear([])
        changed = self.bench.folder / "overlay" / self.file
        changed.parent.parent.mkdir(parents=True)
        shutil.copytree((self.build.tree / self.file).parent, changed.parent)
        changed.write_text(self.text.written())
        (self.bench.folder / "overlay/modules" / SWITCH_FILE).write_text(SWITCH)

    def make_plugin(self):
        """Makes the plugin without the mutants that the compiler refuses here; whether it then does as the program."""
        for _ in range(6):
            self.write_text()
            try:
                self.plugin = self.trial.plugin_made(next(iter(self.trial.plugins)), FIRST_LOOK)
                return self.trial.verdict_on(self.plugin, self.bench.folder / "bin/mpm") is None
            except Refused as refusal:
                if not self.text.refuse(str(refusal)):
                    return False
        return False

    def make_libraries(self):
        """Compiles what is no plugin, without the mutants that the compiler refuses here; whether that went well."""
        for _ in range(6):
            self.write_text()
            try:
                for name in self.trial.libraries or list(self.trial.tests.values()):
                    self.trial.compiled(name)
                return True
            except Refused as refusal:
                if not self.text.refuse(str(refusal)):
                    return False
        return False

    def make_programs(self):
        """Makes the programs of the tests that know the file, and all programs where a library knows it."""
        known = {}
        for test in self.build.tests:
            name = self.trial.tests.get((test.suite, test.file))
            if name and test.name not in NOT_OF_PLUGINS:
                try:
                    self.trial.compiled(name)
                    known.setdefault(test.suite, []).append((test, name))
                except Refused:
                    continue
        for suite in self.build.suites:
            first = self.trial.libraries + [name for _, name in known.get(suite, [])]
            if first:
                self.programs[suite] = self.trial.program_with(f"test_{suite}", first)
        self.tests = [test for test in self.trial.ordered_tests() if self.holds(test, known) and self.passes(test)]
        if self.everywhere:
            self.tests = [test for test in self.tests if (test.suite, test.file) in self.trial.tests]

    def holds(self, test, known):
        return (test.suite, test.file) not in self.trial.tests or test in [held for held, _ in known.get(test.suite, [])]

    def passes(self, test, number=0):
        """Whether a test passes with one of the mutants, 0 for none."""
        return self.outcome(test, number) == 0

    def outcome(self, test, number):
        program = self.programs.get(test.suite, self.bench.folder / "bin" / test.program)
        return self.bench.run([program, *test.call], SLACK * test.seconds + 5, MPM_MUTANT=str(number))[0]

    def result(self, mutant):
        """The first failure with a mutant; none where nothing here fails."""
        number = self.number_of[mutant]
        verdict = self.plugin and self.trial.verdict_on(self.plugin, self.bench.folder / "bin/mpm", number)
        if verdict:
            return verdict
        for test in sorted(self.tests, key=lambda test: -self.kills[test.name]):  # what killed most comes first
            code = self.outcome(test, number)
            if code != 0:
                self.kills[test.name] += 1
                return Result(Result.TIMED_OUT if code is None else Result.KILLED, test.name)
        return Result(Result.SURVIVED) if self.everywhere else None


class Refused(Exception):
    """The compiler or the linker refuses the changed text."""
