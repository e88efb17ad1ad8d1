"""The project's Markdown as pages of the site: a copy with the folders of the project, so that links between documents hold,
and a navigation made from these folders.

GitHub shows a document as it is; MkDocs reads Markdown more strictly. The copy differs by
- a heading, where a module's README begins with what the module is for
- items of lists indented by four columns, their blocks of code by eight
- flow charts as pictures
- links to public headers as links to their API pages
- cited paths of documents, modules and public headers as links
"""
import os
import pathlib
import re

import diagram

# Groups of the navigation: title, and expressions for its documents, in this order. A document is in the first that
# matches it; the rest of a folder is matched as a whole, so that a new document has a place.
GROUPS = (
    ("Start", ("README.md", "docs/first-bench.md", "docs/tutorial.md", "docs/glossary.md", "ARCHITECTURE.md", "CHANGELOG.md")),
    ("How to", ("docs/how-to/.*",)),
    ("Robot", ("docs/bring-up.md", "docs/safety.md", "docs/participants/.*", "idl/.*")),
    ("Data and models", ("docs/closing-the-loop.md", "docs/data-gate.md", "docs/model.md", "docs/experiments.md",
                         "docs/real-data.md", "docs/rerun.md", "docs/interchange.md", "docs/formats.*")),
    ("Published results", ("reproduction/docs/.*",)),
    ("Robots", ("robots/.*",)),
    ("Development", ("docs/[^/]*", "docs/decisions/.*")),
    ("Modules", (".*",)),
)
TITLES = {"idl": "Topics"}  # of READMEs without one, beside folders of docs/
HIDDEN = {"build", "install", "node_modules"}
LINK = re.compile(r"(\]\()([^)#\s]+)([^)]*\))")
# What may be a path: between backticks, or a document in the text. Links and other code are matched as a whole, and stay.
PATH = re.compile(r"(\[[^\]]*\]\([^)]*\)|\[[^\]]*$|^[^\[\]]*\]\([^)]*\))|(`[^`]*`)|\b((?:[\w-]+/)+[\w-]+\.md)\b")
FENCE = re.compile(r"( *)```(\w*)")
ITEM = re.compile(r"( *)([-*]|\d+\.) ")


def documents(root):
    """All Markdown files of the project, from its root."""
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders if name not in HIDDEN and not name.startswith("."))
        at = pathlib.Path(folder).relative_to(root)
        found += [(at / name).as_posix() for name in sorted(names) if name.endswith(".md")]
    return found


def heading(path, lines):
    """The title of a document: its first line, or of a README without one the folder."""
    if lines and lines[0].startswith("# "):
        return lines[0][2:].replace("`", "")
    folder = os.path.dirname(path)
    if folder.startswith("docs/"):
        return folder.removeprefix("docs/").capitalize()
    return TITLES.get(folder, folder) if os.path.basename(path) == "README.md" else path.removesuffix(".md")


def with_diagram(path, number, lines, target):
    """Writes the picture of a flow chart beside the page; the lines that show it."""
    name = f"{pathlib.Path(path).stem}_{number}.svg"
    try:
        picture = diagram.draw(lines)
    except ValueError as error:
        raise SystemExit(f"{path}: the flow chart cannot be drawn: {error}") from error
    (target / path).with_name(name).write_text(picture, encoding="utf-8")
    return [f'<div class="diagram"><a href="{name}"><img alt="Diagram {number}" src="{name}"></a></div>']


def parts(lines):
    """The lines of a document, one by one, but blocks of code as lists with their fences."""
    block = []
    for line in lines:
        fence = FENCE.match(line)
        if not fence and not block:
            yield line
            continue
        block.append(line)
        if fence and len(block) > 1:
            yield block
            block = []
    if block:
        yield block


def content(block):
    """The lines between its fences."""
    return [line for line in block if not FENCE.match(line)]


class Lists:
    """Where a document is in its lists."""

    def __init__(self):
        self.inside = False
        self.several = False  # the item has several paragraphs

    def enter(self, line, below_text):
        """Goes on to a line outside of code; below_text: the line above it is not empty. True: the page needs an empty one
        between the two, because an item of the project may follow a paragraph directly."""
        text = line.lstrip()
        indent = len(line) - len(text)
        item = bool(ITEM.match(line)) and (self.inside or indent < 4)
        apart = item and below_text and (self.several or not self.inside)
        self.several = not item and (self.several or not text)
        self.inside = item or (self.inside and (not text or indent > 0 or below_text))
        return apart


def shown_code(block, in_list):
    """A block of code; inside of an item it is indented instead of fenced."""
    indent = len(FENCE.match(block[0])[1])
    if not (in_list and indent):
        return block
    return ["        " + line[indent:] if line else line for line in content(block)]


def shown_text(line, in_list, link, cited):
    """A line outside of blocks of code."""
    text = line.lstrip()
    indent = len(line) - len(text)
    if indent >= (6 if in_list else 4):  # code
        return "  " + line if in_list else line
    if in_list and indent:
        line = "    " + text
    line = LINK.sub(lambda match: match[1] + link(match[2]) + match[3], line)
    return PATH.sub(lambda match: match[1] or cited(match[0]), line)


def converted(path, lines, target, link, cited):
    """The lines of a document as MkDocs reads them; link(target of a link) and cited(path) are what the page has instead."""
    out, charts, lists = [], 0, Lists()
    for part in parts(lines):
        if isinstance(part, str):
            if lists.enter(part, below_text=bool(out and out[-1])):
                out.append("")
            out.append(shown_text(part, lists.inside, link, cited))
        elif FENCE.match(part[0])[2] == "mermaid":
            charts += 1
            out += with_diagram(path, charts, content(part), target)
        else:
            out += shown_code(part, lists.inside)
    return out


class Pages:
    """Pages that were written below a folder, with their titles."""

    def __init__(self, root, target, api_of):
        """api_of: header -> its API page, from the root of the site."""
        self.root, self.target = root, target
        self.pages = {path: path for path in documents(root)} | api_of  # what can be linked to
        self.pages |= {os.path.dirname(path): path for path in self.pages if os.path.basename(path) == "README.md"}
        self.titles = {}

    def write(self, path, lines):
        self.titles[path] = heading(path, lines)
        if not lines[0].startswith("# "):
            lines = [f"# {self.titles[path]}", "", *lines]
        page = self.target / path
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def add(self, path, headers):
        """The page of a document; headers: those of its folder, which are listed below it."""
        folder = os.path.dirname(path)

        def link(target):
            there = os.path.normpath(os.path.join(folder, target))
            if there in self.pages:
                return os.path.relpath(self.pages[there], folder or ".")
            if "://" not in target and (self.root / there).is_file():
                copy = self.target / there
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.write_bytes((self.root / there).read_bytes())
            return target

        def cited(word):
            name = word.strip("`").removesuffix("/.cc").rstrip("/")  # `rls.h/.cc` is header and source
            for there in (os.path.normpath(os.path.join(folder, name)), name):
                if there and self.pages.get(there, path) != path:
                    return f"[{word}]({os.path.relpath(self.pages[there], folder or '.')})"
            return word

        (self.target / folder).mkdir(parents=True, exist_ok=True)
        lines = (self.root / path).read_text(encoding="utf-8").splitlines()
        lines = converted(path, lines, self.target, link, cited)
        if headers:
            links = [f"[`{header.removeprefix(folder + '/')}`]({link(header.removeprefix(folder + '/'))})" for header in headers]
            lines += ["", "API: " + ", ".join(links)]
        self.write(path, lines)

    def navigation(self):
        """The nav of MkDocs: groups of pages and folders."""
        left, nav = dict(self.titles), []
        for title, patterns in GROUPS:
            chosen = []
            for pattern in patterns:
                found = [path for path in left if path not in chosen and re.fullmatch(pattern, path)]
                if not found:
                    raise SystemExit(f"tools/site/pages.py: no document matches '{pattern}' of the group '{title}'")
                chosen += found
            nav.append({title: sections({path: left.pop(path) for path in chosen})})
        return nav


def sections(titles):
    """Pages of a group as a list of MkDocs, in their order; a folder whose README is among them is a section that begins with
    it, and so is a folder of the project without one, unless it is all of the group."""
    folders = {os.path.dirname(path) for path in titles if os.path.basename(path) == "README.md"} - {""}
    tops = {path.split("/")[0] for path in titles if "/" in path} - {"docs"}
    folders |= tops if len(tops) > 1 else set()
    base = "" if len(tops) != 1 else next(iter(tops))
    inside = {"": []}  # folder -> entries

    def section(folder):
        """The folder nearest above that is a section, and its entries, which are entered where they belong."""
        while folder not in folders and folder:
            folder = os.path.dirname(folder)
        if folder not in inside:
            above, entries = section(os.path.dirname(folder))
            inside[folder] = []
            readme = titles.get(f"{folder}/README.md", folder)
            entries.append({short(readme, above): inside[folder]})
        return folder, inside[folder]

    for path, title in titles.items():
        folder, entries = section(os.path.dirname(path))
        entry = short(title, folder or base)
        first = path == f"{folder}/README.md"
        entries.insert(0 if first else len(entries), {entry: path})
    return flat(inside[""])


def flat(entries):
    """Entries whose sections of a single page are that page."""
    out = []
    for entry in entries:
        ((title, what),) = entry.items()
        if isinstance(what, list):
            what = flat(what)
            what = next(iter(what[0].values())) if len(what) == 1 else what
        out.append({title: what})
    return out


def short(title, folder):
    """The title of a page below a section: what is before a colon, without the path of the section."""
    return title.split(": ")[0].removeprefix(folder + "/")
