#!/usr/bin/env python3
"""The same car through the same cycle in FASTSim 3 and in Headland: energy at the wheels, and steps per second.

usage: udds_fastsim.py HEADLAND [--step-rate BENCH] [--markdown PAGE.md] [--rounds N]

HEADLAND is the program, built with --release; BENCH the bench `step_rate`, built likewise: without it no times are compared. The vehicle and the cycle (UDDS) are those that FASTSim brings along; the
scenario for Headland is written from them: same mass, drag, rolling resistance, inertia of wheels, density of air and the
same speeds over time. Positive and negative work at the wheels are compared from the powers over time of both. Drivelines
differ (FASTSim knows the efficiency of an engine by its power, Headland a Willans line and speeds), so fuel is not.
Needs fastsim and pyarrow.
"""

import argparse
import pathlib
import re
import subprocess
import tempfile
import time
import warnings

import fastsim
import numpy as np
import pyarrow.parquet as parquet

warnings.simplefilter("ignore", DeprecationWarning)
VEHICLE, CYCLE = "2012_Ford_Fusion.yaml", "udds.csv"
GRAVITY = 9.80665
# The cycle has a corner each second: powers jump there, so Headland samples them finely. FASTSim has the step of its cycle.
STEP_S, FINE_STEP_S = 1.0, 0.01


def vehicle():
    return fastsim.Vehicle.from_resource(VEHICLE)


def cycle():
    return fastsim.Cycle.from_resource(CYCLE)


def peer(rounds):
    """Powers at the wheels over time of FASTSim, its parameters, and its best time for a walk with and without history."""
    drive = fastsim.SimDrive(vehicle(), cycle())
    drive.walk()
    told = drive.to_dict()
    history = told["veh"]["history"]
    times = np.array(told["cyc"]["time_seconds"], dtype=float)
    speeds = np.array(told["cyc"]["speed_meters_per_second"], dtype=float)
    best = float("inf")
    for _ in range(rounds):
        car = vehicle()
        car.set_save_interval(None)
        drive = fastsim.SimDrive(car, cycle())
        begin = time.perf_counter()
        drive.walk()
        best = min(best, time.perf_counter() - begin)
    car = told["veh"]
    # FASTSim computes the air's density from height and temperature, and its record says another one: what its drag says counts.
    mean_speeds = 0.5 * (speeds[1:] + speeds[:-1])
    area = car["chassis"]["drag_coef"] * car["chassis"]["frontal_area_square_meters"]
    car["density"] = float(np.sum(history["pwr_drag_watts"][1:]) / np.sum(0.5 * area * mean_speeds**3))
    return times, speeds, np.array(history["pwr_tractive_watts"], dtype=float), car, best


def works(times, power):
    """Work [J] of the positive and of the negative part of a power that is constant over each step that ends at a time."""
    steps = np.diff(times)
    return float(np.sum(np.maximum(power[1:], 0) * steps)), float(np.sum(np.minimum(power[1:], 0) * steps))


def scenario(car, times, speeds, step_s):
    chassis = car["chassis"]
    rotating = chassis["num_wheels"] * chassis["wheel_inertia_kilogram_square_meters"] / chassis["wheel_radius_meters"] ** 2
    area = chassis["drag_coef"] * chassis["frontal_area_square_meters"]
    engine = car["pt_type"]["Conv"]["fc"]["pwr_out_max_watts"]
    series = lambda values: ", ".join(repr(float(value)) for value in values)
    return f"""(
    about: "{car['name']} through {CYCLE}, as FASTSim has them",
    vehicle: (
        mass_kg: {car['mass_kilograms']!r},
        rotating_mass_kg: {rotating!r},
        drag_area_m2: {area!r},
        driveline: EngineCvt(
            displacement_m3: 2.5e-3, willans_efficiency: 0.4, willans_friction_pa: 1.5e5, lower_heating_value_j_kg: 43.2e6,
            full_load: [(speed_rad_s: 80, torque_n_m: 150), (speed_rad_s: 650, torque_n_m: {engine / 650!r})],
            idle_speed_rad_s: 80, load_share: 1, transmission_efficiency: 0.875, max_force_n: 2e4, accessory_power_w: 700,
            alternator_efficiency: 0.6, wheel_radius_m: {chassis['wheel_radius_meters']!r}, rotating_mass_kg: 0,
        ),
    ),
    ground: (terrain: Flat, soil: Constant(coefficient: {chassis['wheel_rr_coef']!r})),
    gravity_m_s2: {GRAVITY},
    air: (density_kg_m3: {car['density']!r}),
    cycle: [Follow(times_s: [{series(times)}], speeds_m_s: [{series(speeds)}])],
    simulation: (fidelity: Longitudinal, step_s: {step_s}),
)
"""


def ours(program, text):
    """Time, speed and power at the wheels of Headland."""
    with tempfile.TemporaryDirectory() as folder:
        path, out = pathlib.Path(folder) / "scenario.ron", pathlib.Path(folder) / "out"
        path.write_text(text)
        subprocess.run([program, "run", path, "--out", out, "--quiet"], check=True, stdout=subprocess.DEVNULL)
        table = parquet.read_table(out / "trace.parquet")
    column = lambda name: table[name].to_numpy()
    speed = column("speed_m_s")
    brake = column("brake_force_n") if "brake_force_n" in table.column_names else np.zeros(len(speed))
    return column("time_s"), speed, (column("tractive_force_n") - brake) * speed


def step_rate(bench, text):
    """Steps per second of Headland, the simulation alone."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scenario.ron"
        path.write_text(text)
        told = subprocess.run([bench, path], check=True, text=True, capture_output=True).stdout
    return float(re.search(r"([\d.]+) steps per second", told)[1])


def trapezoids(time_s, power):
    """Work of the two signs, the power linear between samples; a change of sign is where the line crosses zero."""
    up = down = 0.0
    for step, a, b in zip(np.diff(time_s), power[:-1], power[1:]):
        if a * b >= 0:
            up, down = up + step * max(0.5 * (a + b), 0), down + step * min(0.5 * (a + b), 0)
        else:
            share = a / (a - b)
            first, second = 0.5 * step * share * a, 0.5 * step * (1 - share) * b
            up, down = up + max(first, second), down + min(first, second)
    return up, down


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("headland")
    parser.add_argument("--step-rate")
    parser.add_argument("--markdown")
    parser.add_argument("--rounds", type=int, default=30)
    wanted = parser.parse_args()
    times, speeds, power, car, walk_s = peer(wanted.rounds)
    time_s, speed, own = ours(wanted.headland, scenario(car, times, speeds, FINE_STEP_S))
    steps = len(times) - 1
    rate = step_rate(wanted.step_rate, scenario(car, times, speeds, STEP_S)) if wanted.step_rate else float("nan")
    theirs, mine = works(times, power), trapezoids(time_s, own)
    miss = float(np.max(np.abs(np.interp(times, time_s, speed) - speeds)))
    rates = steps / walk_s, rate
    row = lambda what, a, b, unit, relation: f"| {what} | {a:.1f} {unit} | {b:.1f} {unit} | {relation} |"
    lines = [
        "# The same car in FASTSim",
        "",
        "Made by [`benches/peers/udds_fastsim.py`](../../benches/peers/udds_fastsim.py), which says how. "
        f"FASTSim {fastsim.__version__}, {car['name']}, {CYCLE}, {len(times) - 1} steps of {STEP_S:g} s.",
        "",
        "| | FASTSim | Headland | |",
        "|---|---|---|---|",
        row("work that drives, at the wheels", theirs[0] / 1e3, mine[0] / 1e3, "kJ", f"{100 * (mine[0] / theirs[0] - 1):+.2f} %"),
        row("work that slows down, at the wheels", theirs[1] / 1e3, mine[1] / 1e3, "kJ", f"{100 * (mine[1] / theirs[1] - 1):+.2f} %"),
        row("work in sum", sum(theirs) / 1e3, sum(mine) / 1e3, "kJ", f"{100 * (sum(mine) / sum(theirs) - 1):+.2f} %"),
        *([row("steps per second, one thread", rates[0], rates[1], "1/s", f"{rates[1] / rates[0]:.0f} times")] if wanted.step_rate else []),
        "",
        f"Headland misses the speeds of the cycle by at most {miss:.1e} m/s; its work is sampled each {FINE_STEP_S} s, since powers jump at "
        "the corners of the cycle."
        + (
            " Steps per second: both with steps of 1 s, the simulation alone, the best of many; FASTSim keeps no history, Headland every "
            "channel of every step." if wanted.step_rate else ""
        ),
        "",
    ]
    print("\n".join(lines))
    if wanted.markdown:
        pathlib.Path(wanted.markdown).write_text("\n".join(lines))


if __name__ == "__main__":
    main()
