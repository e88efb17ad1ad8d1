"""Flow charts of the documents (mermaid) as pictures: graphviz draws them, so that a page needs no program of others.

Read are `flowchart TB` or LR, subgraph ... end, nodes a, a["text"], a([text]), a[(text)], a{text}, lists a & b, and chains of
-->, -.->, -- text -->, each with |text|. Anything else is an error.
"""
import re
import subprocess

SHAPES = (("([", "])", "box", "rounded"), ("[(", ")]", "cylinder", ""), ("[", "]", "box", ""), ("{", "}", "diamond", ""))
NODE = re.compile(r"\s*([\w/]+)")
EDGE = re.compile(r"\s*(?:(-->|-\.->)(?:\|([^|]*)\|)?|-- (.+?) -->)")


class Chart:
    def __init__(self):
        self.shapes = {}  # node -> attributes
        self.groups = {}  # subgraph -> its nodes
        self.edges = []

    def node(self, line, at, group):
        """The node at that place of a line, and the place behind it."""
        match = NODE.match(line, at)
        if not match:
            raise ValueError(f"no node at '{line[at:]}'")
        name, at = match[1], match.end()
        if name in self.groups:
            return name, at
        if name not in self.shapes:
            self.shapes[name] = f'label="{name}", shape=box'
            if group:
                self.groups[group].append(name)
        for begin, end, shape, style in SHAPES:
            if line.startswith(begin, at):
                close = line.index(end, at)
                label = line[at + len(begin) : close].strip('"')
                self.shapes[name] = f'label="{label}", shape={shape}, style="{style}"'
                return name, close + len(end)
        return name, at

    def nodes(self, line, at, group):
        found = []
        while True:
            name, at = self.node(line, at, group)
            found.append(name)
            if not line.startswith(" & ", at):
                return found, at
            at += 3

    def statement(self, line, group):
        left, at = self.nodes(line, 0, group)
        while at < len(line.rstrip()):
            match = EDGE.match(line, at)
            if not match:
                raise ValueError(f"neither an arrow nor an end at '{line[at:]}'")
            right, at = self.nodes(line, match.end(), group)
            label = (match[2] or match[3] or "").strip('"')
            style = "dotted" if match[1] == "-.->" else "solid"
            self.edges += [(a, b, f'label="{label}", style={style}') for a in left for b in right]
            left = right

    def end_of(self, name, key):
        """A group's end of an arrow is its middle node, cut at the frame."""
        if name not in self.groups:
            return name, ""
        return self.groups[name][len(self.groups[name]) // 2], f', {key}="cluster_{name}"'


def to_dot(lines):
    """Lines of a flow chart as a graph of graphviz."""
    direction = re.fullmatch(r"flowchart (TB|LR)", lines[0].strip())
    if not direction:
        raise ValueError(f"'{lines[0]}' begins no flow chart")
    chart, group, titles = Chart(), None, {}
    for line in lines[1:]:
        begin = re.fullmatch(r'\s*subgraph (\w+)(?:\["(.*)"\])?', line)
        if begin:
            group = begin[1]
            chart.groups[group] = []
            titles[group] = begin[2] or group
        elif line.strip() == "end":
            group = None
        elif line.strip():
            chart.statement(line, group)
    out = [f"digraph {{ rankdir={direction[1]}; compound=true; nodesep=0.2; ranksep=0.4;"]
    out.append('node [fontname="Helvetica", fontsize=11, height=0.3]; edge [fontname="Helvetica", fontsize=9, arrowsize=0.6];')
    out += [f'"{name}" [{attributes}];' for name, attributes in chart.shapes.items()]
    for name, members in chart.groups.items():
        inside = " ".join(f'"{member}";' for member in members)
        out.append(f'subgraph "cluster_{name}" {{ label="{titles[name]}"; fontname="Helvetica"; fontsize=11; color=gray; {inside} }}')
    for begin, end, attributes in chart.edges:
        begin, tail = chart.end_of(begin, "ltail")
        end, head = chart.end_of(end, "lhead")
        out.append(f'"{begin}" -> "{end}" [{attributes}{tail}{head}];')
    return "\n".join(out + ["}"])


def draw(lines):
    """The flow chart as SVG."""
    return subprocess.run(["dot", "-Tsvg"], input=to_dot(lines), capture_output=True, text=True, check=True).stdout
