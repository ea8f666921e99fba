"""Files that are installed beside the package: scenes and the page of reports."""

from __future__ import annotations

import os
import sys
from typing import Optional

_HERE = os.path.dirname(os.path.abspath(__file__))


def shared(name: str) -> Optional[str]:
    """Path of a file of share/pellicle, or None. The package lies four folders below the prefix: lib/pythonX.Y/site-packages/pellicle."""
    prefixes = [os.path.normpath(os.path.join(_HERE, "../../../..")), sys.prefix, "/usr/local", "/usr"]
    paths = [os.path.join(prefix, "share/pellicle", name) for prefix in prefixes]
    # in the build folder of the source tree
    paths.append(os.path.join(prefixes[0], name))
    return next((path for path in paths if os.path.isfile(path)), None)


def scene(path: str) -> str:
    """The installed scene of this name where `path` is a name like "balloon" and no file; else `path`."""
    if os.path.exists(path) or os.path.basename(path) != path or "." in path:
        return path
    return shared(f"scenes/{path}.yaml") or path
