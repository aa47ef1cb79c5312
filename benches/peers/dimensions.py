"""What one dimension leaves out: the runs of `scenarios/one_and_three_dimensions.ron`, in pairs.

    python benches/peers/dimensions.py target/release/headland [--markdown docs/evidence/dimensions.md]

Needs `numpy` and `pyarrow`.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np
import pyarrow.parquet as parquet

SCENARIO = pathlib.Path(__file__).resolve().parents[2] / "scenarios" / "one_and_three_dimensions.ron"
WHEELS = [f"axle_{axle}_{side}" for axle in (1, 2) for side in ("left", "right")]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program")
    arguments.add_argument("--markdown", type=pathlib.Path)
    chosen = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([chosen.program, "run", str(SCENARIO), "--out", folder, "--json", "--quiet"],
                              capture_output=True, text=True, check=True)
        columns = parquet.read_table(pathlib.Path(folder) / "trace.parquet").to_pydict()
    runs = {run["id"]: run for run in json.loads(done.stdout)["runs"]}
    of_run = np.array(columns["run"])
    lines = ["| ground | fuel energy kJ | in 3-D | | soil kJ | in 3-D | slip kJ | in 3-D | side slip kJ | tyre damping kJ "
             "| wheel load, standard deviation | lowest | residual of the ledger |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for ground in dict.fromkeys(name.rsplit("-", 1)[0] for name in runs):
        one, three = runs[f"{ground}-1"], runs[f"{ground}-3"]

        def took(run, name):
            return sum(sink["energy_j"] for sink in run["energy"]["sinks"] if sink["name"] == name) / 1e3

        rows = of_run == f"{ground}-3"
        loads = np.array([np.array(columns[f"{wheel}_load_n"], dtype=float)[rows] for wheel in WHEELS])
        mean = loads.mean(axis=1, keepdims=True)
        fuel = [run["energy"]["source_j"] / 1e3 for run in (one, three)]
        lines.append(
            f"| {ground} | {fuel[0]:.1f} | {fuel[1]:.1f} | {100 * (fuel[1] / fuel[0] - 1):+.1f} % "
            f"| {took(one, 'soil'):.1f} | {took(three, 'soil'):.1f} | {took(one, 'slip'):.1f} | {took(three, 'slip'):.1f} "
            f"| {took(three, 'side slip'):.1f} | {took(three, 'tyre damping'):.1f} "
            f"| {100 * (loads / mean - 1).std():.1f} % | {100 * (loads / mean).min():.0f} % "
            f"| {three['relative_energy_residual']:.0e} |")
    text = "\n".join(lines)
    print(text)
    if chosen.markdown:
        chosen.markdown.write_text(
            "# What one dimension leaves out\n\nForty metres at 10 km/h with a pull of 15 kN, by "
            f"`benches/peers/dimensions.py` from `scenarios/{SCENARIO.name}`.\n\n{text}\n")


if __name__ == "__main__":
    main()
