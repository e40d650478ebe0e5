"""The table of results, and the page of docs/design that holds it."""

from collections import Counter
from pathlib import Path

from mutants import folder_of
from results import Result

BEGIN, END = "<!-- written by tests/mutation/run --page: {part} -->", "<!-- end of {part} -->"


def what_became(mutant, results, equivalents):
    result = results.of(mutant)
    if result is None:
        return "not tried"
    if result.status == Result.SURVIVED and equivalents.reason(mutant):
        return "equivalent"
    if result.status in (Result.KILLED, Result.TIMED_OUT):
        return result.by.split(".")[0]
    return result.status


def file_of(mutant):
    return mutant.file.removeprefix(folder_of(mutant) + "/")


def table(mutants, results, equivalents, row_of=folder_of):
    """One row a folder, or what else `row_of` says."""
    killers = ["test-plugin", "conformance", "config", "unit", "parity", "verification", "device"]
    columns = [*killers, "same code", "uncompiled", "equivalent", "survived", "not tried"]
    rows = {}
    for mutant in mutants:
        rows.setdefault(row_of(mutant), Counter())[what_became(mutant, results, equivalents)] += 1
    columns = [c for c in columns if c in ("survived", "equivalent") or any(row[c] for row in rows.values())]
    title = ["folder" if row_of is folder_of else "file", "mutants", *(f"killed by {c}" if c in killers else c for c in columns)]
    lines = ["| " + " | ".join(title) + " |", "|" + "---|" + "--:|" * (len(title) - 1)]
    for folder, row in rows.items():
        lines.append("| " + " | ".join([f"`{folder}`", str(sum(row.values())), *(str(row[c]) for c in columns)]) + " |")
    return "\n".join(lines)


def with_reasons(mutants, results, equivalents):
    """The survivors, those without a reason first, then all that have one, tried or not; equal reasons of one file stand
    together."""
    unexplained = [m for m in mutants if what_became(m, results, equivalents) == Result.SURVIVED]
    lines = ["No mutant survived without a reason."] if not unexplained else ["Survived without a reason:", ""]
    lines += [f"- `{m.name}`: `{m.code}` ({results.of(m).check or 'all quick tests'})" for m in unexplained]
    groups = {}
    for m in mutants:
        if equivalents.reason(m) and what_became(m, results, equivalents) in ("equivalent", "not tried"):
            groups.setdefault((m.file, equivalents.reason(m)), []).append(m)
    if groups:
        lines += ["", "| file | line | changes | why no test can see them |", "|---|---|---|---|"]
    for (file, reason), group in groups.items():
        code = "<br>".join(dict.fromkeys(f"`{escaped(m.code)}`" for m in group))
        changes = "<br>".join(f"`{escaped(m.what)}`" for m in group)
        lines.append(f"| `{Path(file).name}` | {code} | {changes} | {reason} |")
    return "\n".join(lines)


def escaped(code):
    return code.replace("|", "\\|")


def samples(mutants, results):
    """How many of each folder's mutants were tried, and when."""
    sentences = []
    for folder in dict.fromkeys(folder_of(mutant) for mutant in mutants):
        of_folder = [mutant for mutant in mutants if folder_of(mutant) == folder]
        tried = sum(results.of(mutant) is not None for mutant in of_folder)
        words = "all" if tried == len(of_folder) else f"{tried} of" if tried else "none of the"
        date = f", {results.dates[folder]}" if folder in results.dates else ""
        sentences.append(f"- `{folder}`: {words} {len(of_folder)} mutants{date}")
    return "Tried were\n\n" + "\n".join(sentences)


def write(path, part, mutants, results, equivalents):
    """Writes a part of the page between its two marks: all mutants' number, and what became of those that were tried."""
    begin, end = BEGIN.format(part=part), END.format(part=part)
    text = path.read_text()
    head, found, rest = text.partition(begin)
    _, ended, tail = rest.partition(end)
    if not found or not ended:
        raise SystemExit(f"{path}: the marks {begin} and {end} are missing")
    tried = [mutant for mutant in mutants if results.of(mutant)]
    by_hand = [
        samples(mutants, results),
        table(tried, results, equivalents, file_of if part == "device" else folder_of),
        with_reasons(mutants, results, equivalents),
    ]
    path.write_text(head + begin + "\n\n" + "\n\n".join(by_hand) + "\n\n" + end + tail)
