"""MkDocs hook: links to files outside of docs/ become their paths, because the site has the pages alone; scenes of the
gallery get a link to the page that plays them, where tools/site makes those pages."""
import os
import re

OUTSIDE = re.compile(r"\[([^\]]+)\]\((?:\.\./)+((?:examples|include|scenes|tests|src|python)/[^)#]+|[A-Z]+\.md)(?:#[^)]*)?\)")


SCENE = re.compile(r"`pellicle run ([a-z-]+)`")


def on_page_markdown(markdown, page, **_):
    if page.file.src_path == "gallery.md" and os.environ.get("PELLICLE_LIVE_PAGES"):
        markdown = SCENE.sub(r'\g<0> (<a href="live/\1.html">play it</a>)', markdown)
    return OUTSIDE.sub(r"\1 (`\2`)", markdown)
