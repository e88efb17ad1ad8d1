"""Builds the site for tools/docs, in the folder of the project.

  build.py OUT           the site in the folder OUT, as a whole or not at all
  build.py --headers     the public headers, a line each
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import check
import comments
import pages

HERE = pathlib.Path(__file__).parent
ROOT = HERE.parent.parent
MARK = "sinew_site.txt"  # in the folder of a site: it may be replaced
KEYWORDS = {"FILE", "FRAME", "LOCAL", "PCH", "SOURCES", "PRIVATE_HEADERS", "DEPENDS", "PRIVATE_DEPENDS"}

DOXYFILE = """PROJECT_NAME = Sinew
PROJECT_BRIEF = "Public headers"
INPUT = "{headers}"
RECURSIVE = YES
STRIP_FROM_PATH = "{headers}"
STRIP_FROM_INC_PATH = "{headers}"
OUTPUT_DIRECTORY = "{out}"
HTML_OUTPUT = api
GENERATE_TAGFILE = "{tags}"
LAYOUT_FILE = "{layout}"
HTML_EXTRA_STYLESHEET = "{style}"
GENERATE_LATEX = NO
GENERATE_TREEVIEW = YES
HTML_TIMESTAMP = NO
HAVE_DOT = NO
CLASS_GRAPH = NO
VERBATIM_HEADERS = NO
MARKDOWN_SUPPORT = NO
JAVADOC_AUTOBRIEF = YES
BUILTIN_STL_SUPPORT = YES
EXTRACT_ALL = YES
HIDE_IN_BODY_DOCS = YES
SORT_MEMBER_DOCS = NO
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = __attribute__(x)=
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
"""
LAYOUT = """<doxygenlayout version="1.0"><navindex>
<tab type="mainpage" visible="no"/>
<tab type="user" url="../index.html" title="Documents"/>
<tab type="filelist" visible="yes" title="Headers"/>
<tab type="classlist" visible="yes" title="Classes"/>
<tab type="classmembers" visible="yes" title="Members"/>
<tab type="namespacelist" visible="yes" title="Namespaces"/>
</navindex></doxygenlayout>
"""
FIRST_PAGE = """/** \\mainpage Public headers
The headers that are installed. What each is for: <a href="../api.html">list by module</a>. */
"""


def say(text):
    print(f"\n== {text}", flush=True)


def public_headers():
    """Headers among SOURCES of sinew_add_module, but for LOCAL modules: what cmake/SinewModules.cmake installs."""
    found = []
    for wing in ("bench", "bridge", "components", "reproduction", "sim", "tools"):
        for cmake in (ROOT / wing).rglob("CMakeLists.txt"):
            text = re.sub("#.*", "", cmake.read_text(encoding="utf-8"))
            for call in re.findall(r"sinew_add_module\(([^()]*)\)", text):
                keyword, words = "", call.split()
                for word in words if "LOCAL" not in words else []:
                    keyword = word if word in KEYWORDS else keyword
                    if keyword == "SOURCES" and word.endswith(".h") and "$" not in word:
                        found.append((cmake.parent / word).relative_to(ROOT).as_posix())
    return sorted(found)


def run(name, command):
    """Runs a program that must neither fail nor warn."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    text = re.sub(r"\x1b\[\d+m", "", done.stdout)  # colours
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("INFO ")]
    if done.returncode == 0 and not lines:
        return
    print(*lines, sep="\n")
    first = next((line for line in lines if re.search("warning|error", line, re.I)), f"exit code {done.returncode}")
    sys.exit(f"tools/docs: {name}: {len(lines)} lines of warnings, one of them: {first}")


def write_api(work, source, headers):
    """API pages in source/api. Returns header -> its page, and header -> [(class, its page)]."""
    for header in headers:
        copy = work / "headers" / header
        copy.parent.mkdir(parents=True, exist_ok=True)
        lines = (ROOT / header).read_text(encoding="utf-8").splitlines()
        copy.write_text("\n".join(comments.for_doxygen(header, lines)) + "\n", encoding="utf-8")
    (work / "headers" / "first_page.dox").write_text(FIRST_PAGE, encoding="utf-8")
    tags, layout, settings = work / "tags.xml", work / "layout.xml", work / "Doxyfile"
    layout.write_text(LAYOUT, encoding="utf-8")
    settings.write_text(
        DOXYFILE.format(headers=work / "headers", out=source, tags=tags, layout=layout, style=HERE / "api.css"), encoding="utf-8"
    )
    run("doxygen", ["doxygen", str(settings)])
    page, classes = {}, {}
    compounds = xml.etree.ElementTree.parse(tags).getroot().findall("compound")
    pages_of_classes = {c.findtext("name"): c.findtext("filename") for c in compounds if c.get("kind") in ("class", "struct")}
    for compound in compounds:
        if compound.get("kind") == "file":
            header = os.path.relpath(compound.findtext("path") + compound.findtext("name"), work / "headers")
            if not header.endswith(".h"):
                continue
            page[header] = f"api/{compound.findtext('filename')}"
            names = [name.text for name in compound.findall("class")]
            classes[header] = [(name, f"api/{pages_of_classes[name]}") for name in names if name in pages_of_classes]
    missing = [header for header in headers if header not in page]
    if missing:
        sys.exit(f"tools/docs: doxygen: no page of {missing[0]}")
    return page, classes


def api_page(page, classes):
    """The list of the public headers: what each is for, and its classes."""
    lines = ["# Public headers", "", "Headers that are installed, by module. Programs of your own include them as",
             "`#include \"components/...\"`; [all classes](api/annotated.html), [namespaces](api/namespaces.html)."]
    folder = None
    for header in sorted(page, key=lambda name: (os.path.dirname(name), name)):
        if os.path.dirname(header) != folder:
            folder = os.path.dirname(header)
            lines += ["", f"## {folder}", "", "| header | | classes |", "| --- | --- | --- |"]
        head = []
        for line in (ROOT / header).read_text(encoding="utf-8").splitlines():
            if not line.startswith("// ") or line[3:].startswith(" "):
                break
            head.append(line[3:])
        sentence = re.split(r"(?<=[.:;]) ", " ".join(head))[0].rstrip(":;").replace("|", "\\|").replace("<", "&lt;")
        sentence = sentence.replace("`", "") if sentence.count("`") % 2 else sentence
        names = ", ".join(f"[`{name.removeprefix('sinew::')}`]({link})" for name, link in classes[header])
        lines.append(f"| [`{os.path.basename(header)}`]({page[header]}) | {sentence} | {names} |")
    return lines


def write_pages(source, page, classes):
    """Writes all Markdown; returns the navigation."""
    site = pages.Pages(ROOT, source, page)
    for path in pages.documents(ROOT):
        folder = os.path.dirname(path)
        own = [header for header in page if os.path.basename(path) == "README.md" and os.path.dirname(header) == folder]
        site.add(path, sorted(own))
    for idl in sorted((ROOT / "idl").glob("*.idl")):
        text = idl.read_text(encoding="utf-8").splitlines()
        site.write(f"idl/{idl.stem}.md", [f"# {idl.name}", "", "```idl", *text, "```"])
    nav = site.navigation()
    site.write("api.md", api_page(page, classes))
    return nav + [{"API": [{"Public headers": "api.md"}]}]


def build_site(work, source, out, nav):
    settings = {
        "site_name": "Sinew",
        "docs_dir": str(source),
        "site_dir": str(out),
        "use_directory_urls": False,  # pages are files, so that links hold without a server
        # A theme of our own: Debian's refer to scripts that they do not have, and their search needs a server.
        "theme": {"name": None, "custom_dir": str(HERE / "theme"), "static_templates": ["search.html"], "search_index_only": True},
        "plugins": ["search"],
        "markdown_extensions": [{"toc": {"permalink": "#"}}],
        "nav": nav,
    }
    (work / "mkdocs.yml").write_text(json.dumps(settings), encoding="utf-8")  # JSON is YAML
    run("MkDocs", ["mkdocs", "build", "--strict", "--config-file", str(work / "mkdocs.yml")])
    # As a script, because a page that is opened as a file may not read another file. Whole pages repeat their sections.
    index = out / "search" / "search_index.json"
    places = [place for place in json.loads(index.read_text(encoding="utf-8"))["docs"] if "#" in place["location"]]
    (out / "search" / "index.js").write_text(f"const places = {json.dumps(places)};\n", encoding="utf-8")
    index.unlink()


def main(out):
    if out.exists() and not (out / MARK).exists() and any(out.iterdir()):
        sys.exit(f"tools/docs: {out} is there and is no site of tools/docs, expected a new folder")
    headers = public_headers()
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent, prefix=".docs_") as folder:
        work = pathlib.Path(folder)
        source, site = work / "source", work / "site"
        source.mkdir()
        say(f"API pages of {len(headers)} public headers")
        page, classes = write_api(work, source, headers)
        say("Documents")
        nav = write_pages(source, page, classes)
        build_site(work, source, site, nav)
        say("Links, places and what the pages load")
        count, found = check.findings(site)
        if found:
            print(*found, sep="\n")
            sys.exit(f"tools/docs: {len(found)} findings in the pages, the first: {found[0]}")
        (site / MARK).write_text("Written by tools/docs, which replaces this folder.\n", encoding="utf-8")
        if out.exists():
            shutil.rmtree(out)
        site.rename(out)
    size = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
    print(f"{count} pages, {size / 1e6:.0f} MB")
    print(out / "index.html")


if __name__ == "__main__":
    if sys.argv[1:] == ["--headers"]:
        print(*public_headers(), sep="\n")
    else:
        main(pathlib.Path(sys.argv[1]).absolute())
