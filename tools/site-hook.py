"""MkDocs hook: links to files outside of docs/ become their paths, because the site has the pages alone."""
import re

OUTSIDE = re.compile(r"\[([^\]]+)\]\((?:\.\./)+((?:examples|include|scenes|tests|src|python)/[^)#]+|[A-Z]+\.md)(?:#[^)]*)?\)")


def on_page_markdown(markdown, **_):
    return OUTSIDE.sub(r"\1 (`\2`)", markdown)
