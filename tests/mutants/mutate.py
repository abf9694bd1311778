# SPDX-License-Identifier: MIT
"""Makes mutants of C functions: small sabotages that a test should notice.

A mutant is anchored by its function, its operator and the text of its statement, with the change
marked in it as {old => new}. It has no path and no line, so it survives a change of layout. Its id
is a hash of that anchor.
"""
import hashlib
import re

TOKEN = re.compile(r"""
    [A-Za-z_]\w* | 0[xX][0-9a-fA-F]+[uUlL]* | \d+\.?\d*(?:[eE][+-]?\d+)?[uUlLfF]* |
    "(?:\\.|[^"\\])*" | '(?:\\.|[^'\\])*' |
    -> | \+\+ | -- | <<= | >>= | << | >> | <= | >= | == | != | && | \|\| |
    [-+*/%&|^]= | [-+*/%&|^~!<>=?:;,.(){}\[\]]""", re.X)
COMPARED = {"<": ("<=", ">"), "<=": ("<", ">="), ">": (">=", "<"), ">=": (">", "<="),
            "==": ("!=",), "!=": ("==",), "&&": ("||",), "||": ("&&",)}
OPEN = {"(": ")", "[": "]", "{": "}"}
NO_NUMBER = {"NULL", "NAN", "INFINITY", "KEEP"}
JOINTS = {"j", "joint", "i"}


class Mutant:
    """One change: of text[start:end] in the file `path`."""

    def __init__(self, function, operator, path, span, new):
        self.function, self.operator, self.path, self.new = function.name, operator, path, new
        self.start, self.end = span
        self.line = function.text.count("\n", 0, self.start) + 1
        self.statement = function.statement(self.start, self.end, new)
        self.lines, self.whole = function.lines(self.start, self.end)
        self.name(1)

    def name(self, nth):
        """Where a function has the same statement twice, the second is #2."""
        self.anchor = f"{self.function} | {self.operator} | {self.statement}"
        self.anchor += f" #{nth}" if nth > 1 else ""
        self.id = hashlib.sha1(self.anchor.encode()).hexdigest()[:8]

    def apply(self, text):
        """The text of the file, sabotaged, with the same number of lines."""
        lost = text.count("\n", self.start, self.end) - self.new.count("\n")
        return text[:self.start] + self.new + "\n" * lost + text[self.end:]


class Token:
    def __init__(self, match):
        self.text, self.start, self.end = match.group(), match.start(), match.end()
        self.pair = self.statement = None

    def is_name(self):
        return self.text[0].isalpha() or self.text[0] == "_"


def squeeze(text):
    return " ".join(text.split())


def blank(text):
    """Comments and preprocessor lines as blanks: everything stays where it is."""
    def spaces(match):
        return re.sub(r"[^\n]", " ", match.group())
    text = re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"',
                  lambda m: m.group() if m.group()[0] == '"' else spaces(m), text, flags=re.S)
    return re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", spaces, text, flags=re.M)


class Function:
    """A function of a file: its signature and its tokens, each with its statement."""

    def __init__(self, name, text, clean, signature, start, end):
        self.name, self.text, self.clean, self.signature = name, text, clean, signature
        self.start, self.end = start, end
        self.tokens = [Token(m) for m in TOKEN.finditer(clean, start + 1, end)]
        self.spans = []
        self._pair()
        self._split()

    def _pair(self):
        stack = []
        for i, t in enumerate(self.tokens):
            if t.text in OPEN:
                stack.append(i)
            elif t.text in OPEN.values() and stack:
                t.pair = stack.pop()
                self.tokens[t.pair].pair = i

    def _is_block(self, i):
        before = self.tokens[i - 1].text if i > 0 else ";"
        if before in (";", "{", "}", "else", "do", ":"):
            return True
        if before != ")":
            return False
        head = self.tokens[self.tokens[i - 1].pair - 1]
        return head.text in ("if", "for", "while", "switch")

    def _split(self):
        depth, first, inner = 0, 0, []
        for i, t in enumerate(self.tokens):
            cut = False
            if t.text in "([":
                depth += 1
            elif t.text in ")]":
                depth -= 1
            elif t.text == "{":
                inner.append(self._is_block(i) and depth == 0)
                cut = inner[-1]
            elif t.text == "}":
                cut = inner.pop() if inner else True
            elif t.text == ";":
                cut = depth == 0
            if cut:
                self._close(first, i)
                first = i + 1
        self._close(first, len(self.tokens) - 1)

    def _close(self, first, last):
        if first > last:
            return
        for t in self.tokens[first:last + 1]:
            t.statement = len(self.spans)
        self.spans.append((first, last))

    def around(self, start, end):
        """Where the statement begins and ends that text[start:end] is in."""
        inside = [t for t in self.tokens if t.start < end and t.end > start]
        first, last = self.spans[inside[0].statement][0], self.spans[inside[-1].statement][1]
        return self.tokens[first].start, self.tokens[last].end

    def lines(self, start, end):
        """The first and the last line of that statement; True where it may be reached without
        them: what is the function itself, or tells where a switch goes."""
        if start <= self.start:
            return (0, 0), True
        a, z = self.around(start, end)
        text = self.clean[a:z]
        return tuple(self.text.count("\n", 0, at) + 1 for at in (a, z)), (
            re.search(r"\b(case|default|goto|static)\b|^\s*\w+\s*:[^:]", text) is not None)

    def statement(self, start, end, new):
        """The statement around text[start:end] with the change marked."""
        if start <= self.start:
            return f"{self.name}(): " + "{" + f"{squeeze(self.signature)} =>{new[1:]}" + "}"
        a, z = self.around(start, end)
        old = self.clean[start:end]
        return squeeze(f"{self.clean[a:start]}{{{old} => {new}}}{self.clean[end:z]}")


def functions_of(text):
    """Every function of a file: its brace stands alone at the start of a line."""
    clean = blank(text)
    found = []
    for match in re.finditer(r"^([^\n;{}#=]*(?:\n[^\n;{}#=]+)*\))\n\{\n", clean, re.M):
        signature = match.group(1)
        signature = signature[signature.rfind("\n\n") + 1:].strip()
        name = re.search(r"(\w+)\s*\(", signature)
        start = match.end() - 2
        end = clean.find("\n}", start)
        if name and end > 0:
            found.append(Function(name.group(1), text, clean, signature, start, end + 1))
    return found


# ---- operators: each yields (operator, start, end, new) ------------------------------------------

def chain_start(f, i):
    """The first token of a->b[c].d, of which token i is the last name."""
    while i > 0 and f.tokens[i - 1].text in ("->", "."):
        i -= 2
        while i > 0 and f.tokens[i].text in (")", "]"):
            i = f.tokens[i].pair - 1
    return max(i, 0)


def is_value(f, first, last):
    """True if these tokens are read, not declared, set or pointed to."""
    after = f.tokens[last + 1].text if last + 1 < len(f.tokens) else ";"
    before = f.tokens[first - 1] if first > 0 else None
    if after in ("=", "+=", "-=", "*=", "/=", "++", "--", "(", ".", "->", "["):
        return False
    if before is None or before.text in ("&", "++", "--", "."):
        two = f.tokens[first - 2].text if first > 1 else ""
        return before is not None and before.text == "&" and (two == ")" or two[-1:].isalnum())
    return not (before.is_name() and before.text not in ("return", "case", "else"))


def has_no_unit(f, first, last):
    """True of a sign: what is compared with 0 is the same in any unit."""
    after = [t.text for t in f.tokens[last + 1:last + 3]]
    before = [t.text for t in f.tokens[max(first - 2, 0):first]]
    return (after[0] in COMPARED and after[1] == "0") or (
        before[-1:] != [] and before[-1] in COMPARED and before[0] == "0")


def constants(f):
    for i, t in enumerate(f.tokens):
        before = f.tokens[i - 1].text if i > 0 else ""
        after = f.tokens[i + 1].text if i + 1 < len(f.tokens) else ""
        if t.text[0].isdigit():
            value = float(re.sub(r"[uUlLfF]+$", "", t.text)) if "x" not in t.text.lower() else 1
            if value < 1000:
                yield "constant", t.start, t.end, f"({t.text} + 1)"
                if value >= 1:
                    yield "constant", t.start, t.end, f"({t.text} - 1)"
            else:
                yield "unit", t.start, t.end, f"({t.text} * 1000)"
                yield "unit", t.start, t.end, f"({t.text} / 1000)"
        elif (re.fullmatch(r"[A-Z][A-Z0-9_]+", t.text) and t.text not in NO_NUMBER and
              after not in ("(", "=") and before not in (".", "->", "case")):
            if t.text.endswith("_US"):
                if t.text != "GROBO_NEVER_US":  # the largest number there is
                    yield "unit", t.start, t.end, f"({t.text} * 1000)"
                yield "unit", t.start, t.end, f"({t.text} / 1000)"
            else:
                yield "constant", t.start, t.end, f"({t.text} + 1)"
                yield "constant", t.start, t.end, f"({t.text} - 1)"


def units(f):
    for i, t in enumerate(f.tokens):
        first = chain_start(f, i)
        called = i + 1 < len(f.tokens) and f.tokens[i + 1].text == "("
        if re.fullmatch(r"grobo_(rad_from_deg|deg_from_rad)", t.text):
            yield "unit", t.start, t.end, ""
        elif (called or not re.search(r"[a-z]_(us|ms|rad|deg|dps)$", t.text) or
              has_no_unit(f, first, i)):
            continue
        elif is_value(f, first, i):
            start, end = f.tokens[first].start, t.end
            text = f.clean[start:end]
            if t.text.endswith(("_us", "_ms")):
                yield "unit", start, end, f"({text} * 1000)"
                yield "unit", start, end, f"({text} / 1000)"
            else:
                by = "*" if t.text.endswith("_rad") else "/"
                yield "unit", start, end, f"({text} {by} 57.3)"


def condition_of(f, i):
    """Tokens of what stands before the ? at i."""
    first = i
    while first > 0:
        t = f.tokens[first - 1]
        if t.text in (")", "]"):
            first = t.pair
        elif t.text in ("=", "return", ",", ";", "{", "}", "?", ":", "(", "[", "+=", "-=", "|="):
            break
        else:
            first -= 1
    return first, i - 1


def conditions_of(f):
    for i, t in enumerate(f.tokens):
        if t.text in ("if", "while") and f.tokens[i + 1].text == "(":
            yield i + 2, f.tokens[i + 1].pair - 1
        elif t.text == "for":
            marks = [k for k in range(i + 2, f.tokens[i + 1].pair) if f.tokens[k].text == ";"]
            if len(marks) == 2 and marks[0] + 1 < marks[1]:
                yield marks[0] + 1, marks[1] - 1
        elif t.text == "?":
            yield condition_of(f, i)
        elif t.text == "return" and re.match(r"(static )?bool\b", f.signature):
            yield i + 1, f.spans[t.statement][1] - 1
        elif t.text == "bool" and i + 2 < len(f.tokens) and f.tokens[i + 2].text == "=":
            yield i + 3, f.spans[t.statement][1] - 1


def conditions(f):
    whole = set()
    for first, last in conditions_of(f):
        if first <= last:
            start, end = f.tokens[first].start, f.tokens[last].end
            whole.add(start)
            yield "condition", start, end, f"!({f.text[start:end]})"
    for t in f.tokens:
        if t.text == "!" and t.start not in whole:
            yield "condition", t.start, t.end, ""


def comparisons(f):
    for t in f.tokens:
        for new in COMPARED.get(t.text, ()):
            yield "comparison", t.start, t.end, new


def statements(f):
    for first, last in f.spans:
        tokens = f.tokens[first:last + 1]
        while tokens and tokens[0].text in ("case", "default"):
            colon = next((k for k, t in enumerate(tokens) if t.text == ":"), len(tokens) - 1)
            tokens = tokens[colon + 1:]
        if len(tokens) < 2 or tokens[-1].text != ";":
            continue
        word = tokens[0].text
        plain = word in ("break", "continue") or (word == "return" and len(tokens) == 2)
        works = word != "return" and any(
            t.text in ("=", "(", "++", "--") or t.text[-1:] == "=" for t in tokens)
        declares = len(tokens) > 2 and tokens[0].is_name() and (
            tokens[1].is_name() or (tokens[1].text == "*" and tokens[2].is_name()))
        if plain or (works and not declares):
            yield "statement", tokens[0].start, tokens[-1].end, ";"


def joints(f):
    for i, t in enumerate(f.tokens):
        before = f.tokens[i - 1] if i > 0 else None
        if t.text == "[" and i > 0 and (before.is_name() or before.text == "]") and t.pair > i + 1:
            start, end = f.tokens[i + 1].start, f.tokens[t.pair - 1].end
            yield "joint", start, end, f"({f.clean[start:end]}) ^ 1"
        elif (t.text in JOINTS and before is not None and before.text in ("(", ",") and
              f.tokens[i + 1].text in (")", ",")):
            yield "joint", t.start, t.end, f"({t.text} ^ 1)"
        elif (t.text == "joint" and before is not None and before.text == "->" and
              is_value(f, chain_start(f, i), i)):
            start = f.tokens[chain_start(f, i)].start
            yield "joint", start, t.end, f"({f.clean[start:t.end]} ^ 1)"


def pointers_of(f):
    text = f.signature + f.clean[f.start:f.tokens[-1].end if f.tokens else f.start]
    return set(re.findall(r"\*\s*(?:const\s+)?(\w+)\s*(?=[=;,)])", text))


def arguments(f):
    inside = f.signature[f.signature.find("(") + 1:-1]
    for parameter in inside.split(","):
        name = re.search(r"(\w+)\s*$", parameter)
        if name and "*" not in parameter and "[" not in parameter and parameter.strip() != "void":
            yield "argument", f.start, f.start + 1, "{ " + name.group(1) + " = 0;"
    pointers = pointers_of(f)
    for i, t in enumerate(f.tokens):
        called = t.text == "(" and i > 0 and f.tokens[i - 1].is_name() and f.tokens[
            i - 1].text not in ("if", "for", "while", "switch", "return", "sizeof", "GROBO_JOINT_BIT")
        first = i + 1
        k = first
        while called and k <= t.pair:
            end = f.tokens[k]
            if end.text in OPEN:
                k = end.pair
            elif end.text == "," or k == t.pair:
                if k > first and not is_pointer(f, first, k, pointers):
                    yield "argument", f.tokens[first].start, f.tokens[k - 1].end, "0"
                first = k + 1
            k += 1


def is_pointer(f, first, end, pointers):
    words = [t.text for t in f.tokens[first:end]]
    return words[0] in ("&", "0", "NULL", "sizeof", "*") or "sizeof" in words or words[-1] in pointers


OPERATORS = (constants, units, conditions, comparisons, statements, joints, arguments)


def asserted(f):
    """Spans that only builds with assertions have: these, and functions of nothing else, which are
    called assert_... or ..._assert."""
    def asserts(name):
        return name in ("GROBO_ASSERT", "_Static_assert", "_Alignof") or re.search(
            r"^assert_|_assert$", name)
    if asserts(f.name):
        return [(f.start, f.tokens[-1].end + 1)]
    return [(t.start, f.tokens[f.tokens[i + 1].pair].end + 1) for i, t in enumerate(f.tokens)
            if asserts(t.text)]


def mutants_of(f, path):
    """Every mutant of a function, each once, in the order of the text."""
    left_out = asserted(f)
    made = {}
    for operator in OPERATORS:
        for name, start, end, new in operator(f):
            if not any(a < end and start < z for a, z in left_out):
                made.setdefault((start, end, new), (name, (start, end), new))
    mutants, times = [], {}
    for key in sorted(made):
        name, span, new = made[key]
        mutant = Mutant(f, name, path, span, new)
        times[mutant.anchor] = times.get(mutant.anchor, 0) + 1
        mutant.name(times[mutant.anchor])
        mutants.append(mutant)
    return mutants
