"""Reads a site as it was built: links lead to pages and places of it, nothing is loaded from elsewhere, no Markdown is left."""
import html.parser
import os
import pathlib
import re
import urllib.parse


class Page(html.parser.HTMLParser):
    """What a page refers to, the places in it that can be referred to, and text that looks like Markdown."""

    LOADED = {"script": "src", "img": "src", "link": "href", "iframe": "src"}
    RAW = re.compile(r"\| ?---|```|\]\(|^#+ |\*\*|\n[-*] ")

    def __init__(self, text):
        super().__init__()
        self.places, self.links, self.loaded, self.raw = set(), [], [], []
        self.inside = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.places |= {attributes.get("id"), attributes.get("name")}
        if tag == "a" and attributes.get("href"):
            self.links.append(attributes["href"])
        elif attributes.get(self.LOADED.get(tag, "")):
            self.loaded.append(attributes[self.LOADED[tag]])
        if tag in ("pre", "code", "script", "style"):
            self.inside.append(tag)

    def handle_endtag(self, tag):
        if self.inside and self.inside[-1] == tag:
            self.inside.pop()

    def handle_data(self, data):
        if not self.inside and self.RAW.search(data):
            self.raw.append(data.strip()[:60])


def findings(out):
    """The number of pages of a site, and what is wrong with them."""
    read = {path: Page(path.read_text(encoding="utf-8", errors="replace")) for path in sorted(out.rglob("*.html"))}
    found = []
    for path, page in read.items():
        name = path.relative_to(out)
        api = name.parts[0] == "api"
        for link in page.links + page.loaded:
            url = urllib.parse.urlsplit(link)
            if url.scheme or url.netloc:
                if link in page.loaded and url.scheme not in ("data", "javascript"):
                    found.append(f"{name} loads {link}")
                continue
            there = pathlib.Path(os.path.normpath(path.parent / urllib.parse.unquote(url.path))) if url.path else path
            place = urllib.parse.unquote(url.fragment)
            if out not in there.parents or not there.exists():
                found.append(f"{name} -> {link}: not there")
            elif place and there in read and place not in read[there].places and not api:
                found.append(f"{name} -> {link}: no such place in the page")
        if not api:
            found += [f"{name} shows Markdown: {text}" for text in page.raw]
    for style in out.rglob("*.css"):
        for url in re.findall(r"""(?:url\(|@import )['"]?((?:https?:)?//[^'")]+)""", style.read_text(encoding="utf-8", errors="replace")):
            found.append(f"{style.relative_to(out)} loads {url}")
    return len(read), found
