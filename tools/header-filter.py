"""Doxygen filter: converts the comments of a header to documentation; special characters of Doxygen are escaped."""
import re
import sys


def document(match):
    start = match.string.rfind("\n", 0, match.start()) + 1
    follows_code = match.string[start : match.start()].strip() != ""
    body = re.sub(r"([\\@<>&#%$])", r"\\\1", match.group(1)).replace("`", "'")
    return ("/**<" if follows_code else "/**") + body + "*/"


text = open(sys.argv[1], encoding="utf-8").read()
sys.stdout.write(re.sub(r"/\*(.*?)\*/", document, text, flags=re.S))
