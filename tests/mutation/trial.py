"""One mutant: the objects that it changes are compiled with the changed file in a folder that the compiler searches
first, linked with all others of the unchanged build, and run."""

import os
import re
import shutil
import signal
import subprocess
import threading
from pathlib import Path

from build import environment, limited_to
from results import Result
from together import Together

FIRST_LOOK = "-O1"  # checks of the plugin alone run on a build that is made faster
NOT_LOOKED = Result(Result.SURVIVED, check="no test but test-plugin was tried")
SLACK = 10  # times the processor time of a test on the unchanged program, after which it hangs


class Bench:
    """A folder with programs and plugins of its own, as a build folder has them, and processes that can be stopped."""

    running, lock = set(), threading.Lock()

    def __init__(self, build, folder):
        self.build, self.folder = build, folder
        shutil.rmtree(folder, ignore_errors=True)
        for name in ("bin", "plugins", "overlay", "objects"):
            (folder / name).mkdir(parents=True)
        for program in build.links:
            shutil.copy2(build.folder / "bin" / program, folder / "bin" / program)
        for plugin in (build.folder / "plugins").glob("*.so"):
            (folder / "plugins" / plugin.name).symlink_to(plugin)

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
        process = subprocess.Popen([str(w) for w in words], cwd=self.build.folder, text=True, errors="replace",
                                   env={**environment(), **variables}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   start_new_session=True, preexec_fn=limited_to(seconds))  # fmt: skip
        with Bench.lock:
            Bench.running.add(process.pid)
        try:
            output, _ = process.communicate(timeout=60 * seconds)  # what sleeps takes no processor time
            return None if process.returncode in (-signal.SIGKILL, -signal.SIGXCPU) else process.returncode, output
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return None, ""
        finally:
            with Bench.lock:
                Bench.running.discard(process.pid)

    @classmethod
    def stop_all(cls):
        with cls.lock:
            for pid in cls.running:
                os.killpg(pid, signal.SIGKILL)


class Trial:
    """`together` is a plugin that holds the mutant as one of many, and its number there; none where it does not."""

    def __init__(self, build, bench, mutant, together=None):
        self.build, self.bench, self.mutant, self.together = build, bench, mutant, together
        self.objects = build.objects_of.get(mutant.file, set())
        self.plugins = sorted(name for name in self.objects if build.plugin_of(name))
        self.libraries = sorted(n for n in self.objects if not build.plugin_of(n) and not build.test_of(n))
        self.tests = {build.test_of(name): name for name in self.objects if build.test_of(name)}

    def result(self, first_look=False):
        if self.together and (verdict := self.look_at_plugins()):
            return verdict
        self.bench.clear([self.build.plugin_of(name) for name in self.plugins])
        mutated = self.bench.folder / "overlay/modules" / Path(self.mutant.file).relative_to("modules")
        # Its neighbours come along: sources beside a header include it by its name alone.
        shutil.copytree((self.build.tree / self.mutant.file).parent, mutated.parent)
        mutated.write_text(self.mutant.applied((self.build.tree / self.mutant.file).read_text()))
        try:
            looked = None if self.together else self.look_at_plugins()
            return looked or (NOT_LOOKED if first_look else self.look_for_same_code() or self.look_at_tests())
        except Refused:
            return Result(Result.UNCOMPILED)

    # ---- compiling ---------------------------------------------------------------------------------------------

    def compiled(self, name, *flags, text=None):
        """The object made with the changed file; `text` is what the plugin carries of its functor."""
        out = self.bench.folder / "objects" / (name.replace("/", "_") + "".join(flags) + (".carries" if text else ""))
        if out.exists():
            return out
        words = [word for word in self.build.compile_of[name] if word != "-Werror"]
        source = self.build.source_of[name]
        own = self.bench.folder / "overlay" / os.path.relpath(source, self.build.tree)
        words[words.index("-o") + 1] = str(out)
        words[words.index("-c") + 1] = str(own) if own.is_file() else source
        words.insert(1, f"-I{self.bench.folder / 'overlay/modules'}")
        if text:
            words = [w if "MPM_EMBEDDED_SOURCE" not in w else f'-DMPM_EMBEDDED_SOURCE="{text}"' for w in words]
        code, output = self.bench.run([*words, "-w", *flags], 600)
        if code != 0:
            raise Refused(output)
        return out

    def plugin_made(self, name, *flags):
        """Puts the changed plugin, which carries the changed text, in the place of the unchanged one."""
        plugin = self.build.plugin_of(name)
        text = None
        if self.mutant.file.endswith(f"/{plugin.partition('_')[2]}.hpp"):
            text = self.bench.folder / "objects" / f"{plugin}.inc"
            changed = self.mutant.applied((self.build.tree / self.mutant.file).read_text())
            text.write_text(f'R"MPM_SOURCE({changed})MPM_SOURCE"\n')
        out = self.bench.folder / "plugins" / f"{plugin}.so"
        return self.linked(out, self.compiled(name, *flags, text=text))

    def linked(self, plugin, made):
        plugin.unlink(missing_ok=True)
        code, output = self.bench.run([self.build.compile_of[next(iter(self.plugins))][0], "-shared", "-o", plugin, made], 100)
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
        """The result where the checks of a plugin fail."""
        code, output = self.bench.run([mpm, "test-plugin", "--seconds", "600", plugin], 60, MPM_MUTANT=str(number))
        if code == 0:
            return None
        failed = re.search(r"FAILED (\w+)", output)
        kind = Result.TIMED_OUT if code is None else Result.KILLED
        return Result(kind, "test-plugin", failed[1] if failed else output.strip().split("\n")[0][:60])

    def look_at_plugins(self):
        if self.together:
            return self.verdict_on(self.together[0], self.bench.folder / "bin/mpm", self.together[1])
        for name in self.plugins:
            plugin = self.plugin_made(name, FIRST_LOOK)
            verdict = self.verdict_on(plugin, self.program_with("mpm", self.libraries))
            if verdict:
                return verdict
        return None

    def look_for_same_code(self):
        """The same instructions from both, with the same text of the functor in the plugin."""
        for name in self.objects:
            if self.build.test_of(name) and self.plugins:
                continue
            if self.compiled(name).read_bytes() != (self.build.folder / name).read_bytes():
                return None
        return Result(Result.SAME_CODE)

    def look_at_tests(self):
        for name in self.plugins:
            self.plugin_made(name)
        for test in self.ordered_tests():
            first = self.libraries + ([self.tests[test.suite, test.file]] if (test.suite, test.file) in self.tests else [])
            program = self.program_with(test.program, first)
            code, output = self.bench.run([program, *test.call], SLACK * test.seconds + 5)
            if code != 0:
                return Result(Result.TIMED_OUT if code is None else Result.KILLED, test.name)
        return Result(Result.SURVIVED)

    def ordered_tests(self):
        """Tests that know the changed file first, then those that name the plugin, then all others; short ones first."""
        ids = [self.build.plugin_of(name).partition("_")[2] for name in self.plugins]

        def place(test):
            knows = (test.suite, test.file) in self.tests
            named = any(f'"{id}' in test.text for id in ids)
            return (not knows, not named, test.seconds)

        useful = self.build.tests
        if self.plugins and not self.libraries:
            # What `mpm test-plugin` has done, what tests the checks themselves, and what knows no plugin.
            useful = [t for t in useful if t.name not in ("conformance.every_plugin", "conformance.wrong_plugins")]
            useful = [t for t in useful if t.suite != "unit" or (t.suite, t.file) in self.tests]
        return sorted(useful, key=place)


def plugin_together(build, bench, file, mutants):
    """(plugin, numbers of the mutants that it holds by mutant) of a functor's file; none where that cannot be made."""
    objects = [name for name in build.objects_of.get(file, ()) if not build.test_of(name)]
    if len(objects) != 1 or not build.plugin_of(objects[0]):
        return None
    text = (build.tree / file).read_text()
    together = Together(text, mutants)
    trial = Trial(build, bench, mutants[0])
    for _ in range(6):
        bench.clear([])
        changed = bench.folder / "overlay" / file
        changed.parent.parent.mkdir(parents=True)
        shutil.copytree((build.tree / file).parent, changed.parent)
        changed.write_text(together.written())
        try:
            out = bench.folder / f"{build.plugin_of(objects[0])}_together.so"
            trial.linked(out, trial.compiled(objects[0], FIRST_LOOK))
        except Refused as refusal:
            if together.refuse(str(refusal)):
                continue
            return None
        if trial.verdict_on(out, bench.folder / "bin/mpm"):
            return None
        return out, {mutants[number - 1]: number for number in together.numbers()}
    return None


class Refused(Exception):
    """The compiler or the linker refuses the changed text."""
