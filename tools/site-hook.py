"""MkDocs hook: replaces links to files outside of docs/ by their paths, because the site contains only the pages. Links that are called
after a file, such as live.md, get the title of its page. If tools/site built pages that play the scenes of the gallery, adds links to them."""
import os
import re

OUTSIDE = re.compile(r"\[([^\]]+)\]\((?:\.\./)+((?:examples|include|scenes|tests|src|python)/[^)#]+|[A-Z]+\.md)(?:#[^)]*)?\)")
SCENE = re.compile(r"`pellicle run ([a-z-]+)`")
NAMED = re.compile(r"\[([a-z-]+\.md)\]\(((?:\.\./)?([a-z/-]+\.md)[^)]*)\)")


def titles(entries):
    """the titles of the pages in the navigation by their paths"""
    for entry in entries:
        for title, at in entry.items():
            yield from titles(at) if isinstance(at, list) else [(at.rsplit("/", 1)[-1], title)]


def on_page_markdown(markdown, page, config, **_):
    if page.file.src_path == "gallery.md" and os.environ.get("PELLICLE_LIVE_PAGES"):
        markdown = SCENE.sub(r'\g<0> (<a href="live/\1.html">play it</a>)', markdown)
    known = dict(titles(config["nav"]))
    markdown = NAMED.sub(lambda link: f"[{known.get(link[3].rsplit('/', 1)[-1], link[1])}]({link[2]})", markdown)
    return OUTSIDE.sub(r"\1 (`\2`)", markdown)
