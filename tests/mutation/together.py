"""All mutants of one file in one text, which takes one compilation in place of hundreds: an expression E with a mutant
E' becomes (mpm_mutant == 5 ? (E') : (E)), and the environment's MPM_MUTANT says which one the program is. With -1 the
program is the unchanged one and notes the expressions that it comes to in the file MPM_MUTANT_SEEN, a byte for each.

Some mutants cannot be there, constants of compile time for one; the compiler names them, and they are tried alone."""

import re

from mutants import closing, tokens_of

ASSIGNMENTS = ("=", "+=", "-=", "*=", "/=")
OPENMP_LOOP = re.compile(r"#pragma omp (?:[^\n]*\\\n)*[^\n]*\n\s*for \([^\n]*")  # its head has a form of its own
CHOICE_OF_LANES = ["[", "]", "(", "int", "lane", ")", "{"]  # what shuffled() of modules/kernel/lanes.hpp is told
NO_EXPRESSION = ("no match for", "invalid operands")  # what the compiler says of "a" - "b", alone as among others
SWITCH_FILE = "mpm_mutant_switch.hpp"
SWITCH = """#pragma once
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <cstdlib>
#include <type_traits>
inline int mpm_mutant = [] {
  const char* number = std::getenv("MPM_MUTANT");
  return number ? std::atoi(number) : 0;
}();
extern "C" __attribute__((weak, used)) void mpm_become_mutant(int number) { mpm_mutant = number; }
inline unsigned char* mpm_open_seen() {
  const char* path = std::getenv("MPM_MUTANT_SEEN");
  const int file = path ? open(path, O_RDWR) : -1;
  if (file < 0) return nullptr;
  const long size = lseek(file, 0, SEEK_END);
  void* bytes = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  return bytes == MAP_FAILED ? nullptr : static_cast<unsigned char*>(bytes);
}
inline bool mpm_come_to(int number) {
  static unsigned char* const seen = mpm_open_seen();
  if (seen) seen[number] = 1;
  return true;
}
"""
SWITCH_ON_DEVICE = """#pragma once
extern "C" {
char* getenv(const char*);
int atoi(const char*);
int open(const char*, int, ...);
int close(int);
long lseek(int, long, int);
void* mmap(void*, unsigned long, int, int, int, long);
}
inline const int mpm_mutant = [] {
  const char* number = getenv("MPM_MUTANT");
  return number ? atoi(number) : 0;
}();
inline unsigned char* const mpm_seen = [] {
  const char* path = getenv("MPM_MUTANT_SEEN");
  const int file = path ? open(path, 2) : -1;
  if (file < 0) return static_cast<unsigned char*>(nullptr);
  const long size = lseek(file, 0, 2);
  void* bytes = mmap(nullptr, static_cast<unsigned long>(size), 3, 1, file, 0);
  close(file);
  return reinterpret_cast<long>(bytes) == -1 ? nullptr : static_cast<unsigned char*>(bytes);
}();
inline bool mpm_come_to(int number) {
  if (mpm_seen) mpm_seen[number] = 1;
  return true;
}
"""  # a composition sees no header of the system; its numbers are those of Linux


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
        if depth == 0 and (text in ("(", "[", "{", "}", "else") or text in delimiters or heads_statement(tokens, first - 1)):
            break
        depth += (text in (")", "]", "}")) - (text in ("(", "[", "{"))
        first -= 1
    while tokens[last + 1].text not in (")", "]", "}", *delimiters):
        last = closing(tokens, last + 1) if tokens[last + 1].text in ("(", "[", "{") else last + 1
    return tokens[first].begin, tokens[last].end


def heads_statement(tokens, at):
    """Whether the token is the bracket that ends the head of a for, while or if, behind which a statement begins."""
    if tokens[at].text != ")":
        return False
    depth = 1
    while depth:
        at -= 1
        depth += (tokens[at].text == ")") - (tokens[at].text == "(")
    return tokens[at - 1].text in ("for", "while", "if") or tokens[at - 2].text == "if"  # if constexpr


def declaration_end(tokens, at):
    """The place where what begins with constexpr ends: before a function's body, behind the condition of an if."""
    begin, is_given, has_arguments = at, False, False
    while at + 1 < len(tokens) and tokens[at].text != ";":
        text = tokens[at].text
        is_given = is_given or text == "="
        if text == "{" and has_arguments and not is_given:
            break
        if text in ("(", "[", "{"):
            has_arguments = has_arguments or text == "("
            is_condition = at == begin + 1 and tokens[begin - 1].text == "if"
            at = closing(tokens, at)
            if is_condition:
                break
        at += 1
    return at


class Together:
    """The text with all mutants but those that the compiler refused. Numbers count from `first`; a folder that the
    compiler searches holds SWITCH as SWITCH_FILE."""

    def __init__(self, text, mutants, first=1):
        self.text, self.mutants, self.first, self.refused = text, mutants, first, set()
        self.of_other_type, self.no_program = set(), set()  # given the type of the unchanged expression; no expression at all
        tokens = tokens_of(text)
        self.spans = {}
        for number, mutant in enumerate(mutants, first):
            try:
                span = expression_around(tokens, mutant)
            except (IndexError, ValueError):
                self.refused.add(number)
                continue
            if span == (mutant.begin, mutant.end) and not mutant.replacement and text[: span[0]].rstrip().endswith("="):
                self.refused.add(number)  # the inner one of a = b = c, which has a value
            else:
                self.spans.setdefault(span, []).append(number)
        for begin, end in list(self.spans):
            if any(b < begin < e < end for b, e in self.spans):  # neither holds the other
                self.refused.update(self.spans.pop((begin, end)))

    def refuse_constants(self):
        """Takes out those of heads of loops of OpenMP and of declarations that the compiler evaluates, which spares most of its refusals, and those of
        choices of lanes, which it evaluates as well: where one is an argument of a function its refusal names nothing."""
        tokens = tokens_of(self.text)
        for loop in OPENMP_LOOP.finditer(self.text):
            self.refused.update(n for n, m in enumerate(self.mutants, self.first) if loop.start() < m.begin < loop.end())
        for place, token in enumerate(tokens):
            if token.text in ("constexpr", "alignas", "typedef"):
                end = declaration_end(tokens, place)
            elif [t.text for t in tokens[place : place + len(CHOICE_OF_LANES)]] == CHOICE_OF_LANES:
                end = closing(tokens, place + len(CHOICE_OF_LANES) - 1)
            else:
                continue
            last = tokens[end].begin
            self.refused.update(n for n, m in enumerate(self.mutants, self.first) if token.begin < m.begin < last)

    def numbers(self):
        return [n for n in range(self.first, self.first + len(self.mutants)) if n not in self.refused]

    def expression_of(self):
        """For each number the first number of its expression, which is the one that the program notes."""
        return {n: numbers[0] for numbers in self.spans.values() for n in numbers}

    def written(self):
        spans = sorted(((b, e, [n for n in numbers if n not in self.refused]) for (b, e), numbers in self.spans.items()),
                       key=lambda span: (span[0], -span[1]))  # fmt: skip
        text, _ = self.rendered(0, len(self.text), [span for span in spans if span[2]])
        include, guard = f'#include "{SWITCH_FILE}"\n', "#pragma once\n"
        return text.replace(guard, guard + include, 1) if guard in text else include + text

    def rendered(self, begin, end, spans):
        """The text from `begin` to `end` with those of `spans` that lie in it, and the spans behind it."""
        parts, at = [], begin
        while spans and spans[0][0] < end:
            first, last, numbers = spans[0]
            if last > end:
                raise ValueError("expressions overlap")
            base, spans = self.rendered(first, last, spans[1:])
            behind = self.text.count("\n", 0, last) + 1
            parts += [self.text[at:first], self.chosen(first, last, numbers, base), f'\n#line {behind} "unmarked {self.mutants[0].file}"\n']
            at = last
        return "".join([*parts, self.text[at:end]]), spans

    def chosen(self, begin, end, numbers, base):
        written = "("
        for number in numbers:
            m = self.mutants[number - self.first]
            changed = self.text[begin : m.begin] + m.replacement + self.text[m.end : end]
            without = (begin, end) == (m.begin, m.end) and not m.replacement  # a whole assignment
            if number in self.of_other_type:
                changed = f"static_cast<std::decay_t<decltype({self.text[begin:end]})>>({changed})"
            changed, base = ("void()", f"void({base})") if without else (f"({changed})", base)
            written += f'\n#line 1 "mutant_{number}"\nmpm_mutant == {number} ? {changed} :'
        noted = self.spans[begin, end][0]
        return written + f'\n#line 1 "unchanged_{noted}"\n((void)(mpm_mutant < 0 && mpm_come_to({noted})), {base}))'

    def refuse(self, output):
        """Takes out the mutants that the compiler's messages name; whether there were any."""
        errors = re.findall(r"(?m)^(mutant|unchanged)_(\d+):\d+:\d+: (?:fatal )?error: (.*)", output)
        # What is not declared any more makes others wrong that use it, which are no mistakes of their own.
        syntax = bool(errors) and any(word in errors[0][2] for word in ("expected", "does not name"))
        first = errors[:1] if syntax else [e for e in errors if "not declared" not in e[2]] or errors[:1]
        named = {int(number) for where, number, _ in first if where == "mutant"}
        whole = {int(number) for where, number, _ in first if where == "unchanged"}
        if not named | whole:  # a template that another calls: the compiler then names who called
            caller = re.search(r"(?m)^(?:mutant|unchanged)_(\d+):", output)
            whole = {int(caller[1])} if caller else set()
        noted_as = self.expression_of()
        whole |= {noted_as[number] for number in whole & noted_as.keys()}
        if not named:  # where a mutant is named too, the expression around it may be right without that mutant
            named = {number for number, noted in noted_as.items() if noted in whole}
        lines = {int(line) for line in re.findall(rf"(?m)^unmarked {re.escape(self.mutants[0].file)}:(\d+):\d+: error: ", output)}
        if not named and not errors:  # of an array the compiler names the whole line
            named = {number for number, m in enumerate(self.mutants, self.first) if m.line in lines}
        named &= set(self.numbers())
        retyped, messages = False, {}
        for where, number, message in errors:
            messages.setdefault(int(number), message)
        for number in list(named):
            message = messages.get(number, "")
            if any(words in message for words in NO_EXPRESSION):
                self.no_program.add(number)
            elif "different types" in message and number not in self.of_other_type:
                self.of_other_type.add(number)
                named.discard(number)
                retyped = True
        self.refused |= named
        return bool(named) or retyped
