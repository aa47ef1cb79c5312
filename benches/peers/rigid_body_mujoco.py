"""The rigid body of Headland against the same vehicle in MuJoCo: coast-downs on the level, uphill and over a hump.

    python benches/peers/rigid_body_mujoco.py target/release/headland [--bench target/release/deps/rigid_body-*]
        [--markdown docs/evidence/mujoco.md]

Needs `mujoco`, `numpy` and `pyarrow`. MuJoCo is told the vehicle in its own terms: wheels are spheres that touch a plane and a
cylinder with its contacts and friction cones, and turn on hinges whose dry friction is the rolling resistance; the
tyres are springs between hubs and chassis. Nothing of Headland's forces is used.

With `--bench` both make steps of the same scenes as fast as they can, one vehicle and 64 at once, in turns of one run.
"""

import argparse
import json
import math
import os
import pathlib
import re
import subprocess
import tempfile
import time

import mujoco
import mujoco.rollout
import numpy as np
import pyarrow.parquet as parquet

MASS_KG, ROTATING_KG, HUB_KG = 13019.3, 900.0, 20.0
ROLL, PITCH, YAW = 8.3e3, 31.3e3, 33.3e3
HALF_BASE_M, HALF_TRACK_M, HEIGHT_M = 1.8, 1.05, 1.3
DIAMETER_M, DAMPING = 2.045, 6e3
STIFFNESS = 1e6 / (0.365 + 170.0 / 150.0)
COEFFICIENT, GRAVITY, SPEED = 0.07, 9.80665, 8.0
STEP_S = 1e-3
RADIUS_M = DIAMETER_M / 2 - MASS_KG * GRAVITY / 4 / STIFFNESS
HUMP_M, HUMP_FROM_M, HUMP_LENGTH_M = 0.08, 8.0, 4.0
ARC_M = ((HUMP_LENGTH_M / 2) ** 2 + HUMP_M**2) / (2 * HUMP_M)


def hump(x):
    """Height of the hump, an arc of a circle [m]."""
    across = np.abs(x - HUMP_FROM_M - HUMP_LENGTH_M / 2)
    return np.maximum(np.sqrt(ARC_M**2 - np.minimum(across, ARC_M) ** 2) - ARC_M + HUMP_M, 0.0)


def scenario(case):
    """The case as a scenario of Headland."""
    tyre = f"(width_m: 0.9, diameter_m: {DIAMETER_M}, section_height_m: 0.54, inflation_pa: 1.5e5, carcass_pa: 0)"
    axle = f"track_m: {2 * HALF_TRACK_M}, wheels: 2, lead: 1, tyre: {tyre}"
    body = (f"(damping_n_s_m: {DAMPING}, friction: 0.8, slip_stiffness: 12, cornering_stiffness_per_rad: 6, "
            "relaxation_length_m: 0.7, differential: Open)")
    if case == "hump":
        xs = [-20.0, *np.linspace(HUMP_FROM_M, HUMP_FROM_M + HUMP_LENGTH_M, 81), 100.0]
        # Positions count along the ground, heights on the map.
        fine = np.linspace(-20.0, 100.0, 240001)
        along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fine), np.diff(hump(fine))))])
        along -= np.interp(0.0, fine, along)
        points = ", ".join(f"(position_m: {np.interp(x, fine, along):.9f}, elevation_m: {float(hump(np.array(x))):.9f})"
                           for x in xs)
        terrain = f"Profile(heading_rad: 0, points: [{points}])"
    else:
        terrain = f"ConstantGrade(grade: {0.05 if case == 'uphill' else 0.0})"
    return f"""(
    about: "{case}",
    vehicle: (
        mass_kg: {MASS_KG}, rotating_mass_kg: {ROTATING_KG}, drag_area_m2: 0,
        axles: [(position_m: {HALF_BASE_M}, {axle}), (position_m: {-HALF_BASE_M}, {axle})],
        centre_of_gravity_height_m: {HEIGHT_M}, hitch_height_m: 0.7, slip_limit: 0.5,
        body: (
            roll_inertia_kg_m2: {ROLL}, pitch_inertia_kg_m2: {PITCH}, yaw_inertia_kg_m2: {YAW}, hitch_position_m: -3,
            steering: (mode: Front, limit_rad: 0.5, rate_rad_s: 0.5, look_ahead_m: 5), centre: Open,
            axles: [{body}, {body}],
        ),
        driveline: Neutral,
    ),
    ground: (terrain: {terrain}, soil: Constant(coefficient: {COEFFICIENT})),
    air: (density_kg_m3: 1.2), gravity_m_s2: {GRAVITY},
    start: (position_m: 0, speed_m_s: {SPEED}),
    cycle: [Coast(until: Stopped)],
    simulation: (fidelity: RigidBody(record_s: {STEP_S}), step_s: {STEP_S}),
)"""


def headland(program, case, folder):
    """Time, way and rise of the centre of gravity of one case in Headland."""
    path = folder / f"{case}.ron"
    path.write_text(scenario(case))
    done = subprocess.run([program, "run", str(path), "--out", str(folder / case), "--json", "--quiet"],
                          capture_output=True, text=True, check=True)
    run = json.loads(done.stdout)["runs"][0]
    table = parquet.read_table(folder / case / "trace.parquet").to_pydict()
    times, ways = np.array(table["time_s"]), np.array(table["position_m"])
    return run["duration_s"], run["distance_m"], times, ways, np.array(table["height_m"]), run["relative_energy_residual"]


def model(case):
    """The same vehicle and ground as MuJoCo reads them."""
    angle = math.degrees(math.atan(0.05)) if case == "uphill" else 0.0
    gravity = (-GRAVITY * math.sin(math.radians(angle)), 0.0, -GRAVITY * math.cos(math.radians(angle)))
    load_n = MASS_KG * -gravity[2] / 4
    turning = ROTATING_KG / 4 * RADIUS_M**2
    torque = COEFFICIENT * load_n * RADIUS_M
    wheels = "".join(
        f"""<body name="hub{index}" pos="{x} {y} {RADIUS_M - HEIGHT_M}">
          <joint name="tyre{index}" type="slide" axis="0 0 1" stiffness="{STIFFNESS}" damping="{DAMPING}"
                 springref="{-load_n / STIFFNESS}"/>
          <joint name="turn{index}" type="hinge" axis="0 1 0" frictionloss="{torque}"/>
          <inertial pos="0 0 0" mass="{HUB_KG}" diaginertia="{0.51 * turning} {turning} {0.51 * turning}"/>
          <geom type="sphere" size="{RADIUS_M}" friction="1 0 0" condim="3" contype="1" conaffinity="0"/></body>"""
        for index, (x, y) in enumerate((x, y) for x in (HALF_BASE_M, -HALF_BASE_M) for y in (HALF_TRACK_M, -HALF_TRACK_M)))
    ground = '<geom type="plane" size="0 0 1" friction="1 0 0" condim="3" contype="0" conaffinity="1"/>'
    if case == "hump":
        ground += (f'<geom type="cylinder" size="{ARC_M} 3" euler="90 0 0" friction="1 0 0" condim="3" contype="0" '
                   f'conaffinity="1" pos="{HUMP_FROM_M + HUMP_LENGTH_M / 2} 0 {HUMP_M - ARC_M}"/>')
    # The hubs' own mass sits in the wheels; their turning inertia about the upright axes is part of the chassis.
    text = f"""<mujoco><option timestep="{STEP_S}" gravity="{gravity[0]} {gravity[1]} {gravity[2]}"
      integrator="implicitfast" cone="elliptic" impratio="10"/>
      <default><geom solref="0.004 1" solimp="0.99 0.999 0.0001"/></default>
      <worldbody>{ground}<body name="chassis" pos="0 0 {HEIGHT_M}"><freejoint/>
      <inertial pos="0 0 0" mass="{MASS_KG - 4 * HUB_KG}" diaginertia="{ROLL} {PITCH} {YAW}"/>{wheels}</body></worldbody></mujoco>"""
    return mujoco.MjModel.from_xml_string(text)


def rolling(case):
    """Model and state where a run begins."""
    built = model(case)
    data = mujoco.MjData(built)
    data.qvel[0] = SPEED
    for index in range(4):
        data.qvel[built.joint(f"turn{index}").dofadr[0]] = SPEED / RADIUS_M
    return built, data


def in_mujoco(case):
    """As `headland`, in MuJoCo."""
    built, data = rolling(case)
    times, ways, heights = [0.0], [0.0], [HEIGHT_M]
    while data.qvel[0] > 0.0 and data.time < 60.0:
        before_m_s = data.qvel[0]
        mujoco.mj_step(built, data)
        times.append(data.time)
        ways.append(data.qpos[0])
        heights.append(data.qpos[2])
    # The instant of the stop lies within the last step.
    past = data.qvel[0] / (data.qvel[0] - before_m_s) * STEP_S if data.qvel[0] < 0.0 else 0.0
    return data.time - past, ways[-1], np.array(times), np.array(ways), np.array(heights)


VEHICLES, ROUNDS = 64, 3


def mujoco_steps_per_second(case, steps):
    """Of one vehicle on one thread, and of 64 on all of them; stepped and rolled out in C."""
    built, data = rolling(case)
    begin = time.perf_counter()
    mujoco.mj_step(built, data, steps)
    alone = steps / (time.perf_counter() - begin)
    _, data = rolling(case)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = np.zeros(mujoco.mj_stateSize(built, full))
    mujoco.mj_getState(built, data, state, full)
    threads = len(os.sched_getaffinity(0))
    with mujoco.rollout.Rollout(nthread=threads) as rollout:
        each = [mujoco.MjData(built) for _ in range(threads)]
        begin = time.perf_counter()
        rollout.rollout([built] * VEHICLES, each, np.tile(state, (VEHICLES, 1)), nstep=steps)
        took_s = time.perf_counter() - begin
    return alone, VEHICLES * steps / took_s


def headland_steps_per_second(bench, path):
    """As the bench prints them."""
    done = subprocess.run([bench, str(path)], capture_output=True, text=True, check=True)
    found = re.search(r"(\d+) steps per second alone, +(\d+) of 64 vehicles on (\d+) threads", done.stdout)
    return float(found[1]), float(found[2]), int(found[3])


def race(bench, folder, steps_of):
    """Steps per second of both on the same scenes, in turns; the fastest round of each counts."""
    rows = []
    for case, steps in steps_of.items():
        ours, theirs = np.zeros(2), np.zeros(2)
        for _ in range(ROUNDS):
            *rates, threads = headland_steps_per_second(bench, folder / f"{case}.ron")
            ours = np.maximum(ours, rates)
            theirs = np.maximum(theirs, mujoco_steps_per_second(case, steps))
        rows.append(f"| {case} | {ours[0]:,.0f} | {theirs[0]:,.0f} | {ours[0] / theirs[0]:.2f} "
                    f"| {ours[1]:,.0f} | {theirs[1]:,.0f} | {ours[1] / theirs[1]:.2f} |")
    return [f"Steps of {1e3 * STEP_S:.0f} ms per second on the same scenes, in turns of one run on {threads} threads; Headland with driver, "
            "soil, slips and a row of the trace for each step, MuJoCo without a trace:", "",
            "| scene | Headland, one vehicle | MuJoCo | ratio | Headland, 64 at once | MuJoCo | ratio |",
            "|---|---|---|---|---|---|---|", *rows, ""]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program")
    arguments.add_argument("--bench", nargs="+", default=[], help="the bench `rigid_body`, as Cargo builds it")
    arguments.add_argument("--markdown", type=pathlib.Path)
    chosen = arguments.parse_args()
    rows, notes, steps_of, raced = [], [], {}, []
    with tempfile.TemporaryDirectory() as folder:
        for case in ("level", "uphill", "hump"):
            ours = headland(chosen.program, case, pathlib.Path(folder))
            theirs = in_mujoco(case)
            steps_of[case] = len(theirs[2]) - 1
            rows.append(f"| {case} | {ours[0]:.3f} | {theirs[0]:.3f} | {100 * (ours[0] / theirs[0] - 1):+.2f} % "
                        f"| {ours[1]:.3f} | {theirs[1]:.3f} | {100 * (ours[1] / theirs[1] - 1):+.2f} % |")
            if case == "hump":
                # Rise of the centre of gravity by place, before and over the hump and on the way out of it.
                places = np.linspace(2.0, 25.0, 2301)
                mine = np.interp(places, ours[3], ours[4]) - HEIGHT_M
                other = np.interp(places, theirs[3], theirs[4]) - HEIGHT_M
                notes.append(f"Over the hump of {1e3 * HUMP_M:.0f} mm the centre of gravity rises by at most "
                             f"{1e3 * mine.max():.1f} mm (MuJoCo {1e3 * other.max():.1f} mm) and falls to "
                             f"{1e3 * mine.min():.1f} mm ({1e3 * other.min():.1f} mm); between 2 m and 25 m they differ by "
                             f"{1e3 * np.sqrt(np.mean((mine - other) ** 2)):.2f} mm (RMS).")
            notes.append(f"{case}: the ledger of Headland leaves {ours[5]:.1e}.")
        # A pattern matches what Cargo wrote beside the programs as well, and older builds.
        programs = sorted((path for path in chosen.bench if os.access(path, os.X_OK)), key=os.path.getmtime)
        if programs:
            raced = race(programs[-1], pathlib.Path(folder), steps_of)
    text = "\n".join(["| coast-down | time s | MuJoCo | | way m | MuJoCo | |", "|---|---|---|---|---|---|---|", *rows, "", *raced, *notes])
    print(text)
    if chosen.markdown:
        chosen.markdown.write_text(f"# The rigid body against MuJoCo {mujoco.__version__}\n\n{text}\n")


if __name__ == "__main__":
    main()
