"""MkDocs hook: links to files outside of docs/ become their paths, because the site has the pages alone."""
import re

OUTSIDE = re.compile(r"\[([^\]]+)\]\((?:\.\./)+((?!docs/)[^)#]+)(#[^)]*)?\)")
FROM_ROOT = {"examples", "include", "scenes", "tests", "src", "python"}


def on_page_markdown(markdown, **_):
    def path(match):
        folder = match.group(2).split("/")[0]
        if folder not in FROM_ROOT and "." not in folder:
            return match.group(0)
        return match.group(0) if match.group(2).endswith(".md") else f"{match.group(1)} (`{match.group(2)}`)"

    return OUTSIDE.sub(path, markdown)
