"""Comments of the headers for doxygen: plain // comments become those that it reads. A header keeps its number of lines.

- the comment at the head of a file describes the file
- a comment directly above a declaration describes it; one behind a member, on its line, describes that member
- an indented line is a formula or a table and keeps its form; "- " begins an item of a list; `x` is code
Every other character is text: nothing in a comment is a command of doxygen.
"""
import re

COMMENT = re.compile(r"( *)//(?!/) ?(.*)$")
# A member, an argument or an enumerator, and the comment behind it.
BEHIND = re.compile(r"( *(?=[^\s/}#]).*?(?:[;,]|\bk[A-Z]\w*|\bk[A-Z]\w* = [^;{}]+?))( *)//(?!/) ?(.*)$")
NOT_DESCRIBED = re.compile(r" *(}|#|(public|protected|private):|return\b|if \(|for \(|$)")
SPECIAL = re.compile(r'([\\@<>&#%$"])')


def escaped(text):
    return SPECIAL.sub(r"\\\1", text).replace("::", "\\::")


def prose(line):
    """A line with what is between backticks as code."""
    parts = line.split("`")
    if len(parts) % 2 == 0:
        return escaped(line)
    return "".join(f"<code>{escaped(part)}</code>" if at % 2 else escaped(part) for at, part in enumerate(parts))


def described(lines):
    """The text of a comment in doxygen's commands, which stand on lines that are there."""
    out, last = [], 0  # last: the last line that is not blank
    item = form = False
    for line in lines:
        text = line.lstrip()
        indent = len(line) - len(text)
        if text:
            item = (item and indent >= 2) or (text.startswith("- ") and indent < 2)
            is_form = indent >= 2 and not item and bool(out)
            if is_form and not form:
                out[-1] += " @verbatim"
            elif form and not is_form:
                out[last] += " @endverbatim"
            form = is_form
            last = len(out)
        out.append(line if form else prose(line if item else text))
    if form:
        out[last] += " @endverbatim"
    return out


def for_doxygen(path, lines):
    """The lines of a header; path: its name in the pages."""
    out = []
    while len(out) < len(lines):
        at = end = len(out)
        while end < len(lines) and COMMENT.match(lines[end]):
            end += 1
        behind = BEHIND.match(lines[at])
        if end > at:
            text = [COMMENT.match(line)[2] for line in lines[at:end]]
            describes = at == 0 or (end < len(lines) and not NOT_DESCRIBED.match(lines[end]))
            if not describes or any("*/" in line for line in text):
                out += lines[at:end]
                continue
            block = described(text)
            block[0] = f"/** \\file {path} {block[0]}" if at == 0 else COMMENT.match(lines[at])[1] + "/** " + block[0]
            block[-1] += " */"
            out += block
        elif behind and behind[1].count('"') % 2 == 0:
            column = len(behind[1]) + len(behind[2])
            out.append(f"{behind[1]}{behind[2]}///< {prose(behind[3])}")
            while len(out) < len(lines) and lines[len(out)].startswith(" " * column + "// "):
                out.append(" " * column + "///< " + prose(lines[len(out)][column + 3 :]))
        else:
            out.append(lines[at])
    return out
