"""Executes a page of the docs as a reader would, from top to bottom, and compares what comes out with the page.

    page.py SOURCE PAGE PROGRAM

Executed are its blocks of Python, and its blocks of the shell (sh) that call the program only; ./mpm is then PROGRAM.
A block of text after one of these is what it prints. A block of JSON that begins with the comment "// NAME.json" is
saved as that file. Blocks that import VTK are left out where it is not installed, and that is said.
"""

import contextlib
import io
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
    os.chdir("/")
assert counts["executed"] >= 5 and counts["compared"] >= 3, counts
print(f"{page}: " + ", ".join(f"{number} blocks {what}" for what, number in counts.items()))
