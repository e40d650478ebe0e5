"""Executes a page of the docs as a reader would, from top to bottom, and compares what comes out with the page.

    page.py SOURCE PAGE PROGRAM

Executed are its blocks of Python, and its blocks of the shell (sh) that call the program only; ./mpm is then PROGRAM.
A block of text after one of these is what it prints. A block of JSON that begins with the comment "// NAME.json" is
saved as that file. Blocks that import VTK are left out where it is not installed, and that is said.

page_numbers/PAGE.json, where there is one, holds the sentences of the page with a # for each number, and the expression
that gives it: of the page's own names, of those that the lines under "first" make, and of after(WORDS, k), the number that
stands behind these words in what the page prints, for the k-th time. Numbers of the prose that no sentence names are
mistakes; "given" says of which no run decides, and why. "words" are sentences that state a quantity in words, with an
expression that holds where a run decides it; tests/unit/page_numbers.cpp looks for others.
"""

import contextlib
import io
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

LAUNCHER = ("build", "help", "python", "test")  # verbs that the launcher has and the program has not

source, page, program = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
text = (source / page).read_text()
names = {"__name__": "page"}
counts = {"executed": 0, "compared": 0, "saved": 0, "left out": 0}


def has_vtk():
    try:
        import vtkmodules  # noqa: F401
    except ImportError:
        return False
    return True


def run_python(block, line):
    output = io.StringIO()
    # The lines of a traceback are those of the page.
    code = compile("\n" * line + block, page, "exec")
    with contextlib.redirect_stdout(output):
        exec(code, names)
    return output.getvalue()


def run_shell(block, line):
    done = subprocess.run(["bash", "-e", "-c", block], text=True, capture_output=True, check=False)
    assert done.returncode == 0, f"{page}:{line}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def calls_only_the_program(block):
    calls = [line.split() for line in block.splitlines()]
    return all(len(call) > 1 and call[0] == "./mpm" and call[1] not in LAUNCHER for call in calls)


def one_line(words):
    return re.sub(r"\s+", " ", words)


def after(words, k=0):
    """The number behind these words in the blocks of text, which are what the program prints."""
    blocks = " ".join(one_line(block) for block in re.findall(r"^```text\n(.*?)^```", text, flags=re.M | re.S))
    return float(re.findall(re.escape(words) + r"\s*(-?[0-9.]*[0-9])", blocks)[k])


def pattern_of(sentence):
    return re.escape(one_line(sentence)).replace(r"\#", r"(?<![0-9.])(-?[0-9]+(?:\.[0-9]+)?)")


def check_numbers(listed):
    """Compares the numbers of the prose with what gives them. Returns how many there are."""
    prose = one_line(re.sub(r"^```.*?^```", "", text, flags=re.M | re.S))
    for line in listed["first"]:
        exec(line, names)
    names["after"] = after
    left, count = prose, 0
    for sentence in listed["measured"]:
        found = re.findall("(?=" + pattern_of(sentence["says"]) + ")", prose)
        assert len(found) == 1, f"{page}: stands {len(found)} times in the page: {sentence['says']}"
        printed = [] if not sentence["is"] else [found[0]] if isinstance(found[0], str) else list(found[0])
        assert len(printed) == len(sentence["is"]), f"{page}: numbers and expressions of: {sentence['says']}"
        for number, expression in zip(printed, sentence["is"]):
            value, half = float(eval(expression, names)), 0.5 * 10.0 ** -len(number.partition(".")[2])
            assert abs(value - float(number)) <= half * (1 + 1e-9), (
                f"{page}: the page says {number} and {expression} is {value:.6g}: {sentence['says']}")
            count += 1
        left = re.sub(pattern_of(sentence["says"]), "\n", left)
    for sentence in listed.get("words", []):
        assert len(re.findall(pattern_of(sentence["says"]), prose)) == 1, f"{page}: stands not once: {sentence['says']}"
        assert eval(sentence.get("holds", "True"), names), f"{page}: does not hold: {sentence['says']}"
    for group in listed["given"]:
        for sentence in group["says"]:
            assert len(re.findall(pattern_of(sentence), prose)) == 1, f"{page}: stands not once: {sentence}"
            left = re.sub(pattern_of(sentence), "\n", left)
    typed = [r"`[^`]*`", r"!\[[^\]]*\]\([^)]*\)", r"\]\([^)]*\)", r"[Ll]essons? [0-9]"]
    for pattern in typed + listed["names"]:
        left = re.sub(pattern, " ", left)
    nobody = re.findall(r"[^\n]{0,40}[0-9½¾¼][^\n]{0,20}", left)
    assert not nobody, f"{page}: numbers that nothing gives: {nobody}"
    return count


with tempfile.TemporaryDirectory() as folder:
    os.symlink(source / "experiments", pathlib.Path(folder) / "experiments")
    os.symlink(program, pathlib.Path(folder) / "mpm")
    os.chdir(folder)  # results stay out of the tree
    printed = None  # by the block before; ...: it was left out
    for match in re.finditer(r"^```(\w*)\n(.*?)^```", text, flags=re.M | re.S):
        language, block = match.groups()
        line = text.count("\n", 0, match.start()) + 1
        if language == "text":
            assert printed is not None, f"{page}:{line}: no block that was executed stands before this output"
            if printed is not ...:
                assert printed == block, f"{page}:{line}: the page says\n{block}\nand the program\n{printed}"
                counts["compared"] += 1
            printed = None
            continue
        printed = None
        if language == "python" and "vtkmodules" in block and not has_vtk():
            print(f"SKIPPED: {page}:{line}: VTK's own reader (python3-vtk9) is not installed")
            printed, counts["left out"] = ..., counts["left out"] + 1
        elif language == "python":
            printed, counts["executed"] = run_python(block, line), counts["executed"] + 1
        elif language == "sh" and calls_only_the_program(block):
            printed, counts["executed"] = run_shell(block, line), counts["executed"] + 1
        elif language == "json" and (name := re.match(r"// (\w+\.json)\n", block)):
            pathlib.Path(name[1]).write_text(block)
            counts["saved"] += 1
    listed = pathlib.Path(__file__).parent / "page_numbers" / (pathlib.Path(page).stem + ".json")
    if listed.is_file():
        counts["numbers"] = check_numbers(json.loads(listed.read_text()))
    os.chdir("/")
assert counts["executed"] >= 5 and counts["compared"] >= 3, counts
numbers = counts.pop("numbers", 0)
print(f"{page}: " + ", ".join(f"{number} blocks {what}" for what, number in counts.items()) + f", {numbers} numbers of prose")
