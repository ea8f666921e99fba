"""Writes maps, lists, texts and numbers as YAML."""

import json


def is_short(value):
    """Whether a value is one line: numbers, texts, lists of them, and what has no more than 90 characters."""
    if isinstance(value, list) and not any(isinstance(item, (dict, list)) for item in value):
        return True
    return not isinstance(value, (dict, list)) or len(json.dumps(value)) <= 90


def flow(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key}: {flow(item)}" for key, item in value.items()) + " }" if value else "{}"
    if isinstance(value, list):
        return "[" + ", ".join(flow(item) for item in value) + "]"
    # JSON's texts and numbers are YAML's; words need no quotes
    is_word = isinstance(value, str) and value.replace("-", "").isalpha() and value.lower() not in {"true", "false", "null", "yes", "no"}
    return value if is_word else json.dumps(value)


def lines(value, indent=""):
    """The lines of a map or list in block style; short parts are on one line."""
    pairs = [(f"{key}:", item) for key, item in value.items()] if isinstance(value, dict) else [("-", item) for item in value]
    for head, item in pairs:
        if is_short(item):
            yield f"{indent}{head} {flow(item)}"
        elif head == "-" and isinstance(item, dict):
            first, *rest = lines(item, indent + "  ")
            yield f"{indent}- {first.strip()}"
            yield from rest
        else:
            yield f"{indent}{head}"
            yield from lines(item, indent + "  ")


def dump(value):
    return "\n".join(lines(value)) + "\n"
