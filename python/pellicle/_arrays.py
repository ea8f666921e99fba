"""Checks of array arguments: every error message names the argument."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

Shape = tuple[Optional[int], ...]


def _show(shape: Shape) -> str:
    return " x ".join("n" if size is None else str(size) for size in shape)


def _check_shape(array: np.ndarray, name: str, shape: Shape) -> None:
    fits = array.ndim == len(shape) and all(want in (None, size) for size, want in zip(array.shape, shape))
    if not fits:
        raise ValueError(f"{name}: must have the shape {_show(shape)}, not {_show(array.shape)}")


def numbers(value: Any, name: str, shape: Shape, finite: bool = True) -> np.ndarray:
    """A C-contiguous float64 array of that shape; copies only if necessary."""
    try:
        array = np.asarray(value)
    except ValueError:
        raise ValueError(f"{name}: rows have different lengths") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: must hold numbers, not {array.dtype}")
    _check_shape(array, name, shape)
    array = np.ascontiguousarray(array, dtype=np.float64)
    if finite and not np.isfinite(array).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"{name}: {array[place]} at index {place[0] if len(place) == 1 else place}; must be finite")
    return array


def indices(value: Any, name: str, shape: Shape, count: Optional[int] = None) -> np.ndarray:
    """A C-contiguous int32 array of that shape, with values 0 .. count - 1 unless count is None."""
    try:
        array = np.asarray(value)
    except ValueError:
        raise ValueError(f"{name}: rows have different lengths") from None
    if array.size == 0:
        array = array.astype(np.int32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: must hold integers, not {array.dtype}")
    _check_shape(array, name, shape)
    if array.size and (int(array.min()) < -(2**31) or int(array.max()) >= 2**31):
        raise ValueError(f"{name}: every index must fit into 32 bits, within -2147483648 .. 2147483647")
    if count is not None and array.size and (array.min() < 0 or array.max() >= count):
        place = tuple(int(i) for i in np.argwhere((array < 0) | (array >= count))[0])
        raise ValueError(f"{name}: index {array[place]} at {place}; must be within 0 .. {count - 1}")
    return np.ascontiguousarray(array, dtype=np.int32)


def room(out: Optional[np.ndarray], shape: tuple[int, ...], dtype: Any = np.float64) -> np.ndarray:
    """A new array if `out` is None; otherwise `out`, after a check of its type and shape."""
    if out is None:
        return np.empty(shape, dtype)
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out: must be a numpy array, not {type(out).__name__}")
    if out.dtype != dtype:
        raise TypeError(f"out: must have the type {np.dtype(dtype).name}, not {out.dtype}")
    if out.shape != shape:
        raise ValueError(f"out: must have the shape {_show(shape)}, not {_show(out.shape)}")
    return out


def from_bytes(data: bytearray, dtype: Any, *shape: int) -> np.ndarray:
    """An array over the memory of `data`, without a copy."""
    return np.frombuffer(data, dtype).reshape(shape)
