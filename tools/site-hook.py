"""MkDocs hook: replaces links to files outside of docs/ by their paths, because the site contains only the pages. If tools/site
built pages that play the scenes of the gallery, adds links to them."""
import os
import re

OUTSIDE = re.compile(r"\[([^\]]+)\]\((?:\.\./)+((?:examples|include|scenes|tests|src|python)/[^)#]+|[A-Z]+\.md)(?:#[^)]*)?\)")


SCENE = re.compile(r"`pellicle run ([a-z-]+)`")


def on_page_markdown(markdown, page, **_):
    if page.file.src_path == "gallery.md" and os.environ.get("PELLICLE_LIVE_PAGES"):
        markdown = SCENE.sub(r'\g<0> (<a href="live/\1.html">play it</a>)', markdown)
    return OUTSIDE.sub(r"\1 (`\2`)", markdown)
