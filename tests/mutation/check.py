#!/usr/bin/env python3
"""Checks of the script that makes mutants: what it finds in a text, and that it finds its way in every file."""

import sys
import tempfile
import threading
import unittest
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import page
from build import Build
from group import COMPILING, KINDS, Case, Group, in_overlay
from mutants import mutants_of, tokens_of
from programs import InPrograms, change_of, changed_composition, section_of
from results import Equivalents, Result, Results
from together import Together

ROOT = Path(__file__).resolve().parents[2]


def changes(text):
    return [mutant.what for mutant in mutants_of("file.hpp", text + "\n")]


class FindsMutants(unittest.TestCase):
    def test_comparison_in_a_template_argument(self):
        text = "v = shuffled<[](int lane) { return lane < half ? lane : width + lane; }>(a, b) + c;"
        self.assertEqual([token.text for token in tokens_of(text)],
                         ["v", "=", "shuffled", "(", "a", ",", "b", ")", "+", "c", ";"])  # fmt: skip
        self.assertEqual(changes(text), ["drop v =", "+ to -", "drop + c"])

    def test_a_string_of_many_lines_is_no_code(self):
        self.assertEqual(changes('f(R"(a - b\nsum_{j<m}" c - d)", e - g);'), ["- to +", "drop - g"])

    def test_call_in_a_template_argument(self):
        self.assertEqual(changes("f(halves<wide(a < b)>(c), d - e);"), ["- to +", "drop - e"])

    def test_template_arguments_in_one_another(self):
        self.assertEqual(changes("f(A<B<C<3>>, 2>(), d - e);"), ["- to +", "drop - e"])

    def test_template_parameters_of_a_lambda(self):
        self.assertEqual(changes("auto part = [&]<int i>(N<i>) { return a > b; };"), ["> to <="])

    def test_a_declared_function_is_no_call(self):
        self.assertEqual(changes("float abs(float x) {\n  return abs(x);\n}\nA operator-(A a);\nx = y + min(a, b);"),
                         ["drop abs", "drop x =", "+ to -", "drop + min(a, b)", "min to max"])  # fmt: skip

    def test_a_declared_reference_is_no_assignment(self):
        self.assertEqual(changes("struct S {\n  Field& mass_ = field(mass);\n  void f() { x = y; }\n};"), ["drop x ="])

    def test_what_is_default_or_returned_is_no_assignment(self):
        text = "struct S {\n  S() = default;\n  S& operator+=(S b) { return *this = *this + b; }\n};"
        self.assertEqual(changes(text), ["+ to -", "drop + b"])

    def test_operators_are_no_brackets(self):
        text = "bool operator<(A a, A b) { return a.v < b.v; }\nbool operator>(A a, A b) { return a.v > b.v; }"
        self.assertEqual(changes(text), ["< to >=", "> to <="])

    def test_brackets_that_never_close_are_refused(self):
        with self.assertRaises(ValueError):
            changes("f(A<B(c), d - e);")


class KnowsObjects(unittest.TestCase):
    def test_a_material_is_one_plugin_of_two_objects(self):
        names = [f"modules/CMakeFiles/material_damage{part}.dir/materials/damage/damage.cpp.o" for part in ("", "_second_part")]
        self.assertEqual([Build.plugin_of(None, name) for name in names], ["material_damage"] * 2)


class TriesTheDevice(unittest.TestCase):
    def test_files_that_are_compiled_as_one_are_taken_from_the_overlay(self):
        with tempfile.TemporaryDirectory() as folder:
            tree, overlay = Path(folder) / "tree", Path(folder) / "overlay"
            (overlay / "modules").mkdir(parents=True)
            (overlay / "modules/changed.cpp").touch()
            listed = f'#include "{tree}/modules/changed.cpp"\n#include "{tree}/modules/other.cpp"\n#include <map>\n'
            self.assertEqual(in_overlay(listed, tree, overlay),
                             listed.replace(f"{tree}/modules/changed.cpp", f"{overlay}/modules/changed.cpp"))  # fmt: skip

    def looked_at(self, runs):
        """What is learnt of a case with these runs, each (processor time, programs that it compiles, exit code), and how
        long each may take."""
        group, left, spent, most = Group.__new__(Group), list(runs), [0], []
        with tempfile.TemporaryDirectory() as folder:
            group.longest, group.of_the_device, group.mutants = 5, True, []
            group.programs_kept, kept = Path(folder), Path(folder) / "programs"
            kept.mkdir()
            group.own, group.program_of = lambda name: Path(folder) / name, lambda suite: None
            group.spent, group.compositions_refuse = lambda: spent[0], lambda: False

            def run(case, program, seconds, *_, **__):
                taken, compiled, code = left.pop(0)
                spent[0] += taken
                most.append(seconds)
                for _ in range(compiled):
                    (kept / str(group.count_programs())).touch()
                return code

            group.run = run
            learnt = group.look_at(Case("device", "file", "title", "text"))
        self.assertEqual(left, [])
        return (learnt["seconds"], learnt["usable"], learnt["broken_off"]), most

    def test_a_case_is_timed_without_the_compiler_of_its_programs(self):
        self.assertEqual(self.looked_at([(20, 3, 0), (0.5, 0, 0)]), ((0.5, True, False), [5 + COMPILING] * 2))

    def test_a_long_case_is_broken_off_after_its_programs_are_compiled(self):
        self.assertEqual(self.looked_at([(20, 3, 0), (9, 0, 0), (5, 0, None)]),
                         ((5, True, True), [5 + COMPILING, 5 + COMPILING, 5]))  # fmt: skip


class FindsStaleReasons(unittest.TestCase):
    def test_one_of_two_lines_with_the_same_text_may_be_killed(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "equivalent.txt"
            path.write_text("file: modules/kernel/file.hpp\nline: x = a + b;\nchange: + to -\nreason: b is zero.\n")
            equivalents, results = Equivalents(path), Results(Path(folder) / "results.json")
            first, second = (m for m in mutants_of("modules/kernel/file.hpp", "x = a + b;\nx = a + b;\n") if m.what == "+ to -")
            results.put(first, Result(Result.SURVIVED))
            results.put(second, Result(Result.KILLED, "conformance.any"))
            self.assertEqual(list(equivalents.stale([first, second], results)), [])
            results.put(first, Result(Result.KILLED, "conformance.any"))
            self.assertEqual(len(list(equivalents.stale([first, second], results))), 2)


class WritesThePage(unittest.TestCase):
    OLD = """
| `modules/filters` | 5 | 4 | 0 | 0 | 1 | 0 | 2026-11-27 |
| `modules/shapes` | 807 | 806 | 0 | 0 | 1 | 0 | 2026-11-27 |

- `modules/filters/a/a.hpp:1:+ to -`: `x = a + b;` (all quick tests)
- `modules/shapes/b/b.hpp:2:+ to -`: `y = a + b;` (all quick tests)
"""

    def test_rows_of_what_was_tried_here_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "equivalent.txt"
            path.write_text("file: modules/filters/a/a.hpp\nline: x = a + b;\nchange: drop + b\nreason: b is zero.\n")
            results = Results(Path(folder) / "results.json")
            mutants = mutants_of("modules/filters/a/a.hpp", "x = a + b;\nz = 2 * a;\n")
            became = {"drop x =": Result.KILLED, "drop + b": Result.SURVIVED, "drop * a": Result.SURVIVED,
                      "drop z =": Result.TIMED_OUT, "2 to 1": Result.UNCOMPILED}  # fmt: skip
            for mutant in mutants:
                if mutant.what in became:
                    results.put(mutant, Result(became[mutant.what]))
            date = results.dates["modules/filters"]
            text = page.written(self.OLD, mutants, results, Equivalents(path))
        self.assertEqual(text.split("\n")[2:],
                         [f"| `modules/filters` | 6 | 2 | 1 | 1 | 1 | 1 | {date} |",
                          "| `modules/shapes` | 807 | 806 | 0 | 0 | 1 | 0 | 2026-11-27 |", "", "Passed without a reason:", "",
                          "- `modules/filters/a/a.hpp:2:drop * a`: `z = 2 * a;` (all quick tests)",
                          "- `modules/shapes/b/b.hpp:2:+ to -`: `y = a + b;` (all quick tests)"])  # fmt: skip

    def test_a_folder_that_nobody_has_tried_has_a_row(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "equivalent.txt"
            path.write_text("file: modules/detections/a/a.hpp\nline: x = a + b;\nchange: drop + b\nreason: b is zero.\n")
            mutants = mutants_of("modules/detections/a/a.hpp", "x = a + b;\n")
            text = page.written(self.OLD, mutants, Results(Path(folder) / "results.json"), Equivalents(path))
        self.assertEqual(text.split("\n")[2:5],
                         ["| `modules/filters` | 5 | 4 | 0 | 0 | 1 | 0 | 2026-11-27 |",
                          "| `modules/shapes` | 807 | 806 | 0 | 0 | 1 | 0 | 2026-11-27 |",
                          "| `modules/detections` | 3 | 0 | 0 | 1 | 0 | 2 |  |"])  # fmt: skip

    def test_what_a_new_work_folder_has_not_tried_stays_as_it_was(self):
        old = """
| `modules/filters` | 11 | 6 | 1 | 0 | 3 | 1 | 2026-11-27 |

- `modules/filters/a/a.hpp:3:drop + b`: `y = a + b;` (by 2 cases, all that come to it)
- `modules/filters/a/a.hpp:4:drop z =`: `z = c - d;` (no case comes to it)
- `modules/filters/a/a.hpp:4:- to +`: `z = c - d;` (no case comes to it)
"""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "equivalent.txt"
            path.write_text("file: modules/filters/a/a.hpp\nline: z = c - d;\nchange: - to +\nreason: d is zero.\n")
            results = Results(Path(folder) / "results.json")
            mutants = mutants_of("modules/filters/a/a.hpp", "x = a + b;\ny = a + b;\nz = c - d;\nw = 2 * a;\n")
            became = {(3, "drop z ="): Result.KILLED, (4, "drop * a"): Result.SURVIVED}
            for mutant in mutants:
                if (mutant.line, mutant.what) in became:
                    results.put(mutant, Result(became[mutant.line, mutant.what]))
            date = results.dates["modules/filters"]
            text = page.written(old, mutants, results, Equivalents(path))
        # 12 mutants: killed are those that are neither without a program (1), with a reason, listed nor not tried (1).
        self.assertEqual(len(mutants), 12)
        self.assertEqual(text.split("\n")[2:],
                         [f"| `modules/filters` | 12 | 7 | 1 | 1 | 2 | 1 | {date} |", "", "Passed without a reason:", "",
                          "- `modules/filters/a/a.hpp:2:drop + b`: `y = a + b;` (by 2 cases, all that come to it)",
                          "- `modules/filters/a/a.hpp:4:drop * a`: `w = 2 * a;` (all quick tests)"])  # fmt: skip

    def test_kernels_of_the_device_are_counted_apart(self):
        names = ("modules/backends/device/kernels/sums.hpp", "modules/backends/device/loads.cpp")
        rows = [page.row_of(mutants_of(name, "x = a;\n")[0]) for name in names]
        self.assertEqual(rows, ["modules/backends/device/kernels", "modules/backends/device"])

    def test_the_page_adds_up(self):
        text = (ROOT / "docs/design/mutation.md").read_text()
        rows = [line[2:-2].split(" | ") for line in text.split("\n") if line.startswith("| `modules/")]
        self.assertTrue(rows)
        for folder, mutants, *parts, _ in rows:
            self.assertEqual(int(mutants), sum(map(int, parts)), folder)


class ChangesPrograms(unittest.TestCase):
    TEXT = "#pragma once\n#include \"kernel/a.hpp\"\n\ninline constexpr int places = 3 * 2;\nint f() {\n  return 1 +\n         places;\n}\n"
    FILE = "modules/kernel/b.hpp"
    COMPOSED = ('#line 1 "kernel/a.hpp"\ninline constexpr int places = 3 * 2;\n\n#line 1 "kernel/b.hpp"\n\n\n\n'
                "inline constexpr int places = 3 * 2;\nint f() {\n  return 1 +\n         places;\n}\n#line 1 \"c\"\n")  # fmt: skip

    def changed(self, what, composed=COMPOSED):
        mutant = next(m for m in mutants_of(self.FILE, self.TEXT) if m.what == what)
        return changed_composition(composed, change_of(mutant, self.TEXT))

    def test_a_line_of_its_own_file_alone(self):
        old, new = "int places = 3 * 2;\nint f", "int places = 6 * 2;\nint f"
        self.assertEqual(self.changed("3 to 6"), self.COMPOSED.replace(old, new))

    def test_a_change_of_two_lines(self):
        changed = self.changed("drop + places")
        self.assertNotIn("places;\n}", changed)
        self.assertEqual(changed.split("int f()")[0], self.COMPOSED.split("int f()")[0])
        self.assertTrue(changed.endswith('}\n#line 1 "c"\n'))

    def test_a_composition_without_the_file_or_the_line(self):
        self.assertIsNone(self.changed("3 to 6", self.COMPOSED.replace("b.hpp", "d.hpp")))
        self.assertIsNone(self.changed("3 to 6", self.COMPOSED.replace("3 * 2;\nint f", "3;\nint f")))

    def result_of(self, *runs, patience=100):
        """What becomes of a mutant in cases that each end so: exit code and what the compiler noted."""
        alone = InPrograms.__new__(InPrograms)
        alone.patience, alone.first, alone.lock, ended = patience, (), threading.Lock(), iter(runs)
        alone.cases = [Case("device", "file", str(number), "") for number, _ in enumerate(runs)]
        for case in alone.cases:
            case.learn({"seconds": 1, "usable": True, "broken_off": False, "comes_to": [section_of(self.FILE)]})
        alone.run = lambda *_: (lambda code, notes: (code, Counter(notes), 60, set()))(*next(ended))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / self.FILE
            path.parent.mkdir(parents=True)
            path.write_text(self.TEXT)
            alone.build = SimpleNamespace(tree=Path(folder))
            result = alone.result(mutants_of(self.FILE, self.TEXT)[0])
        return result and result.status

    def test_what_became_of_one_that_is_tried_alone(self):
        same, changed = ["same"], ["changed"]
        self.assertEqual(self.result_of((0, same), (1, changed)), Result.KILLED)
        self.assertEqual(self.result_of((0, changed), (None, changed)), Result.TIMED_OUT)
        self.assertEqual(self.result_of((0, same), (0, changed)), Result.SURVIVED)
        self.assertEqual(self.result_of((0, same), (0, same)), Result.SAME_CODE)
        self.assertEqual(self.result_of((0, same), (1, ["refused"])), Result.UNCOMPILED)
        self.assertEqual(self.result_of((1, same), (0, same)), Result.SAME_CODE)  # it fails for another reason
        self.assertIsNone(self.result_of((0, same), (0, same), (0, same), patience=100))  # one is left that might be changed

    def test_what_the_composer_calls_a_file(self):
        self.assertEqual(section_of("modules/materials/snow/snow.hpp"), "material plugin snow")
        self.assertEqual(section_of("modules/operators/heat.hpp"), "operators/heat.hpp")


class WritesThemTogether(unittest.TestCase):
    def test_each_by_its_number(self):
        text = "#pragma once\nx = a + b;\n"
        mutants = mutants_of("file.hpp", text)
        together = Together(text, mutants, first=7)
        self.assertEqual(together.numbers(), [7, 8, 9])
        for number in together.numbers():
            self.assertIn(f"mpm_mutant == {number} ?", together.written())
        self.assertTrue(together.refuse("mutant_8:1:3: error: not usable in a constant expression\n"))
        self.assertFalse(together.refuse("mutant_8:1:3: error: the same once more\n"))
        self.assertEqual(together.numbers(), [7, 9])
        self.assertNotIn("mpm_mutant == 8 ?", together.written())
        self.assertTrue(together.refuse("unchanged_8:1:3: error: not an integer constant\n"))
        self.assertEqual(together.numbers(), [7])

    def test_a_refused_one_leaves_the_others_of_its_expression(self):
        together = Together("#pragma once\nx = a + b;\n", mutants_of("file.hpp", "#pragma once\nx = a + b;\n"), first=7)
        self.assertTrue(together.refuse("mutant_8:1:3: error: no match\nunchanged_8:1:3: error: no match\n"))
        self.assertEqual(together.numbers(), [7, 9])

    def test_what_stands_behind_the_head_of_a_loop(self):
        text = "for (int i = 0; i < n; ++i) x[i] += y;\nif (a < b)\n  x -= f(c);\nelse\n  x *= 2;\n"
        mutants = mutants_of("file.hpp", text)
        spans = Together(text, mutants).spans
        whole = {text[begin:end] for begin, end in spans}
        self.assertLessEqual({"x[i] += y", "x -= f(c)"}, whole)

    def test_constants_are_not_among_them(self):
        text = """constexpr int size = D + 1;
constexpr int f(int x) { return x - 1; }
if constexpr (D == 3) x = a ? b : c * d;
constexpr auto source = [](int i) { return i + 1; };
"""
        together = Together(text, mutants_of("file.hpp", text))
        together.refuse_constants()
        left = [together.mutants[number - 1].what for number in together.numbers()]
        self.assertEqual(left, ["- to +", "drop - 1", "1 to 2", "drop x =", "drop * d"])

    def test_the_inner_one_of_two_assignments_is_not_among_them(self):
        text = "x = y = a;\n"
        together = Together(text, mutants_of("file.hpp", text))
        self.assertEqual([together.mutants[number - 1].what for number in together.numbers()], ["drop x ="])

    def test_an_expression_is_noted_by_one_number(self):
        text = "x = f(a + b) * c;\n"
        together = Together(text, mutants_of("file.hpp", text))
        for number, noted in together.expression_of().items():
            self.assertIn(f"mpm_come_to({noted})", together.written(), number)

    def test_every_file_of_the_backends_and_what_they_share(self):
        for path in [path for kind in KINDS for path in (ROOT / "modules" / kind).rglob("*.[hc]pp")]:
            with self.subTest(path.relative_to(ROOT).as_posix()):
                text = path.read_text()
                Together(text, mutants_of(path.name, text)).written()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])  # the test of ctest names the source folder
