"""All mutants of one file in one text, which takes one compilation in place of hundreds: an expression E with a mutant
E' becomes (mpm_mutant == 5 ? (E') : (E)), and the environment's MPM_MUTANT says which one the program is.

Some mutants cannot be there, constants of compile time for one; the compiler names them, and they are tried alone."""

import re

from mutants import closing, tokens_of

ASSIGNMENTS = ("=", "+=", "-=", "*=", "/=")
SWITCH = """#pragma once
#include <cstdlib>
inline const int mpm_mutant = [] {
  const char* number = std::getenv("MPM_MUTANT");
  return number ? std::atoi(number) : 0;
}();
"""


def expression_around(tokens, mutant):
    """(begin, end) in the text of the smallest expression between delimiters that holds the whole change."""
    if mutant.what.endswith(" =") or " = (no. " in mutant.what or mutant.what.endswith("...") and not mutant.replacement \
            and any(t.text == "=" and mutant.begin < t.begin < mutant.end for t in tokens):  # fmt: skip
        return mutant.begin, mutant.end
    inside = [place for place, token in enumerate(tokens) if mutant.begin <= token.begin < mutant.end]
    delimiters = (",", ";", "return", *ASSIGNMENTS)
    if mutant.replacement not in ASSIGNMENTS:  # a ? b : c binds closer than an assignment
        delimiters = (*delimiters, "?", ":")
    first, last, depth = inside[0], inside[-1], 0
    while True:
        text = tokens[first - 1].text
        if depth == 0 and (text in ("(", "[", "{", "}") or text in delimiters):
            break
        depth += (text in (")", "]", "}")) - (text in ("(", "[", "{"))
        first -= 1
    while tokens[last + 1].text not in (")", "]", "}", *delimiters):
        last = closing(tokens, last + 1) if tokens[last + 1].text in ("(", "[", "{") else last + 1
    return tokens[first].begin, tokens[last].end


class Together:
    """The text with all mutants but those that the compiler refused. Numbers count from 1."""

    def __init__(self, text, mutants):
        self.text, self.mutants, self.refused = text, mutants, set()
        tokens = tokens_of(text)
        self.spans = {}
        for number, mutant in enumerate(mutants, 1):
            try:
                self.spans.setdefault(expression_around(tokens, mutant), []).append(number)
            except (IndexError, ValueError):
                self.refused.add(number)

    def numbers(self):
        return [number for number in range(1, len(self.mutants) + 1) if number not in self.refused]

    def written(self):
        spans = sorted(((b, e, [n for n in numbers if n not in self.refused]) for (b, e), numbers in self.spans.items()),
                       key=lambda span: (span[0], -span[1]))  # fmt: skip
        text, _ = self.rendered(0, len(self.text), [span for span in spans if span[2]])
        return SWITCH + text.replace("#pragma once", "", 1)

    def rendered(self, begin, end, spans):
        """The text from `begin` to `end` with those of `spans` that lie in it, and the spans behind it."""
        parts, at = [], begin
        while spans and spans[0][0] < end:
            first, last, numbers = spans[0]
            if last > end:
                raise ValueError("expressions overlap")
            base, spans = self.rendered(first, last, spans[1:])
            parts += [self.text[at:first], self.chosen(first, last, numbers, base)]
            at = last
        return "".join([*parts, self.text[at:end]]), spans

    def chosen(self, begin, end, numbers, base):
        written = "("
        for number in numbers:
            m = self.mutants[number - 1]
            changed = self.text[begin : m.begin] + m.replacement + self.text[m.end : end]
            without = (begin, end) == (m.begin, m.end) and not m.replacement  # a whole assignment
            changed, base = ("void()", f"void({base})") if without else (f"({changed})", base)
            written += f'\n#line 1 "mutant_{number}"\nmpm_mutant == {number} ? {changed} :'
        return written + f'\n#line 1 "unchanged"\n({base}))'

    def refuse(self, output):
        """Takes out the mutants that the compiler's messages name; whether there were any."""
        named = {int(number) for number in re.findall(r"(?m)^mutant_(\d+):\d+:\d+: (?:fatal )?error:", output)}
        self.refused |= named
        return bool(named)
