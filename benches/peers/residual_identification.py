"""PySINDy and Operon on what a nominal model leaves over in concealed synthetic cases.

Usage: residual_identification.py TABLES [--markdown FILE] [--first N] [--limit N]
"""

import argparse
import copy
import csv
import json
import os
import re
import time
import warnings
from pathlib import Path

# One thread, as the time that is told says; before numpy reads it.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np  # noqa: E402

# Never a variable of an equation: what is to be explained, the truth, and labels.
NOT_A_CHANNEL = {"run", "held_out", "residual", "hidden"}
SEED = 1


# The model's acceleration is the force less what depends on speed: a sparse regression cannot tell them apart, so that
# each program is run without the one and without the other, and keeps what does better on runs left out.
EITHER = ("force_n", "acceleration_m_s2")


class Case:
    """One table, with the free parameters calibrated away on the fitted runs."""

    def __init__(self, path):
        self.about = json.loads(path.with_suffix(".json").read_text())
        with path.open() as file:
            rows = list(csv.DictReader(file))
        self.runs = np.array([row["run"] for row in rows])
        held = np.array([row["held_out"] == "1" for row in rows])
        columns = {
            name: np.array([float(row[name]) for row in rows])
            for name in rows[0]
            if name not in ("run", "held_out")
        }
        self.fit, self.held = ~held, held
        noise = max(self.about["noise"], 1e-9)
        free = [values for name, values in columns.items() if name.startswith("free:")]
        self.y = columns["residual"] - calibrated(columns["residual"], free, self.fit, noise)
        # What the free parameters take of the hidden force no program sees, so that it is not asked for.
        self.hidden = columns["hidden"] - calibrated(columns["hidden"], free, self.fit, noise)
        self.names, self.x = [], []
        for name, values in columns.items():
            spread = np.std(values[self.fit])
            if name in NOT_A_CHANNEL or name.startswith("free:") or spread < 1e-9 * (1 + abs(values).max()):
                continue
            # One of two that say the same, such as both components of a heading that is this or the opposite.
            if any(abs(np.corrcoef(values[self.fit], other[self.fit])[0, 1]) > 0.999 for other in self.x):
                continue
            self.names.append(name)
            self.x.append(values / np.abs(values[self.fit]).max())
        self.x, self.all_names = np.array(self.x).T, list(self.names)
        self.scale = np.std(self.y[self.fit]) or 1.0

    def without(self, channel):
        """The same case with a channel less."""
        other = copy.copy(self)
        kept = [index for index, name in enumerate(self.names) if name != channel]
        other.names, other.x = [self.names[index] for index in kept], self.x[:, kept]
        return other

    def folds(self):
        """Whole runs, at most five groups."""
        names = sorted(set(self.runs[self.fit]))
        for group in range(min(5, len(names))):
            out = np.isin(self.runs, names[group::5])
            yield self.fit & ~out, self.fit & out


def calibrated(residual, free, fit, noise):
    """What free parameters explain, each in units of its stated spread: ridge with a prior of 1."""
    if not free:
        return np.zeros_like(residual)
    a = np.array(free).T
    left = a[fit].T @ a[fit] / noise**2 + np.eye(a.shape[1])
    return a @ np.linalg.solve(left, a[fit].T @ residual[fit] / noise**2)


def one_standard_error(errors):
    """Index of the simplest model (the last row) within one standard error of the best, by mean over folds."""
    mean = errors.mean(axis=1)
    best = int(np.argmin(mean))
    se = errors[best].std(ddof=1) / np.sqrt(errors.shape[1]) if errors.shape[1] > 1 else 0.0
    return max(index for index in range(len(mean)) if mean[index] <= mean[best] + se)


def sindy(case):
    """Error on runs left out, prediction of every row, names of the variables used, and the equation."""
    import pysindy

    library = pysindy.PolynomialLibrary(degree=3 if len(case.names) <= 8 else 2, include_bias=True)
    theta = np.asarray(library.fit_transform(case.x))
    terms = library.get_feature_names(case.names)
    size = np.sqrt((theta[case.fit] ** 2).mean(axis=0))
    size[size == 0.0] = 1.0
    theta, y = theta / size, case.y / case.scale
    thresholds = np.geomspace(0.003, 3.0, 10)

    def solve(rows, threshold):
        optimizer = pysindy.STLSQ(threshold=threshold, alpha=1e-3 * rows.sum(), max_iter=30)
        optimizer.fit(theta[rows], y[rows, None])
        return np.asarray(optimizer.coef_)[0]

    errors = np.array(
        [
            [np.mean((y[out] - theta[out] @ solve(into, threshold)) ** 2) for into, out in case.folds()]
            for threshold in thresholds
        ]
    )
    chosen = one_standard_error(errors)
    coefficients = solve(case.fit, thresholds[chosen])
    kept = [term for term, value in zip(terms, coefficients) if value != 0.0]
    used = {part.split("^")[0] for term in kept for part in term.split()} & set(case.names)
    text = " + ".join(f"{value:.3g} {term}" for term, value in zip(terms, coefficients) if value != 0.0)
    return errors[chosen].mean(), theta @ coefficients * case.scale, used, text


def operon(case):
    """The same by symbolic regression."""
    from pyoperon.sklearn import SymbolicRegressor

    into, out = max(case.folds(), key=lambda pair: pair[1].sum())
    regressor = SymbolicRegressor(
        allowed_symbols="add,sub,mul,div,constant,variable,sin,exp,sqrt,square",
        objectives=["mse", "length"],
        max_length=30,
        max_evaluations=20_000,
        optimizer_iterations=5,
        n_threads=1,
        random_state=SEED,
    )
    y = case.y / case.scale
    regressor.fit(case.x[into], y[into])
    front = sorted(regressor.pareto_front_, key=lambda one: -one["complexity"])
    values = [np.broadcast_to(regressor.evaluate_model(one["tree"], case.x), y.shape) for one in front]
    # A constant is always among the candidates, as the simplest.
    values.append(np.full_like(y, y[into].mean()))
    texts = [regressor.get_model_string(one["tree"], 4, case.names) for one in front] + [""]
    squares = np.array([[np.mean((y[part] - value[part]) ** 2) for part in blocks(case, out)] for value in values])
    squares[~np.isfinite(squares)] = np.inf
    chosen = one_standard_error(squares)
    used = {name for name in case.names if re.search(rf"\b{name}\b", texts[chosen])}
    return squares[chosen].mean(), np.array(values[chosen]) * case.scale, used, texts[chosen]


def blocks(case, out):
    """Five stretches of the runs left out, for a standard error."""
    rows = np.flatnonzero(out)
    return np.array_split(rows, 5)


def r2(found, truth):
    """1 minus the square error over the square of the truth's spread, or its size where it hardly varies."""
    spread = ((truth - truth.mean()) ** 2).sum()
    size = (truth**2).sum()
    if size == 0.0:
        return None
    return 1.0 - ((found - truth) ** 2).sum() / (spread if spread > 0.0025 * size else size)


def judge(case, found, used):
    """What became of one case."""
    about = case.about
    hidden = [one for one in about["hidden"] if one["class"] == "physics"]
    result = {"varies": float(np.std(found[case.fit])) > 0.1 * about["noise"], "r2": None, "right": False}
    if hidden and np.any(case.hidden):
        result["r2"] = r2(found[case.held], case.hidden[case.held]) if case.held.any() else None
        wanted = set().union(*(one["variables"] for one in hidden)) & set(case.all_names)
        result["variables"] = used == wanted
        result["right"] = bool(result["variables"] and result["r2"] is not None and result["r2"] >= 0.9)
    return result


def table(results, programs):
    """The page."""
    lines = [
        "# Others on the same concealed cases\n",
        f"{len(results)} cases. Made by `benches/peers/residual_identification.py` from `conceal table`; see `benches/peers/README.md` for what is given and counted.\n",
        "| what | " + " | ".join(programs) + " |",
        "|---|" + "---|" * len(programs),
    ]

    def row(what, pick):
        cells = []
        for program in programs:
            hits = [pick(one[program]) for one in results if program in one and pick(one[program]) is not None]
            cells.append(f"{sum(hits)}/{len(hits)}" if hits else "-")
        lines.append(f"| {what} | " + " | ".join(cells) + " |")

    def of(kinds, key):
        def pick(one):
            return one[key] if one["kind"] in kinds and one.get(key) is not None else None

        return pick

    def close(kinds):
        def pick(one):
            return one["r2"] >= 0.9 if one["kind"] in kinds and one["r2"] is not None else None

        return pick

    for name, kinds in (("one listed cause", ("single",)), ("two causes", ("two", "two_unlisted")), ("an unlisted cause", ("unlisted",))):
        row(f"{name}: variables right and R² of the held-out force at least 0.9", of(kinds, "right"))
        row(f"{name}: R² of the held-out force at least 0.9", close(kinds))
        row(f"{name}: variables right", of(kinds, "variables"))
    row("nothing hidden: physics is invented", of(("empty",), "varies"))
    row("a sensor's fault: physics is claimed", of(("artefact",), "varies"))
    seconds = [f"{np.median([one[program]['seconds'] for one in results if program in one]):.1f} s" if any(program in one for one in results) else "-" for program in programs]
    lines.append("| time of a case, one thread, median | " + " | ".join(seconds) + " |")
    lines += ["\n## Every case\n", "| case | kind | hidden | " + " | ".join(f"{p}: R² | {p}: equation" for p in programs) + " |", "|---|---|---|" + "---|---|" * len(programs)]
    for one in results:
        cells = []
        for program in programs:
            of_program = one.get(program)
            score = "-" if not of_program or of_program["r2"] is None else f"{of_program['r2']:.2f}"
            text = (of_program or {}).get("text", "-").replace("|", "/")
            cells.append(f"{score} | `{text if len(text) <= 120 else text[:117] + '...'}`" if text else f"{score} | none")
        lines.append(f"| {one['case']} | {one['kind']} | {one['hidden']} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    """Goes through the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tables", type=Path)
    parser.add_argument("--markdown", type=Path)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--limit", type=int, default=10**9)
    arguments = parser.parse_args()
    warnings.filterwarnings("ignore")
    programs = {}
    for name, function, module in (("PySINDy", sindy, "pysindy"), ("Operon", operon, "pyoperon")):
        try:
            __import__(module)
            programs[name] = function
        except ImportError as error:
            print(f"{name} is left out: {error}; pip install {module}")
    results = []
    for path in sorted(arguments.tables.glob("case_*.csv"))[arguments.first : arguments.first + arguments.limit]:
        case = Case(path)
        if case.fit.sum() < 20:
            print(f"{path.stem}: too few rows")
            continue
        about = case.about
        hidden = ", ".join(one["law"] for one in about["hidden"]) or "nothing"
        one = {"case": path.stem, "kind": about["kind"], "hidden": hidden}
        for name, function in programs.items():
            begun = time.process_time()
            try:
                tried = [function(case.without(channel)) for channel in EITHER]
                _, found, used, text = min(tried, key=lambda one: one[0])
            except Exception as error:  # A program that fails is told and counts as having found nothing.
                found, used, text = np.zeros_like(case.y), set(), f"failed: {error}"
            one[name] = judge(case, found, used) | {
                "kind": about["kind"],
                "seconds": time.process_time() - begun,
                "text": text,
            }
            print(path.stem, about["kind"], hidden, name, one[name]["r2"], text[:100], flush=True)
        results.append(one)
        if arguments.markdown:
            # After each case, so that an interrupted comparison is not lost.
            arguments.markdown.write_text(table(results, list(programs)))
    print(table(results, list(programs)))


if __name__ == "__main__":
    main()
