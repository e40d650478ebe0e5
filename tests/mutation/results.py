"""What became of each mutant, kept in a file, and the list of mutants that compute the same as the program."""

import datetime
import hashlib
import json
import time
from dataclasses import asdict, dataclass

from mutants import folder_of


@dataclass(frozen=True)
class Result:
    """`by` is the test that failed; `check` says more, where the test does."""

    KILLED = "killed"
    TIMED_OUT = "timed out"
    SAME_CODE = "same code"
    UNCOMPILED = "uncompiled"
    SURVIVED = "survived"

    status: str
    by: str = ""
    check: str = ""

    def text(self):
        words = self.status + (f" by {self.by}" if self.by else "")
        return words + (f" ({self.check})" if self.check else "")


def fingerprint(mutant):
    words = "\n".join([mutant.file, str(mutant.line), mutant.what, mutant.code, mutant.replacement])
    return hashlib.sha256(words.encode()).hexdigest()[:16]


class Results:
    """Results by mutant. A changed line makes other mutants, whose results are unknown."""

    def __init__(self, path):
        self.path, self.saved = path, 0
        kept = json.loads(path.read_text()) if path.is_file() else {}
        self.dates = kept.get("dates", {})  # when a mutant of a folder was last tried
        self.known = {key: Result(**value) for key, value in kept.get("results", {}).items()}

    def clear(self, mutants):
        for mutant in mutants:
            self.known.pop(fingerprint(mutant), None)

    def of(self, mutant):
        return self.known.get(fingerprint(mutant))

    def put(self, mutant, result):
        self.known[fingerprint(mutant)] = result
        self.dates[folder_of(mutant)] = datetime.date.today().isoformat()
        if time.monotonic() > self.saved + 2:
            self.save()

    def save(self):
        self.path.parent.mkdir(parents=True, exist_ok=True)
        kept = {"dates": self.dates, "results": {key: asdict(value) for key, value in self.known.items()}}
        self.path.with_suffix(".new").write_text(json.dumps(kept, indent=1))
        self.path.with_suffix(".new").replace(self.path)
        self.saved = time.monotonic()


class Equivalents:
    """The list of equivalent mutants: blocks of lines `file`, `line`, `change` (one or more), `reason`, each a word and
    a colon before its text. A mutant is in it by the text of its line, wherever that stands in the file."""

    def __init__(self, path):
        self.reasons = {}
        block, reason_of = {"change": []}, None
        for text in [*path.read_text().split("\n"), ""] if path.is_file() else []:
            if text.startswith("#"):
                continue
            word, colon, rest = text.partition(": ")
            if colon and word in ("file", "line", "reason"):
                block[word] = rest
            elif colon and word == "change":
                block["change"].append(rest)
            elif text.startswith("  ") and "reason" in block:
                block["reason"] += " " + text.strip()
            elif not text.strip():
                if block["change"]:
                    for change in block["change"]:
                        self.reasons[block["file"], change, block["line"]] = block["reason"]
                block = {"change": []}
            else:
                raise SystemExit(f"{path}: a line that begins with no known word: {text}")

    def reason(self, mutant):
        return self.reasons.get(mutant.key)

    def stale(self, mutants, results):
        """What the list says of mutants tried here that is not so any more. Of lines with the same text one suffices."""
        by_key = {}
        for mutant in mutants:
            by_key.setdefault(mutant.key, []).append(mutant)
        for key in self.reasons:
            found = [(mutant, results.of(mutant)) for mutant in by_key.get(key, [])]
            if found and all(result and result.status not in (Result.SURVIVED, Result.SAME_CODE) for _, result in found):
                yield from (f"{mutant.name} is {result.text()}" for mutant, result in found)

    def unknown(self, mutants):
        """The entries of these mutants' files that match none of them."""
        keys, files = {mutant.key for mutant in mutants}, {mutant.file for mutant in mutants}
        return [key for key in self.reasons if key[0] in files and key not in keys]
