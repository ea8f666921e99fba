"""Fit parameters of a scene to measured curves: least squares within bounds, with confidence intervals.

The interval of parameter k is p_k +- t s sqrt((J^T J)^-1_kk) with Student's t for n - p degrees of freedom (n values, p
parameters), the standard deviation s of the residuals and the Jacobian J at the fit (Seber and Wild, Nonlinear Regression,
section 5.1).

Under the methods static and implicit the Jacobian is computed forward along the steps: simulations with a slightly smaller and
a slightly larger value of each parameter accompany the run. Each of their steps is solved with the matrix of the run's step,
which takes a few solutions per step instead of a whole run (pel_sim_step_beside).
"""

from __future__ import annotations

import argparse
import csv
import difflib
import json
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from html import escape
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import _core
from .mesh import PathLike
from .simulation import Scene

#: Step of the differences, relative to the range of a parameter: far above the error of a curve due to the solver's tolerance.
_STEP = 1e-3
#: If the correlation of two parameters exceeds this, the data hardly distinguish them.
_CORRELATED = 0.97
#: Residual of a run that fails, relative to the largest measured value, so that the fit avoids its parameters.
_FAILED = 10.0


class _Curve:
    """An entry of `data`: the measurement, and the way to read the same quantity from a run."""

    def __init__(self, entry: Mapping[str, Any]) -> None:
        self.entry = entry
        self.body = entry.get("body")
        self.name = os.path.basename(entry["file"])
        names, columns = _read_csv(entry["file"])
        if self.body is not None:
            vertices = _pick(entry["file"], names, columns, "vertex")
            self.vertices = vertices.astype(int)
            if (self.vertices != vertices).any():
                raise _core.Error(
                    f"{entry['file']}: error: the column vertex must contain whole numbers. write the vertex numbers of the "
                    "mesh, from 0"
                )
            self.x = np.arange(3 * len(self.vertices), dtype=float)
            self.y = np.column_stack([_pick(entry["file"], names, columns, axis) for axis in "xyz"]).ravel()
        else:
            self.x = _pick_axis(entry, "x", 0, names, columns)
            self.y = _pick_axis(entry, "y", 1, names, columns)
        size = float(np.ptp(self.y)) if self.body is not None else float(np.abs(self.y).max())
        if not size > 0:
            same = "all measured values are 0" if self.body is None else "all coordinates of the markers are equal"
            raise _core.Error(f"{entry['file']}: error: {same}. add rows with other values")
        self.unit = size
        self.scale = float(entry.get("weight", 1)) / size
        self.covered = True

    def place(self, scene: Scene, positions: list[np.ndarray]) -> Optional[np.ndarray]:
        """The positions of the entry's body, or None."""
        if self.body is None:
            return None
        if self.body not in scene.bodies:
            raise _core.Error(f"error: there is no body {self.body!r} ({self.name}). use one of " + ", ".join(scene.bodies))
        return positions[scene.bodies.index(self.body)]

    def read(self, series: Mapping[str, np.ndarray], positions: Optional[np.ndarray]) -> np.ndarray:
        """The values of a run at the measured points."""
        if self.body is not None:
            if self.vertices.min() < 0 or self.vertices.max() >= len(positions):
                raise _core.Error(
                    f"{self.entry['file']}: error: the column vertex has values {self.vertices.min()} .. {self.vertices.max()}, "
                    f"but the body {self.body!r} has the vertices 0 .. {len(positions) - 1}. correct the column vertex"
                )
            return positions[self.vertices].ravel()
        for key in ("x", "y"):
            if self.entry[key] not in series:
                raise _core.Error(
                    f"error: the series of the scene has no column {self.entry[key]!r} ({key} of {self.name}). "
                    + _advise(self.entry[key], list(series))
                )
        x = series[self.entry["x"]] * float(self.entry.get("scale_x", 1))
        y = series[self.entry["y"]] * float(self.entry.get("scale_y", 1))
        order = np.argsort(x, kind="stable")
        slack = 1e-6 * np.ptp(self.x)
        self.covered = bool(x.min() <= self.x.min() + slack and self.x.max() <= x.max() + slack)
        return np.interp(self.x, x[order], y[order])


def _advise(name: str, names: list[str]) -> str:
    near = difflib.get_close_matches(name, names, 1)
    return f"did you mean {near[0]!r}?" if near else "use one of " + ", ".join(names)


def _read_csv(path: str) -> tuple[list[str], np.ndarray]:
    names: list[str] = []
    rows = []
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        for row in reader:
            if not row or row[0].startswith("#"):
                continue
            if not names:
                names = [name.strip() for name in row]
                continue
            place = f"{path}:{reader.line_num}: error: "
            if len(row) != len(names):
                raise _core.Error(f"{place}{len(row)} cells below {len(names)} names. write one number per name")
            try:
                rows.append([float(cell) for cell in row])
            except ValueError as error:
                raise _core.Error(f"{place}{error}. write one line with names, then lines of numbers") from None
            if not np.isfinite(rows[-1]).all():
                raise _core.Error(f"{place}a number is not finite. correct or remove the line")
    if len(rows) < 2:
        raise _core.Error(
            f"{path}: error: no table of numbers: {len(rows)} lines of numbers. write one line with names, then at least two "
            "lines of numbers"
        )
    return names, np.array(rows).T


def _pick(
    path: str, names: list[str], columns: np.ndarray, name: str, place: Optional[int] = None, axis: bool = False
) -> np.ndarray:
    if name in names:
        return columns[names.index(name)]
    if place is not None and len(names) == 2:
        return columns[place]
    known = ", ".join(names)
    advice = f"name one of {known} as column_x or column_y" if axis else f"rename one of {known}"
    raise _core.Error(f"{path}: error: there is no column {name!r}. {advice}")


def _pick_axis(entry: Mapping[str, Any], axis: str, place: int, names: list[str], columns: np.ndarray) -> np.ndarray:
    """The column `column_x` or `column_y` if the entry has this key; otherwise that of the same name, or one of the only two."""
    given = entry.get(f"column_{axis}")
    return _pick(entry["file"], names, columns, given or entry[axis], None if given else place, True)


class Fit:
    """The result of `calibrate`.

    Attributes
    ----------
    values : dict of str to float
        Values of the parameters, by path.
    low, high : dict of str to float
        Limits of their confidence intervals, by path.
    confidence : float
        Confidence of the intervals, such as 0.95.
    correlation : numpy.ndarray
        Correlations of the parameters, (parameter_count, parameter_count).
    misfit : float
        Root mean square of the weighted residuals. Each residual is relative to the largest value of its curve; for markers, to
        the range of their coordinates.
    warnings : list of str
        Reasons to doubt the fit: the data do not determine a parameter or do not distinguish two parameters, a parameter is at
        its bound, a run does not cover the measured x, or the fit did not converge.
    curves : list of dict
        For each entry of the data: name, x, measured, fitted.
    evaluations : int
        Number of runs.
    derivatives : str
        Source of the Jacobian: ``"forward"`` along the steps of each run, or ``"differences"`` of whole runs.
    derivatives_reason : str
        The reason for ``"differences"``; otherwise empty.
    """

    def __init__(self, **members: Any) -> None:
        self.values: dict[str, float]
        self.__dict__.update(members)

    def __repr__(self) -> str:
        values = ", ".join(f"{path} = {value:.6g}" for path, value in self.values.items())
        return f"<Fit: {values}; misfit {self.misfit:.3g}>"

    def record(self) -> dict[str, Any]:
        """All results except the curves, as values that JSON can contain."""
        return {
            "parameters": {
                path: {"value": value, "low": self.low[path], "high": self.high[path]} for path, value in self.values.items()
            },
            "confidence": self.confidence,
            "correlation": self.correlation.tolist(),
            "misfit": self.misfit,
            "evaluations": self.evaluations,
            "derivatives": self.derivatives,
            "derivatives_reason": self.derivatives_reason,
            "warnings": self.warnings,
        }


class _Problem:
    """Residuals and their derivatives. Parameters are scaled by their range to 0 .. 1."""

    def __init__(self, fit: Mapping[str, Any], jobs: int) -> None:
        self.scene = fit["scene"]
        self.paths = list(fit["parameters"])
        rows = fit["parameters"].values()
        self.is_log = np.array([row.get("scale") == "log" for row in rows])
        self.low, self.high, start = (self._inner([float(row[key]) for row in rows]) for key in ("from", "to", "start"))
        self.start = (start - self.low) / (self.high - self.low)
        self.curves = [_Curve(entry) for entry in fit["data"]]
        self.evaluations = 0
        self.last: Optional[tuple[np.ndarray, np.ndarray]] = None
        self.reason = ""
        self.pool = ThreadPoolExecutor(jobs or os.cpu_count() or 1)

    def _inner(self, values: list[float]) -> np.ndarray:
        array = np.array(values)
        return np.where(self.is_log, np.log(np.where(self.is_log, array, 1)), array)

    def values(self, unit: np.ndarray) -> np.ndarray:
        inner = self.low + unit * (self.high - self.low)
        return np.where(self.is_log, np.exp(np.where(self.is_log, inner, 0)), inner)

    def run(self, unit: np.ndarray, beside: Sequence[np.ndarray] = ()) -> list[list[np.ndarray]]:
        """The values at the measured points, curve by curve: of a run with these parameters, then of the runs beside it."""
        scenes = [Scene(self.scene, dict(zip(self.paths, map(float, self.values(u))))) for u in (unit, *beside)]
        self.evaluations += 1
        runs = _core.series(scenes[0]._core, tuple(scene._core for scene in scenes[1:]))
        header = next(csv.reader(runs[0][0][:1]))
        beside_points = [self.points(scenes[0], header, *run) for run in runs[1:]]
        # the run itself is read last: it determines whether it covers the measurement
        return [self.points(scenes[0], header, *runs[0]), *beside_points]

    def points(self, scene: Scene, header: list[str], lines: list[str], positions: list[np.ndarray]) -> list[np.ndarray]:
        rows = [row for row in csv.reader(lines) if row != header]
        table = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows]).T
        series = dict(zip(header, table))
        return [curve.read(series, curve.place(scene, positions)) for curve in self.curves]

    def residual_of(self, points: list[np.ndarray]) -> np.ndarray:
        return np.concatenate([(p - curve.y) * curve.scale for p, curve in zip(points, self.curves)])

    def residual(self, unit: np.ndarray) -> np.ndarray:
        """Residuals of a trial. If its run fails, all residuals are large."""
        try:
            return self.evaluate(unit)
        except _core.Error:
            return np.full(sum(len(curve.y) for curve in self.curves), _FAILED)

    def evaluate(self, unit: np.ndarray) -> np.ndarray:
        """Residuals, and the Jacobian if other runs can be stepped beside this one."""
        if not self.reason:
            try:
                return self.go_forward(unit)
            except _core.Error as error:
                reason = getattr(error, "what", None) or str(error)
            # a run that also fails alone does not rule out forward derivatives: raise without keeping the reason
            residual = self.residual_of(self.run(unit)[0])
            self.reason = reason
            return residual
        return self.residual_of(self.run(unit)[0])

    def go_forward(self, unit: np.ndarray) -> np.ndarray:
        """Residuals; stores the Jacobian in `last`."""
        pairs = [self.neighbours(unit, k) for k in range(len(unit))]
        runs = self.run(unit, [side for pair in pairs for side in pair])
        residual, *beside = (self.residual_of(points) for points in runs)
        self.last = unit.copy(), self.columns(pairs, beside)
        return residual

    @staticmethod
    def columns(pairs: list[list[np.ndarray]], residuals: list[np.ndarray]) -> np.ndarray:
        return np.column_stack(
            [(residuals[2 * k + 1] - residuals[2 * k]) / (pair[1][k] - pair[0][k]) for k, pair in enumerate(pairs)]
        )

    def neighbours(self, unit: np.ndarray, k: int) -> list[np.ndarray]:
        """Two copies of the parameters: the k-th one slightly smaller and slightly larger, within the bounds."""
        pair = [unit.copy(), unit.copy()]
        pair[0][k] = max(0.0, unit[k] - _STEP)
        pair[1][k] = min(1.0, unit[k] + _STEP)
        return pair

    def jacobian(self, unit: np.ndarray) -> np.ndarray:
        if not self.reason and (self.last is None or (self.last[0] != unit).any()):
            self.evaluate(unit)
        return self.last[1] if not self.reason else self.by_differences(unit)

    def by_differences(self, unit: np.ndarray) -> np.ndarray:
        """Jacobian by differences, central except at the bounds. The runs are executed in parallel."""
        pairs = [self.neighbours(unit, k) for k in range(len(unit))]
        sides = [side for pair in pairs for side in pair]
        return self.columns(pairs, list(self.pool.map(lambda u: self.residual_of(self.run(u)[0]), sides)))


def _statistics(problem: _Problem, unit: np.ndarray, confidence: float) -> dict[str, Any]:
    """Intervals, correlations, misfit and warnings, from the Jacobian at the fit."""
    from scipy.stats import t as student

    residual, jacobian = problem.residual(unit), problem.jacobian(unit)
    count, size = jacobian.shape
    warnings = []
    sensitivity = np.linalg.norm(jacobian, axis=0)
    known = sensitivity > 1e-6 * max(float(sensitivity.max()), 1e-12)
    for path in np.array(problem.paths)[~known]:
        warnings.append(f"the data do not depend on {path}: remove this parameter, or add data that depend on it")
    freedom = max(1, count - size)
    if count <= size:
        warnings.append(f"{count} measured values are too few for intervals of {size} parameters: add data")
    spread = float(residual @ residual) / freedom
    covariance = np.full((size, size), np.nan)
    kept = np.flatnonzero(known)
    part = jacobian[:, kept]
    covariance[np.ix_(kept, kept)] = spread * np.linalg.pinv(part.T @ part)
    half = student.ppf(0.5 + confidence / 2, freedom) * np.sqrt(np.diag(covariance))
    deviation = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(deviation, deviation) if (deviation[kept] > 0).all() else np.eye(size)
    for i in range(size):
        for j in range(i):
            if known[i] and known[j] and abs(correlation[i, j]) > _CORRELATED:
                warnings.append(
                    f"{problem.paths[j]} and {problem.paths[i]} are correlated by {correlation[i, j]:.3f}: these data "
                    "hardly distinguish them. fix one of them, or add data of another kind"
                )
    for k, path in enumerate(problem.paths):
        if unit[k] < 1e-6 or unit[k] > 1 - 1e-6:
            bound = "lower bound: decrease from" if unit[k] < 0.5 else "upper bound: increase to"
            warnings.append(f"{path} = {problem.values(unit)[k]:.6g} is at its {bound}")
    for curve in problem.curves:
        if not curve.covered:
            warnings.append(
                f"{curve.name}: the run does not reach all measured x; beyond its ends its end values were compared. "
                "change the scene so that the run covers them, or remove these rows"
            )
    interval = [np.where(np.isnan(half), side, problem.values(unit + sign * half)) for side, sign in ((-np.inf, -1), (np.inf, 1))]
    return {
        "low": dict(zip(problem.paths, map(float, interval[0]))),
        "high": dict(zip(problem.paths, map(float, interval[1]))),
        "correlation": correlation,
        "misfit": float(np.sqrt(np.mean(residual**2))),
        "warnings": warnings,
    }


def calibrate(
    fit: Union[PathLike, Mapping[str, Any]], folder: Optional[PathLike] = None, jobs: int = 0
) -> Fit:
    """Fit parameters of a scene to measured curves.

    Parameters
    ----------
    fit : path or mapping
        A fit file, or a dict with its keys (docs/sweeps.md). In a dict, paths are relative to the current folder.
    folder : path, optional
        Folder for fit.json, curves.csv and fit.svg; created if it does not exist.
    jobs : int
        Maximum number of simultaneous runs; 0: one per processor.

    Returns
    -------
    Fit

    Raises
    ------
    Error
        The fit or its data are refused, or the run with the start values fails.
    ImportError
        scipy is not installed.
    """
    from scipy.optimize import least_squares

    if not isinstance(jobs, int) or not 0 <= jobs <= 1024:
        raise ValueError(f"jobs: must be an integer within 0 .. 1024, not {jobs!r}")
    if not isinstance(fit, Mapping):
        fit = json.loads(_core.load_fit(os.path.abspath(os.fspath(fit))))
    problem = _Problem(fit, jobs)
    confidence = float(fit.get("confidence", 0.95))
    with problem.pool:
        # raise the error of a wrong scene or column; during the fit, errors only become large residuals
        problem.run(problem.start)
        found = least_squares(
            problem.residual,
            np.clip(problem.start, 1e-9, 1 - 1e-9),
            problem.jacobian,
            bounds=(0, 1),
            xtol=1e-8,
            ftol=1e-10,
            gtol=1e-10,
            max_nfev=int(fit.get("max_evaluations", 100)),
        )
        members = _statistics(problem, found.x, confidence)
    if found.status == 0:
        limit = int(fit.get("max_evaluations", 100))
        members["warnings"].append(
            f"the fit did not converge within {limit} evaluations: increase max_evaluations, or use start values closer to the "
            "solution"
        )
    points = problem.run(found.x)[0]
    result = Fit(
        values=dict(zip(problem.paths, map(float, problem.values(found.x)))),
        confidence=confidence,
        evaluations=problem.evaluations,
        derivatives="differences" if problem.reason else "forward",
        derivatives_reason=problem.reason,
        curves=[
            {"name": curve.name, "x": curve.x, "measured": curve.y, "fitted": p} for curve, p in zip(problem.curves, points)
        ],
        **members,
    )
    if folder is not None:
        _write(result, os.fspath(folder), fit)
    return result


# ---- files ----


def _whole(path: str, text: str) -> None:
    with open(path + ".new", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".new", path)


def _write(fit: Fit, folder: str, source: Mapping[str, Any]) -> None:
    os.makedirs(folder, exist_ok=True)
    _whole(os.path.join(folder, "fit.json"), json.dumps(fit.record(), indent=2) + "\n")
    lines = ["data,x,measured,fitted"]
    for curve in fit.curves:
        for row in zip(curve["x"], curve["measured"], curve["fitted"]):
            lines.append(",".join([curve["name"].replace(",", " "), *(repr(float(v)) for v in row)]))
    _whole(os.path.join(folder, "curves.csv"), "\n".join(lines) + "\n")
    _whole(os.path.join(folder, "fit.svg"), _picture(fit, source))


def _picture(fit: Fit, source: Mapping[str, Any]) -> str:
    """SVG picture with one panel per entry of the data: measured points and fitted curve."""
    panels = []
    for number, curve in enumerate(fit.curves):
        entry, top = source["data"][number], 40 + 300 * number
        x, points, line = curve["x"], curve["measured"], curve["fitted"]
        labels = entry.get("x"), entry.get("y"), "measured (points) and the fit (line)"
        if "body" in entry:
            # plot fitted positions of markers over measured ones
            x, points, line = points, line, points
            labels = "measured position [m]", "position in the fit [m]", "markers (points) and equality (line)"
        order = np.argsort(x)
        x, points, line = x[order], points[order], line[order]
        low, high = min(points.min(), line.min()), max(points.max(), line.max())
        px = 90 + 580 * (x - x[0]) / (x[-1] - x[0] or 1)
        py, pf = (top + 220 - 200 * (v - low) / (high - low or 1) for v in (points, line))
        dots = "".join(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="none" stroke="#1f6fb4"/>' for a, b in zip(px, py))
        path = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(px, pf))
        panels.append(
            f'<path d="M90 {top}V{top + 220}H670" fill="none" stroke="#555"/>{dots}'
            f'<polyline points="{path}" fill="none" stroke="#c03030" stroke-width="1.5"/>'
            f'<text x="90" y="{top + 238}">{x[0]:.4g}</text><text x="670" y="{top + 238}" text-anchor="end">{x[-1]:.4g}</text>'
            f'<text x="380" y="{top + 250}" text-anchor="middle">{escape(labels[0])}</text>'
            f'<text x="84" y="{top + 224}" text-anchor="end">{low:.4g}</text>'
            f'<text x="84" y="{top + 24}" text-anchor="end">{high:.4g}</text>'
            f'<text x="96" y="{top + 4}">{escape(labels[1])}: {escape(curve["name"])}, {labels[2]}</text>'
        )
    height = 40 + 300 * len(panels)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="700" height="{height}" font-family="sans-serif" font-size="12">'
        f'<rect width="700" height="{height}" fill="white"/>{"".join(panels)}</svg>\n'
    )


def _print(fit: Fit, folder: str) -> None:
    for path, value in fit.values.items():
        print(f"{path} = {value:.6g}  ({fit.low[path]:.6g} to {fit.high[path]:.6g}, {100 * fit.confidence:g} %)")
    print(f"misfit {100 * fit.misfit:.3g} % of the largest values, {fit.evaluations} runs, derivatives by {fit.derivatives}")
    print(f"results in {folder}: fit.json, curves.csv, fit.svg")


def main(words: list[str]) -> int:
    """Execute the command line `words`; return the exit status."""
    parser = argparse.ArgumentParser(prog="pellicle calibrate")
    parser.add_argument("fit")
    parser.add_argument("--output")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quiet", action="store_true")
    arguments = parser.parse_args(words)
    stem = os.path.splitext(os.path.basename(arguments.fit))[0]
    folder = arguments.output or os.path.join("results", stem)
    try:
        fit = calibrate(arguments.fit, folder)
    except _core.Error as error:
        print(error, file=sys.stderr)
        return 2
    for warning in fit.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    if arguments.json:
        print(json.dumps(fit.record(), indent=2))
    elif not arguments.quiet:
        _print(fit, folder)
    return 0
