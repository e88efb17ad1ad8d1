"""The parts of tools/docs that need neither MkDocs nor doxygen, on small texts."""
import pathlib
import sys
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(PROJECT / "tools/site"))
import check  # noqa: E402
import comments  # noqa: E402
import diagram  # noqa: E402
import pages  # noqa: E402


def for_doxygen(text):
    return "\n".join(comments.for_doxygen("a/b.h", text.splitlines()))


class Site(unittest.TestCase):
    def converted(self, text):
        """A document without links and flow charts."""
        return "\n".join(pages.converted("a.md", text.splitlines(), None, lambda link: link, lambda path: path.replace("d/x.md", "cited")))

    def test_CommentsDescribeFilesDeclarationsAndMembers(self):
        self.assertEqual(for_doxygen("// The file.\n#pragma once"), "/** \\file a/b.h The file. */\n#pragma once")
        self.assertEqual(for_doxygen("\n  // One.\n  // Two.\n  int a();"), "\n  /** One.\nTwo. */\n  int a();")
        self.assertEqual(for_doxygen("\n  int a = 0;  // rad,\n              // at rest\n  int b;"),
                         "\n  int a = 0;  ///< rad,\n              ///< at rest\n  int b;")
        self.assertEqual(for_doxygen("\n  kOk,\n  kBad  // neither\n};"), "\n  kOk,\n  kBad  ///< neither\n};")

    def test_CommentsThatDescribeNothingStay(self):
        for text in ("\n// Alone.\n\nint a;", "\n  // At the end.\n}", "\n}  // namespace sinew", "\n  // Loop.\n  for (;;) {"):
            self.assertEqual(for_doxygen(text), text)

    def test_FormulasKeepTheirFormAndNothingIsACommand(self):
        self.assertEqual(for_doxygen("\n// Law:\n//   y = a x\n//\n// `x<T>` @ 5 %, \\n.\nint a;"),
                         "\n/** Law: @verbatim\n  y = a x @endverbatim\n\n<code>x\\<T\\></code> \\@ 5 \\%, \\\\n. */\nint a;")
        self.assertEqual(for_doxygen("\n// Of two:\n//  - one\n//    goes on\n// Then.\nint a;"),
                         "\n/** Of two:\n - one\n   goes on\nThen. */\nint a;")

    def test_EveryHeaderKeepsItsLines(self):
        count = 0
        for path in (PROJECT / "components").rglob("*.h"):
            lines = path.read_text(encoding="utf-8").splitlines()
            done = "\n".join(comments.for_doxygen(path.name, lines))
            self.assertEqual(done.count("\n") + 1, len(lines), path)
            self.assertEqual(done.count("@verbatim"), done.count("@endverbatim"), path)
            count += 1
        self.assertGreater(count, 300)

    def test_ListsAreIndentedByFourColumns(self):
        self.assertEqual(self.converted("Two:\n- a\n  b\n  - c\n\n  d\n- e\n\nf"), "Two:\n\n- a\n    b\n    - c\n\n    d\n\n- e\n\nf")
        self.assertEqual(self.converted("1. a\n\n   ```sh\n   x\n     y\n   ```\n2. b"), "1. a\n\n        x\n          y\n\n2. b")
        self.assertEqual(self.converted("- a\n\n      x:\n        y"), "- a\n\n        x:\n          y")
        for text in ("a\n\n    x = y # d/x.md\n      - z", "```yaml\n- a\n  - b\n```", "a\n\n1.5 m"):
            self.assertEqual(self.converted(text), text)

    def test_LinksLeadToPagesAndHeadersToTheirApi(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for path, text in (("README.md", "# S"), ("m/README.md", "Moves. See `d/x.md`, `h.h/.cc`, `m`, d/x.md, `cat d/x.md`, [it](../d/x.md#a), [h](h.h), [t](t.csv)."),
                               ("d/x.md", "# X: a"), ("m/h.h", ""), ("m/t.csv", "1")):
                (root / path).parent.mkdir(exist_ok=True)
                (root / path).write_text(text)
            site = pages.Pages(root, root / "out", {"m/h.h": "api/h_8h.html"})
            site.add("m/README.md", ["m/h.h"])
            self.assertEqual((root / "out/m/README.md").read_text().splitlines(),
                             ["# m", "", "Moves. See [`d/x.md`](../d/x.md), [`h.h/.cc`](../api/h_8h.html), `m`, [d/x.md](../d/x.md), `cat d/x.md`, [it](../d/x.md#a), "
                              "[h](../api/h_8h.html), [t](t.csv).", "", "API: [`h.h`](../api/h_8h.html)"])
            self.assertTrue((root / "out/m/t.csv").exists())

    def test_FoldersAreSections(self):
        titles = {"b/a/README.md": "b/a", "c/README.md": "c", "c/d/README.md": "c/d", "c/d/e/README.md": "c/d/e", "c/x.md": "X: why"}
        self.assertEqual(pages.sections(titles), [{"b": "b/a/README.md"}, {"c": [
            {"c": "c/README.md"}, {"d": [{"c/d": "c/d/README.md"}, {"e": "c/d/e/README.md"}]}, {"X": "c/x.md"}]}])
        self.assertEqual(pages.sections({"docs/a.md": "A", "docs/b.md": "B"}), [{"A": "docs/a.md"}, {"B": "docs/b.md"}])

    def test_EveryDocumentIsInTheNavigation(self):
        site = pages.Pages(PROJECT, None, {})
        documents = pages.documents(PROJECT) + ["idl/joint.md"]
        site.titles = {path: path for path in documents}

        def paths(nav):
            return [nav] if isinstance(nav, str) else [path for entry in nav for part in entry.values() for path in paths(part)]

        self.assertEqual(sorted(paths(site.navigation())), sorted(documents))
        self.assertGreater(len(documents), 150)

    def test_FlowChartsBecomeGraphs(self):
        dot = diagram.to_dot(['flowchart LR', '  subgraph g["all of it"]', '    a["A, b"] --> c', '  end', '  c -.->|x| d(["D"]) & e', '  e -- no --> g'])
        for part in ('"a" [label="A, b", shape=box', '"a" -> "c" [label="", style=solid]', '"c" -> "d" [label="x", style=dotted]',
                     '"c" -> "e" [label="x", style=dotted]', '"e" -> "c" [label="no", style=solid, lhead="cluster_g"]', 'label="all of it"'):
            self.assertIn(part, dot)
        for text in ("graph LR", "flowchart LR\n  a ==> b", "flowchart LR\n  a --> "):
            with self.assertRaises(ValueError):
                diagram.to_dot(text.splitlines())

    def test_WhatIsWrongWithAPageIsFound(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            (out / "b.html").write_text('<h1 id="x">X</h1>')
            (out / "a.html").write_text('<a href="b.html#x">x</a> <a href="https://example.org">far</a> <code>**a**</code>')
            self.assertEqual(check.findings(out), (2, []))
            (out / "a.html").write_text('<a href="b.html#y">y</a> <a href="c.html">c</a> <a href="/b.html">b</a> [b](b.html)'
                                        '<script src="https://example.org/x.js"></script>')
            self.assertEqual(check.findings(out)[1], [
                "a.html -> b.html#y: no such place in the page", "a.html -> c.html: not there", "a.html -> /b.html: not there",
                "a.html loads https://example.org/x.js", "a.html shows Markdown: [b](b.html)"])
            (out / "a.html").unlink()
            (out / "a.css").write_text("@import url(//example.org/font.css);")
            self.assertEqual(check.findings(out)[1], ["a.css loads //example.org/font.css"])


if __name__ == "__main__":
    unittest.main()
