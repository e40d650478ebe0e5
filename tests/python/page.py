"""Executes docs/python.md as a reader would: its Python blocks one after another, their output compared with the page.

A block of text after a block of Python is what that prints. Calls of the shell are not executed here.
"""

import contextlib
import io
import os
import pathlib
import re
import sys
import tempfile

source = pathlib.Path(sys.argv[1])
page = (source / "docs" / "python.md").read_text()
blocks = re.findall(r"^```(\w*)\n(.*?)^```", page, flags=re.M | re.S)
names = {"__name__": "page"}
executed = compared = 0
with tempfile.TemporaryDirectory() as folder:
    os.symlink(source / "experiments", pathlib.Path(folder) / "experiments")
    os.chdir(folder)  # results stay out of the tree
    printed = None
    for language, text in blocks:
        if language == "python":
            output = io.StringIO()
            with contextlib.redirect_stdout(output):
                exec(compile(text, "docs/python.md", "exec"), names)
            printed, executed = output.getvalue(), executed + 1
        elif language == "text":
            assert printed is not None, f"no Python stands before this output:\n{text}"
            assert printed == text, f"the page says\n{text}\nand the program\n{printed}"
            printed, compared = None, compared + 1
    os.chdir("/")
assert executed >= 5 and compared >= 4, (executed, compared)
print(f"{executed} blocks executed, {compared} outputs compared")
