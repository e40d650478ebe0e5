"""The mutants of a C++ text: every place where one small change makes a program that a test ought to tell from the
right one. The list follows from the text alone, so that two calls give the same mutants with the same names.

The text must be formatted by clang-format: a binary operator stands between spaces, the bracket of template arguments
touches the name before it."""

import re
from dataclasses import dataclass, replace

TOKEN = re.compile(
    r"(?P<number>0x[0-9a-fA-F.]+p[-+]?\d+|\d+\.?\d*(?:e[-+]?\d+)?)|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<sign><<=|>>=|<<|>>|<=|>=|==|!=|&&|\|\||\+\+|--|\+=|-=|\*=|/=|->|::|[^\s\w])"
)
OPPOSITE = {
    "+": "-", "-": "+", "+=": "-=", "-=": "+=", "<": ">=", ">=": "<", ">": "<=", "<=": ">", "==": "!=", "!=": "==",
    "&&": "||", "||": "&&", "min": "max", "max": "min",
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change of one file. `what` names the change among those of its line, `code` is the line as it stands."""

    file: str
    line: int
    what: str
    code: str
    begin: int
    end: int
    replacement: str

    @property
    def name(self):
        return f"{self.file}:{self.line}:{self.what}"

    @property
    def key(self):
        """What the mutant is called in the list of equivalent ones, which no shift of lines makes wrong."""
        return (self.file, self.what, self.code)

    def applied(self, text):
        return text[: self.begin] + self.replacement + text[self.end :]


def folder_of(mutant):
    """modules/kind, of a backend modules/backends/name."""
    parts = mutant.file.split("/")
    return "/".join(parts[: 3 if parts[1] == "backends" else 2])


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    begin: int
    end: int


def blanked(text, pattern):
    """The text with spaces in place of what matches, so that all else keeps its place."""
    return re.sub(pattern, lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def code_only(text):
    """The text without what is no arithmetic: comments, strings, the preprocessor's lines, static assertions, the
    tables of parameters and state fields with their words."""
    text = blanked(text, r'//[^\n]*|/\*[\s\S]*?\*/|R"(\w*)\([\s\S]*?\)\1"|"(?:\\.|[^"\\\n])*"')
    text = blanked(text, r"(?m)^[ \t]*#(?:[^\n]*\\\n)*[^\n]*")
    text = blanked(text, r"\bstatic_assert\([^;]*;|\busing [^;]*;")
    return blanked(text, r"static constexpr mpm_(?:parameter|state) [^;]*;")


def closing(tokens, at):
    """The place of the bracket that closes the one at `at`."""
    pairs = {"(": ")", "[": "]", "{": "}", "<": ">"}
    opening, close = tokens[at].text, pairs[tokens[at].text]
    depth, place = 1, at
    while depth > 0:
        place += 1
        if place == len(tokens):
            raise ValueError("a bracket is never closed")
        text = tokens[place].text
        if opening == "<" and text in ("(", "[", "{"):  # a lambda may be an argument and compare
            place = closing(tokens, place)
        elif text == opening and (opening != "<" or tokens[place - 1].end == tokens[place].begin):
            depth += 1
        elif text == close:
            depth -= 1
        elif opening == "<" and text == ">>":
            depth -= 2
    return place


def tokens_of(text):
    """The tokens of the code, template parameters and arguments left out."""
    code = code_only(text)
    found = [Token(match.lastgroup, match[0], match.start(), match.end()) for match in TOKEN.finditer(code)]
    kept, place = [], 0
    while place < len(found):
        token = found[place]
        before = found[place - 1] if place else None
        touches = before is not None and before.end == token.begin and before.text != "operator"
        named = touches and (before.kind == "name" or before.text == "]")
        if token.text == "<" and (named or before is not None and before.text == "template"):
            place = closing(found, place)
            if touches:  # the arguments belong to the name, the parameters to the lambda
                kept[-1] = replace(kept[-1], end=found[place].end)
        else:
            kept.append(token)
        place += 1
    return kept


def factor_end(tokens, at):
    """The place behind the factor that begins at `at`: a sign, a name, number or bracket and all calls behind it."""
    while tokens[at].text in ("-", "+", "!", "*", "&"):
        at += 1
    at = closing(tokens, at) + 1 if tokens[at].text == "(" else at + 1
    while at < len(tokens):
        if tokens[at].text in ("(", "["):
            at = closing(tokens, at) + 1
        elif tokens[at].text in (".", "::", "->"):
            at += 2
        else:
            return at
    return at


def term_end(tokens, at):
    """The place behind the product that begins at `at`."""
    at = factor_end(tokens, at)
    while at < len(tokens) and tokens[at].text in ("*", "/", "%"):
        at = factor_end(tokens, at + 1)
    return at


def is_binary(text, token):
    return text[token.begin - 1].isspace() and text[token.end].isspace()


def other_number(number):
    """Half of a decimal or an even number, twice an odd one; none for zero."""
    if number.startswith("0x"):
        return f"({number} / 2)"
    if re.search(r"[.e]", number):
        return f"({number} / 2)" if float(number) else None
    value = int(number)
    return None if value == 0 else str(value // 2 if value % 2 == 0 else value * 2)


def in_index(tokens, at):
    """Whether a number only says which entry is meant: [1], (0, 1), (i, 1)."""
    before, after = tokens[at - 1].text, tokens[at + 1].text
    return before in ("[", "(", ",") and after in ("]", ",", ")") and not (before == "(" and after == ")")


def changes_of(text):
    """Every (begin, end, replacement, words) in the order of the text."""
    tokens = tokens_of(text)
    for at, token in enumerate(tokens[:-1]):
        before, after = tokens[at - 1] if at else token, tokens[at + 1]
        binary = token.kind == "sign" and is_binary(text, token)
        if binary and token.text in OPPOSITE:
            yield token.begin, token.end, OPPOSITE[token.text], f"{token.text} to {OPPOSITE[token.text]}"
        called = after.text == "(" and (before.kind != "name" or before.text in ("return", "else"))  # not declared
        if token.kind == "name" and token.text in ("min", "max") and called:
            yield token.begin, token.end, OPPOSITE[token.text], f"{token.text} to {OPPOSITE[token.text]}"
        if token.kind == "name" and token.text == "abs" and called:
            yield token.begin, token.end, "", "drop abs"
        if binary and token.text in ("+", "-", "|"):
            behind = tokens[term_end(tokens, at + 1) - 1].end
            yield token.begin, behind, "", f"drop {squeezed(text[token.begin : behind])}"
        if binary and token.text in ("*", "/"):
            behind = tokens[factor_end(tokens, at + 1) - 1].end
            yield token.begin, behind, "", f"drop {squeezed(text[token.begin : behind])}"
        if token.text == "-" and not binary and after.begin == token.end and before.text not in (")", "]", "operator"):
            yield token.begin, token.end, "", f"drop the sign of {squeezed(text[token.end : tokens[factor_end(tokens, at + 1) - 1].end])}"
        if token.kind == "number" and not in_index(tokens, at) and (other := other_number(token.text)):
            if not (after.text == "/" and tokens[at + 2].kind == "number"):  # of a quotient the divisor alone
                yield token.begin, token.end, other, f"{token.text} to {other}"
        if token.text == "=" and binary and after.text not in ("default", "delete"):
            statement = assignment_around(tokens, at)
            if statement:
                begin, end = tokens[statement[0]].begin, tokens[statement[1]].begin
                yield begin, end, "", f"drop {squeezed(text[begin : tokens[at].end])}"


def assignment_around(tokens, at):
    """First place and place behind an assignment that stands alone between semicolons, none for a declaration."""
    first = at
    depth = 0
    while first and not (depth == 0 and tokens[first - 1].text in (";", "{", "}", ")", ",", "=", "(", "else")):
        first -= 1
        depth += (tokens[first].text == "]") - (tokens[first].text == "[")
        if tokens[first].text == "]":
            pass
    # A call on the left, F(0, 1) = ..., ends in the bracket that stopped the walk.
    if tokens[at - 1].text == ")":
        first, depth = at - 1, 1
        while depth:
            first -= 1
            depth += (tokens[first].text == ")") - (tokens[first].text == "(")
        first -= 1
        while tokens[first - 1].text in (".", "->"):
            first -= 2
    left = tokens[first:at]
    if not left or left[0].kind != "name" or left[0].text == "return" or any(a.kind == b.kind == "name" for a, b in zip(left, left[1:])):
        return None
    if any(a.text in ("&", "*") and b.kind == "name" and a.end == b.begin - 1 for a, b in zip(left, left[1:])):
        return None  # the declaration of a reference
    if tokens[first - 1].kind == "name" and tokens[first - 1].text != "else":
        return None  # the type of a declaration
    if tokens[first - 1].text in (",", "&", "*", ">", "("):
        return None  # in a list or a declaration
    behind = at
    while tokens[behind].text not in (";", ","):
        behind = closing(tokens, behind) + 1 if tokens[behind].text in ("(", "[", "{") else behind + 1
        if tokens[behind].text in (")", "}"):
            return None
    return (first, behind) if tokens[behind].text == ";" else None


def squeezed(words):
    """The words on one line, shortened to what tells them apart."""
    words = " ".join(words.split())
    return words if len(words) <= 48 else words[:45] + "..."


def mutants_of(file, text):
    """The mutants of a file in the order of its text. Equal changes in one line are numbered."""
    lines = text.split("\n")
    found, seen = [], {}
    for begin, end, replacement, words in changes_of(text):
        line = text.count("\n", 0, begin) + 1
        seen[line, words] = number = seen.get((line, words), 0) + 1
        what = words if number == 1 else f"{words} (no. {number})"
        found.append(Mutant(file, line, what, lines[line - 1].strip(), begin, end, replacement))
    return found
