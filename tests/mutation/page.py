"""The table of results, and the page of docs/design that holds it."""

import re
from collections import Counter

from mutants import folder_of
from results import Result

BEGIN, END = "<!-- written by tests/mutation/run --page -->", "<!-- end of what is written -->"
KERNELS = "modules/backends/device/kernels"
COLUMNS = ["folder", "mutants", "killed", "no program of their own", "with a reason", "passed", "not tried", "last tried"]


def what_became(mutant, results, equivalents):
    result = results.of(mutant)
    if result is None:
        return "not tried"
    if result.status == Result.SURVIVED and equivalents.reason(mutant):
        return "equivalent"
    if result.status in (Result.KILLED, Result.TIMED_OUT):
        return result.by.split(".")[0]
    return result.status


def table(mutants, results, equivalents):
    """One row a folder, with the suites that killed."""
    killers = ["test-plugin", "conformance", "config", "unit", "parity", "verification", "device"]
    columns = [*killers, "same code", "uncompiled", "equivalent", "survived", "not tried"]
    rows = {}
    for mutant in mutants:
        rows.setdefault(folder_of(mutant), Counter())[what_became(mutant, results, equivalents)] += 1
    columns = [c for c in columns if c in ("survived", "equivalent") or any(row[c] for row in rows.values())]
    title = ["folder", "mutants", *(f"killed by {c}" if c in killers else c for c in columns)]
    lines = ["| " + " | ".join(title) + " |", "|" + "---|" + "--:|" * (len(title) - 1)]
    for folder, row in rows.items():
        lines.append("| " + " | ".join([f"`{folder}`", str(sum(row.values())), *(str(row[c]) for c in columns)]) + " |")
    return "\n".join(lines)


def row_of(mutant):
    """The folder that a mutant is counted with on the page."""
    return KERNELS if mutant.file.startswith(KERNELS + "/") else folder_of(mutant)


def column_of(mutant, results, equivalents):
    became = what_became(mutant, results, equivalents)
    if became == "equivalent" or became == "not tried" and equivalents.reason(mutant):
        return "with a reason"
    if became in (Result.SAME_CODE, Result.UNCOMPILED):
        return "no program of their own"
    return {Result.SURVIVED: "passed", "not tried": "not tried"}.get(became, "killed")


def row(folder, mutants, results, equivalents):
    counts = Counter(column_of(mutant, results, equivalents) for mutant in mutants)
    date = results.dates.get(folder_of(mutants[0]), "")
    return [f"`{folder}`", str(len(mutants)), *(str(counts[column]) for column in COLUMNS[2:-1]), date]


def passed(mutants, results, equivalents):
    """A line for each survivor without a reason."""
    survivors = [m for m in mutants if what_became(m, results, equivalents) == Result.SURVIVED]
    return [f"- `{m.name}`: `{m.code}` ({results.of(m).check or 'all quick tests'})" for m in survivors]


def cells_of(line):
    return line[2:-2].split(" | ")


def tried_before(line):
    """How many mutants of a row of the page had been tried."""
    return sum(int(cell) for cell in cells_of(line)[2:6])


def continued(line, listed, mutants, results, equivalents):
    """The list and the row of a folder whose mutants the work folder has tried in part: those that it has not tried stay
    what the page says, killed where it does not list them."""
    by_key = {key_of(re.match(r"- (`[^`]+`: `.*`) \(", text)[1]): text for text in listed}
    left, became = [], Counter()
    for mutant in mutants:
        column = column_of(mutant, results, equivalents)
        if column == "not tried" and mutant.key in by_key:
            left.append(f"- `{mutant.name}`: " + by_key[mutant.key].split("`: ", 1)[1])
        elif column == "passed":
            left += passed([mutant], results, equivalents)
        became[column] += 1
    folder, _, _, no_program, _, _, not_tried, _ = cells_of(line)
    rest = int(no_program) + became["with a reason"] + len(left) + int(not_tried)
    date = results.dates.get(folder_of(mutants[0]), "")
    return left, [folder, str(len(mutants)), str(len(mutants) - rest), no_program, str(became["with a reason"]),
                  str(len(left)), not_tried, date]  # fmt: skip


def key_of(name_and_code):
    """Mutant.key of a line of the list."""
    name, _, code = name_and_code.partition("`: `")
    file, _, what = name.removeprefix("`").split(":", 2)
    return file, what, code.removesuffix("`")


def written(old, mutants, results, equivalents):
    """The table and the list of what passed, anew for folders with results, and as they were for the others. A folder that
    the page does not know has a row before anything of it is tried, so that the page says so."""
    rows = {line.split("`")[1]: line for line in old.split("\n") if line.startswith("| `")}
    lists = {}
    for line in old.split("\n"):
        if found := re.match(r"- `([^:`]+)/[^/:`]+:", line):
            lists.setdefault(max((f for f in rows if begins(found[1], f)), key=len, default=found[1]), []).append(line)
    by_folder = {}
    for mutant in mutants:
        by_folder.setdefault(row_of(mutant), []).append(mutant)
    for folder, of_folder in by_folder.items():
        tried = sum(results.of(mutant) is not None for mutant in of_folder)
        if folder in rows and 0 < tried < tried_before(rows[folder]):  # the work folder is a new one
            lists[folder], cells = continued(rows[folder], lists.get(folder, []), of_folder, results, equivalents)
            rows[folder] = "| " + " | ".join(cells) + " |"
        elif tried or folder not in rows:
            rows[folder] = "| " + " | ".join(row(folder, of_folder, results, equivalents)) + " |"
            lists[folder] = passed(of_folder, results, equivalents)
    lines = ["| " + " | ".join(COLUMNS) + " |", "|---|" + "--:|" * (len(COLUMNS) - 2) + "---|", *rows.values(), ""]
    left = [line for folder in rows for line in lists.get(folder, [])]
    return "\n".join([*lines, "Passed without a reason:" if left else "Of what was tried nothing passed without a reason.",
                      *(["", *left] if left else [])])  # fmt: skip


def begins(folder, start):
    return folder == start or folder.startswith(start + "/")


def write(path, mutants, results, equivalents):
    """Writes what stands between the page's two marks."""
    head, found, rest = path.read_text().partition(BEGIN)
    old, ended, tail = rest.partition(END)
    if not found or not ended:
        raise SystemExit(f"{path}: the marks {BEGIN} and {END} are missing")
    path.write_text(f"{head}{BEGIN}\n\n{written(old, mutants, results, equivalents)}\n\n{END}{tail}")
