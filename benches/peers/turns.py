"""What a diagnosis that knows one dimension makes of recordings of the rigid body in turns.

    python benches/peers/turns.py target/release/headland [--markdown docs/evidence/turns.md] [--rerun out/turns]

The runs of `scenarios/coast_down_turns.ron`, with the noise of a speed sensor, are given to `headland diagnose` with the same
scenario. With `--rerun` the diagnosis is drawn for the Rerun viewer too, and everything is kept in the folder that it names. Needs `numpy`
and `pyarrow`.
"""

import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np
import pyarrow.parquet as parquet

SCENARIO = pathlib.Path(__file__).resolve().parents[2] / "scenarios" / "coast_down_turns.ron"
NOISE_M_S, SEED = 0.02, 1


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program")
    arguments.add_argument("--markdown", type=pathlib.Path)
    arguments.add_argument("--rerun", type=pathlib.Path, metavar="FOLDER")
    chosen = arguments.parse_args()
    random = np.random.default_rng(SEED)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([chosen.program, "run", str(SCENARIO), "--out", name, "--quiet"], capture_output=True, check=True)
        columns = parquet.read_table(folder / "trace.parquet").to_pydict()
        of_run = np.array(columns["run"])
        names = list(dict.fromkeys(columns["run"]))
        steepest = 0.0
        for run in names:
            rows = of_run == run

            def channel(what):
                return np.array(columns[what], dtype=float)[rows]

            speed, yaw = channel("speed_m_s"), channel("yaw_rate_rad_s")
            steepest = max(steepest, np.abs(speed * yaw).max())
            # A recording ends before the vehicle rocks to its rest.
            moving = speed > 0.3
            recorded = {
                "time_s": channel("time_s"),
                "speed_m_s": speed + NOISE_M_S * random.standard_normal(len(speed)),
                "position_m": channel("position_m"),
                "heading_rad": channel("heading_rad"),
                "curvature_per_m": yaw / np.maximum(speed, 0.3),
                "coasting": channel("coasting"),
            }
            table = np.column_stack([values[moving] for values in recorded.values()])
            np.savetxt(folder / f"{run}.csv", table, delimiter=",", header=",".join(recorded), comments="", fmt="%.6f")
        runs = ", ".join(f'(id: "{run}", file: "{run}.csv")' for run in names)
        (folder / "recording.ron").write_text(f'(about: "coast-downs of the rigid body", runs: [{runs}])')
        asked = [chosen.program, "diagnose", str(SCENARIO), "--recording", str(folder / "recording.ron"),
                 "--out", str(folder / "diagnosis"), "--quiet", "--json"]
        if chosen.rerun:
            asked.append("--rerun")
        done = subprocess.run(asked, capture_output=True, text=True, check=True)
        if chosen.rerun:
            shutil.copytree(folder, chosen.rerun, dirs_exist_ok=True)
    found = json.loads(done.stdout)
    text = f"{found['verdict']}: {found['answer']}\n\nThe greatest sideways acceleration of the runs is {steepest:.1f} m/s²."
    print(text)
    if chosen.markdown:
        chosen.markdown.write_text(
            "# Turns that one dimension does not know\n\nSeven coast-downs of the rigid body "
            f"(`scenarios/{SCENARIO.name}`), five of them through turns, with a noise of {NOISE_M_S} m/s on the speed, given to "
            f"`headland diagnose` by `benches/peers/turns.py`:\n\n> {text}\n")


if __name__ == "__main__":
    main()
