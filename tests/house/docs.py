#!/usr/bin/env python3
"""Checks the pages: links lead to files and headings that exist, and every pellicle command that a page shows is one that
the program knows, with options that it has; `pellicle run` and `check` name a scene that exists; the site lists each page.

usage: docs.py ROOT PROGRAM
"""
import re
import shlex
import subprocess
import sys
from pathlib import Path

LINK = re.compile(r"\]\(([^)\s]+)\)")
WORDS_OF_ANOTHER_PROGRAM = {"|", ">", ";", "&&", "#", "<(", "2>"}


def pages(root):
    for page in sorted(root.glob("*.md")) + sorted(root.glob("docs/**/*.md")) + sorted(root.glob("examples/**/*.md")):
        yield page, page.read_text()


def anchors(text):
    for heading in re.findall(r"^#+ (.*)$", text, re.M):
        yield re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")


def links(root, found):
    for page, text in pages(root):
        for target in LINK.findall(re.sub(r"`[^`\n]*`", "", text)):
            path, _, anchor = target.partition("#")
            if "://" in target or target.startswith("mailto:"):
                continue
            file = (page.parent / path) if path else page
            if not file.exists():
                found.append(f"{page.relative_to(root)}: link to {target}, which does not exist")
            elif anchor and file.suffix == ".md" and anchor not in set(anchors(file.read_text())):
                found.append(f"{page.relative_to(root)}: link to {target}: there is no such heading")


def commands(text):
    """the commands of indented and fenced lines, without prompt and comment"""
    joined = text.replace("\\\n", " ")
    for line in re.findall(r"^(?:    |\$ )?(pellicle .*)$", joined, re.M):
        try:
            words = shlex.split(line, comments=True)
        except ValueError:
            continue
        for i, word in enumerate(words):
            if word in WORDS_OF_ANOTHER_PROGRAM:
                words = words[:i]
                break
        yield line, words[1:]


def known(program):
    overview = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    table = {}
    for name in re.findall(r"^  ([a-z]+) +", overview, re.M):
        page = subprocess.run([program, name, "--help"], capture_output=True, text=True, check=True).stdout
        table[name] = set(re.findall(r"^ +(?:-\w, )?(--[\w-]+)", page, re.M)) | set(re.findall(r"^ +(-\w),", page, re.M))
    return table


def check_command(root, words, table):
    if not words or words[0].startswith("-"):
        return None
    if words[0] not in table:
        return f"there is no command '{words[0]}'"
    for word in words[1:]:
        if re.match(r"--?[a-z]", word) and word.split("=")[0] not in table[words[0]]:
            return f"'{words[0]}' has no option '{word}'"
    scene = words[1] if len(words) > 1 else ""
    if words[0] == "run" and re.fullmatch(r"scenes/[\w-]+\.yaml", scene) and not (root / scene).exists():
        return f"there is no {scene}"
    if words[0] == "run" and re.fullmatch(r"[a-z][a-z-]+", scene) and not (root / "scenes" / f"{scene}.yaml").exists():
        return f"there is no scene '{scene}'"
    return None


def main():
    root, program = Path(sys.argv[1]), sys.argv[2]
    found = []
    links(root, found)
    named = (root / "mkdocs.yml").read_text()
    found += [f"{page.relative_to(root)}: mkdocs.yml does not list it" for page in root.glob("docs/**/*.md") if f" {page.relative_to(root / 'docs')}\n" not in named]
    table = known(program)
    count = 0
    for page, text in pages(root):
        for line, words in commands(text):
            count += 1
            wrong = check_command(root, words, table)
            if wrong:
                found.append(f"{page.relative_to(root)}: {wrong}: {line}")
    print("\n".join(found) if found else f"{count} commands and all links are right")
    if count < 20:
        print("fewer than 20 commands were found: the pages are read wrongly")
    return 1 if found or count < 20 else 0


if __name__ == "__main__":
    sys.exit(main())
