"""Types of the extension module; not for users."""

from typing import Any, Optional

class Error(RuntimeError):
    """A refused input or a failed operation."""

    status: str
    what: str
    remedy: Optional[str]
    file: Optional[str]
    line: Optional[int]
    column: Optional[int]
    element_kind: Optional[str]
    element_name: Optional[str]
    element: Optional[int]

FIELDS: tuple[tuple[str, int, str, str, bool], ...]
ARRAYS: tuple[tuple[str, str, int, bool], ...]

class Scene:
    def __init__(self, path: str, text: Optional[str], overrides: tuple[str, ...], notes: list[str], /) -> None: ...
    def __getattr__(self, name: str) -> Any: ...

class Study:
    def __init__(self, path: str, text: Optional[str], /) -> None: ...
    def __getattr__(self, name: str) -> Any: ...

class Sim:
    def __getattr__(self, name: str) -> Any: ...

def version() -> str: ...
def kernels() -> str: ...
def __getattr__(name: str) -> Any: ...
