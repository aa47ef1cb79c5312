#!/usr/bin/env python3
"""The same cars through the same cycle in FASTSim 3 and in Headland: work, fuel and electricity, and steps per second.

usage: udds_fastsim.py HEADLAND [--step-rate BENCH] [--markdown PAGE.md] [--rounds N] [--turns N]

HEADLAND is the program, built with --release; BENCH the bench `step_rate`, built likewise: without it no times are compared.
Cars and cycle (UDDS) are those that FASTSim brings along; the scenarios for Headland are written from them, component by
component: mass, drag, rolling resistance, inertia of wheels and density of air of all three; of the conventional car the
engine's efficiency over power, transmission and accessories; of the electric one the motor's efficiency over power, gears,
consumers and battery. What FASTSim does not know and Headland asks is written below and said in the page. The hybrids are
compared by speed alone: two managements of their own make two different runs.
Needs fastsim and pyarrow.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import warnings

import fastsim
import numpy as np
import pyarrow.parquet as parquet

warnings.simplefilter("ignore", DeprecationWarning)
CONVENTIONAL, ELECTRIC, HYBRID = "2012_Ford_Fusion.yaml", "2022_Renault_Zoe_ZE50_R135.yaml", "2016_TOYOTA_Prius_Two.yaml"
CYCLE = "udds.csv"
GRAVITY = 9.80665
# The cycle has a corner each second: powers jump there, so Headland samples them finely. FASTSim has the step of its cycle.
STEP_S, FINE_STEP_S = 1.0, 0.01
# A row each second, and those of the begin and the end alone.
EACH_STEP, NO_ROWS = "QuasiStatic(record_s: 1)", "QuasiStatic(record_s: 86400)"
FIDELITIES = (NO_ROWS, EACH_STEP, "Longitudinal")
# FASTSim's electric car knows no speeds and no voltage. Its results depend on powers alone, so these are ours.
GEAR_RATIO, MOTOR_N_M, MOTOR_RAD_S, VOLTS = 9.0, 250.0, 1000.0, 400.0


def vehicle(name, balanced=True):
    car = fastsim.Vehicle.from_resource(name)
    if balanced:
        return car
    told = car.to_dict()
    told["pt_type"]["HEV"]["sim_params"]["balance_soc"] = False
    return fastsim.Vehicle.from_dict(told)


def cycle():
    return fastsim.Cycle.from_resource(CYCLE)


def walked(name):
    """What FASTSim says of a car and of its way through the cycle."""
    drive = fastsim.SimDrive(vehicle(name), cycle())
    drive.walk()
    told = drive.to_dict()
    car, history = told["veh"], told["veh"]["history"]
    car["times"] = np.array(told["cyc"]["time_seconds"], dtype=float)
    car["speeds"] = speeds = np.array(told["cyc"]["speed_meters_per_second"], dtype=float)
    (car["kind"], car["train"]), = car["pt_type"].items()
    # FASTSim computes the air's density from height and temperature, and its record says another one: what its drag says counts.
    mean_speeds = 0.5 * (speeds[1:] + speeds[:-1])
    area = car["chassis"]["drag_coef"] * car["chassis"]["frontal_area_square_meters"]
    car["density"] = float(np.sum(history["pwr_drag_watts"][1:]) / np.sum(0.5 * area * mean_speeds**3))
    return car


def walk_s(name, rounds, balanced=True):
    """The best time of a walk that keeps no history."""
    best = float("inf")
    for _ in range(rounds):
        car = vehicle(name, balanced)
        car.set_save_interval(None)
        drive = fastsim.SimDrive(car, cycle())
        begin = time.perf_counter()
        drive.walk()
        best = min(best, time.perf_counter() - begin)
    return best


def power(part, name):
    return np.array(part["history"][name], dtype=float)


def efficiency(part, field):
    """Loads and efficiencies of a component."""
    told = part[field]["data"]
    return np.array(told["grid"][0]["data"]), np.array(told["values"]["data"])


def works(times, power):
    """Work [J] of the positive and of the negative part of a power that is constant over each step that ends at a time."""
    steps = np.diff(times)
    return float(np.sum(np.maximum(power[1:], 0) * steps)), float(np.sum(np.minimum(power[1:], 0) * steps))


def series(values):
    return ", ".join(repr(float(value)) for value in values)


def scenario(car, driveline, step_s, management="", fidelity="Longitudinal"):
    chassis = car["chassis"]
    rotating = chassis["num_wheels"] * chassis["wheel_inertia_kilogram_square_meters"] / chassis["wheel_radius_meters"] ** 2
    area = chassis["drag_coef"] * chassis["frontal_area_square_meters"]
    return f"""(
    about: "{car['name']} through {CYCLE}, as FASTSim has them",
    vehicle: (
        mass_kg: {car['mass_kilograms']!r},
        rotating_mass_kg: {rotating!r},
        drag_area_m2: {area!r},
        driveline: {driveline},
        {management}
    ),
    ground: (terrain: Flat, soil: Constant(coefficient: {chassis['wheel_rr_coef']!r})),
    gravity_m_s2: {GRAVITY},
    air: (density_kg_m3: {car['density']!r}),
    cycle: [Follow(times_s: [{series(car['times'])}], speeds_m_s: [{series(car['speeds'])}])],
    simulation: (fidelity: {fidelity}, step_s: {step_s}),
)
"""


def conventional(car):
    engine = car["train"]["fc"]
    points = ", ".join(
        f"(load: {load!r}, efficiency: {share!r})"
        for load, share in zip(*(column.tolist() for column in efficiency(engine, "eff_interp_from_pwr_out")))
    )
    return f"""EngineByPower(
            max_power_w: {engine['pwr_out_max_watts']!r}, efficiency: [{points}],
            idle_fuel_power_w: {engine['pwr_idle_fuel_watts']!r},
            lower_heating_value_j_kg: {car['train']['fs']['specific_energy_joules_per_kilogram']!r},
            transmission_efficiency: {car['train']['transmission']['eff_interp']!r}, max_force_n: 2e4,
            accessory_power_w: {car['pwr_aux_base_watts'] / car['train']['alt_eff']!r}, alternator_efficiency: {car['train']['alt_eff']!r},
            rotating_mass_kg: 0,
        )"""


def braking_efficiency(motor):
    """The one efficiency of the motor in every step that brakes: FASTSim looks it up at no power, whatever the power."""
    braking = power(motor, "pwr_mech_prop_out_watts") < 0
    told = power(motor, "eff")[braking]
    assert np.ptp(told) < 1e-12 and abs(told[0] - efficiency(motor, "eff_interp_achieved")[1][0]) < 1e-12
    return float(told[0])


def motor_losses(motor, braking):
    """A map of losses by speed and torque from an efficiency by power: P (1/η − 1) driving, −P (1 − η) braking.

    Braking has one efficiency, or where that is `None` the one of driving with the same power."""
    loads, shares = efficiency(motor, "eff_interp_achieved")
    speeds, torques = np.linspace(0, MOTOR_RAD_S, 41), np.linspace(-MOTOR_N_M, MOTOR_N_M, 81)

    def loss(watts):
        share = float(np.interp(min(abs(watts) / motor["pwr_out_max_watts"], 1), loads, shares))
        return watts * (1 / share - 1) if watts >= 0 else -watts * (1 - (share if braking is None else braking))

    rows = ", ".join(f"[{series(loss(speed * torque) for torque in torques)}]" for speed in speeds)
    return f"(speeds_rad_s: [{series(speeds)}], torques_n_m: [{series(torques)}], losses_w: [{rows}])"


def electric(car, braking):
    motor, battery = car["train"]["em"], car["train"]["res"]
    out = np.maximum(power(battery, "pwr_out_electrical_watts"), 0)
    # FASTSim loses a share of the power, Headland R I²: the same at the mean power, weighted by the energy that flows at it.
    share, typical = battery["eff_interp"]["Constant"], float(np.sum(out**2) / np.sum(out))
    current = typical / share / VOLTS
    resistance = (VOLTS * current - typical) / current**2
    car["resistance"], car["typical"] = resistance, typical
    return f"""BatteryElectric(
            motor: (
                max_torque_n_m: {MOTOR_N_M}, max_power_w: {motor['pwr_out_max_watts']!r}, max_speed_rad_s: {MOTOR_RAD_S},
                loss_map: {motor_losses(motor, braking)},
                heat_capacity_j_k: 1e6, cooling_w_k: 2000, coolant_temperature_c: 20, derating_from_c: 150, derating_to_c: 180,
            ),
            gear_ratios: [{GEAR_RATIO}], gear_efficiency: {car['train']['transmission']['eff_interp']!r},
            wheel_radius_m: {car['chassis']['wheel_radius_meters']!r}, rotating_mass_kg: 0, shaft_efficiency: 0.9,
            standby_power_w: {car['pwr_aux_base_watts']!r}, converter_efficiency: 0.95,
            battery: (
                open_circuit: [(charge: 0, voltage_v: {VOLTS}), (charge: 1, voltage_v: {VOLTS})], resistance_ohm: {resistance!r},
                capacity_a_h: {battery['energy_capacity_joules'] / VOLTS / 3600!r}, initial_charge: {battery['history']['soc'][0]!r},
                least_charge: {battery['min_soc']!r}, most_charge: 1, max_discharge_a: 2500, max_charge_a: 2500,
                least_voltage_v: 100, most_voltage_v: 800,
            ),
        )"""


def hybrid(car):
    engine, motor, battery = car["train"]["fc"], car["train"]["em"], car["train"]["res"]
    volts = 207.0
    machine = lambda watts, newton_metres: (
        f"(max_torque_n_m: {newton_metres}, max_power_w: {watts!r}, max_speed_rad_s: 1700, copper_w_per_n2_m2: 0.12, iron_torque_n_m: 0.4, "
        "windage_n_m_s2: 3e-7, constant_loss_w: 60, heat_capacity_j_k: 8e3, cooling_w_k: 60, coolant_temperature_c: 60, "
        "derating_from_c: 150, derating_to_c: 180)"
    )
    driveline = f"""PowerSplitHybrid(
            engine: (
                displacement_m3: 1.8e-3, full_load: [(speed_rad_s: 105, torque_n_m: 110), (speed_rad_s: 380, torque_n_m: 142),
                    (speed_rad_s: 545, torque_n_m: {engine['pwr_out_max_watts'] / 545!r})],
                idle_speed_rad_s: 105, load_share: 0.9, friction_pa: 0.9e5, willans_efficiency: 0.42,
                lower_heating_value_j_kg: 43.2e6, fuel_density_kg_m3: 745, carbon_dioxide: 3.1, accessory_power_w: 0,
                alternator_efficiency: 0.9,
            ),
            motor: {machine(motor['pwr_out_max_watts'], 163)}, generator: {machine(31000.0, 60)},
            planetary_ratio: 2.6, motor_ratio: 3.1, final_ratio: 2.83, gear_efficiency: {car['train']['transmission']['eff_interp']!r},
            wheel_radius_m: {car['chassis']['wheel_radius_meters']!r}, rotating_mass_kg: 0,
            battery: (
                open_circuit: [(charge: 0, voltage_v: 190), (charge: 0.5, voltage_v: {volts}), (charge: 1, voltage_v: 225)],
                resistance_ohm: 0.2, capacity_a_h: {battery['energy_capacity_joules'] / volts / 3600!r}, initial_charge: 0.6,
                least_charge: {battery['min_soc']!r}, most_charge: {battery['max_soc']!r}, max_discharge_a: 180, max_charge_a: 180,
                least_voltage_v: 120, most_voltage_v: 290,
            ),
            standby_power_w: {car['pwr_aux_base_watts']!r}, converter_efficiency: 0.95,
        )"""
    return driveline, (
        "management: Thresholds(start_power_w: 9e3, stop_power_w: 4e3, assist_power_w: 30e3, charge_below: 0.45, charge_until: 0.6, "
        "charging_power_w: 5e3, least_time_s: 5),"
    )


def ours(program, text):
    """The trace of Headland."""
    with tempfile.TemporaryDirectory() as folder:
        path, out = pathlib.Path(folder) / "scenario.ron", pathlib.Path(folder) / "out"
        path.write_text(text)
        subprocess.run([program, "run", path, "--out", out, "--quiet"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        table = parquet.read_table(out / "trace.parquet")
    trace = {name: table[name].to_numpy() for name in table.column_names}
    braked = trace.get("brake_force_n", np.zeros(len(trace["time_s"])))
    trace["wheels_w"] = (trace["tractive_force_n"] - braked) * trace["speed_m_s"]
    return trace


def store_joules(program, text):
    """What the store gave, by the ledger of Headland."""
    with tempfile.TemporaryDirectory() as folder:
        path, out = pathlib.Path(folder) / "scenario.ron", pathlib.Path(folder) / "out"
        path.write_text(text)
        subprocess.run([program, "run", path, "--out", out, "--quiet"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        (run,) = json.loads((out / "summary.json").read_text())["runs"]
    return run["energy"]["source_j"]


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


def row(what, theirs, mine):
    return f"| {what} | {theirs / 1e3:.1f} kJ | {mine / 1e3:.1f} kJ | {100 * (mine / theirs - 1):+.2f} % |"


# What is asked of each figure: of an energy, by how many per cent it may differ; of a rate, how many times FASTSim's it has to be.
MOST_OFF = {"at the wheels": 0.5, "work in sum": 0.5, "fuel": 2.0, "the same": 2.0, "battery": 2.0, "net of its cells": 2.0, "fall of its charge": 2.0}
LEAST_TIMES = {"Fusion": 50, "Prius": 100}


def missed(lines):
    """The figures of the page that are not what is asked, in sentences."""
    told = []
    for line in lines:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        off = next((most for what, most in MOST_OFF.items() if what in cells[0]), None)
        if len(cells) == 4 and off is not None and abs(float(cells[3].rstrip(" %"))) > off:
            told.append(f"{cells[0]} differs by {cells[3]}, and {off} % are allowed")
        times = next((least for car, least in LEAST_TIMES.items() if car in cells[0] and "one pass" not in cells[0]), None)
        if len(cells) == 8 and times is not None and float(cells[3].split()[0]) < times:
            told.append(f"{cells[0]}: {cells[3].split()[0]} times the steps per second, and {times} are asked for")
    return told


def asked(lines):
    """To which of the ratios what is asked refers, and what a single pass of FASTSim makes of it."""
    once = next(line.split("|")[4].split()[0] for line in lines if "one pass" in line)
    return (
        f"The {LEAST_TIMES['Fusion']} times that are asked for a conventional car and the {LEAST_TIMES['Prius']} for a hybrid refer to the column "
        "`QuasiStatic`, no rows, for FASTSim keeps none either, and of the hybrid to FASTSim with its search for a balanced charge; beside a "
        f"single pass of FASTSim Headland makes {float(once):.0f} times its steps with the hybrid."
    )


def at_the_wheels(car, trace):
    theirs = works(car["times"], power(car, "pwr_tractive_watts"))
    mine = trapezoids(trace["time_s"], trace["wheels_w"])
    return [
        row("work that drives, at the wheels", theirs[0], mine[0]),
        row("work that slows down, at the wheels", theirs[1], mine[1]),
        row("work in sum", sum(theirs), sum(mine)),
    ]


def of_the_battery(car, trace):
    battery = car["train"]["res"]
    current = trace["battery_current_a"]
    pairs = [
        ("battery, out of its terminals", "pwr_out_electrical_watts", current * trace["battery_voltage_v"]),
        ("battery, out of its cells", "pwr_out_chemical_watts", current * VOLTS),
    ]
    rows = []
    for what, name, watts in pairs:
        theirs, mine = works(car["times"], power(battery, name)), trapezoids(trace["time_s"], watts)
        rows += [row(what, theirs[0], mine[0]), row(what.replace("out of", "into"), theirs[1], mine[1])]
        rows.append(row(what.replace("out of", "net of"), sum(theirs), sum(mine)))
    charge = [battery["history"]["soc"][0] - battery["history"]["soc"][-1], trace["state_of_charge"][0] - trace["state_of_charge"][-1]]
    rows.append(f"| fall of its charge | {100 * charge[0]:.3f} % | {100 * charge[1]:.3f} % | {100 * (charge[1] / charge[0] - 1):+.2f} % |")
    return rows


def head(car):
    return [f"## {car['name']}", "", "| | FASTSim | Headland | |", "|---|---:|---:|---:|"]


def rates(bench, rounds, turns, cars):
    """Turn and turn about, so that both meet the same moods of the machine."""
    lines = [
        "## Steps per second",
        "",
        "| | FASTSim | `QuasiStatic`, no rows | | `QuasiStatic`, a row each step | | `Longitudinal`, a row each step | |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    thousands = lambda rate: f"{rate:,.0f} 1/s".replace(",", " ")
    for name, car, text in cars:
        kinds = [True] + [False] * (name == HYBRID)
        steps = len(car["times"]) - 1
        theirs, mine = {kind: [] for kind in kinds}, [[] for _ in FIDELITIES]
        for _ in range(turns):
            for rate, fidelity in zip(mine, FIDELITIES):
                for kind in kinds:
                    theirs[kind].append(steps / walk_s(name, rounds, kind))
                rate.append(step_rate(bench, text(fidelity)))
        for balanced in kinds:
            what = f"{car['name']}" + ("" if name != HYBRID else ", with its search for a balanced charge" if balanced else ", one pass")
            best, cells = max(theirs[balanced]), []
            for index, rate in enumerate(mine):
                # A turn's own ratio is that of neighbours in time.
                each = [own / other for own, other in zip(rate, theirs[balanced][index :: len(FIDELITIES)])]
                cells.append(f"{thousands(max(rate))} | {np.median(each):.1f} times ({min(each):.1f} to {max(each):.1f}; {max(rate) / best:.1f})")
            lines.append(f"| {what} | {thousands(best)} | " + " | ".join(cells) + " |")
    return [
        *lines,
        "",
        f"One thread, all with steps of 1 s, the simulation alone, both programs in turn in one session: {turns} turns, in each the best of "
        f"{rounds} walks of FASTSim beside the best of 300 runs of Headland. Rates are the best of all turns. Ratios are the median of those within a turn; in parentheses "
        "the least and the greatest of them, which is what the machine's moods make of it, and that of the best rates. FASTSim keeps no history here. It asks a car once a "
        "step, as `QuasiStatic` does; `Longitudinal` asks four times a step and more. FASTSim repeats a hybrid's cycle until charge is balanced; *one "
        "pass* leaves that out.",
        "",
        asked(lines),
    ]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("headland")
    parser.add_argument("--step-rate")
    parser.add_argument("--markdown")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--turns", type=int, default=7)
    wanted = parser.parse_args()
    fusion, zoe, prius = walked(CONVENTIONAL), walked(ELECTRIC), walked(HYBRID)
    braking = braking_efficiency(zoe["train"]["em"])
    burns, draws, (shares, management) = conventional(fusion), electric(zoe, braking), hybrid(prius)
    runs = (fusion, burns), (zoe, draws), (zoe, electric(zoe, None))
    burnt, drawn, alike = (ours(wanted.headland, scenario(car, text, FINE_STEP_S)) for car, text in runs)
    net = [sum(trapezoids(trace["time_s"], trace["battery_current_a"] * trace["battery_voltage_v"])) for trace in (drawn, alike)]
    heating_value = fusion["train"]["fs"]["specific_energy_joules_per_kilogram"]
    theirs = works(fusion["times"], power(fusion["train"]["fc"], "pwr_fuel_watts"))[0]
    once_burnt, once_drawn = (
        store_joules(wanted.headland, scenario(car, text, STEP_S, fidelity=EACH_STEP)) for car, text in ((fusion, burns), (zoe, draws))
    )
    cells = sum(works(zoe["times"], power(zoe["train"]["res"], "pwr_out_chemical_watts")))
    mine = trapezoids(burnt["time_s"], burnt["fuel_rate_kg_s"] * heating_value)[0]
    miss = max(
        float(np.max(np.abs(np.interp(car["times"], trace["time_s"], trace["speed_m_s"]) - car["speeds"])))
        for car, trace in ((fusion, burnt), (zoe, drawn))
    )
    lines = [
        "# The same cars in FASTSim",
        "",
        "Made by [`benches/peers/udds_fastsim.py`](../../benches/peers/udds_fastsim.py), which says how. "
        f"FASTSim {fastsim.__version__}, {CYCLE}, {len(fusion['times']) - 1} steps of {STEP_S:g} s. Headland misses the speeds of the cycle by at "
        f"most {miss:.1e} m/s.",
        "",
        *head(fusion),
        *at_the_wheels(fusion, burnt),
        row("fuel, by its heating value", theirs, mine),
        row(f"the same, `QuasiStatic` in steps of {STEP_S:g} s", theirs, once_burnt),
        "",
        "The engine's efficiency over power, the efficiency of the transmission and the accessories are FASTSim's own, in an `EngineByPower`. What "
        f"differs: FASTSim takes one power for each step of {STEP_S:g} s, from the mean of its speeds; Headland integrates what flows within "
        f"the step, here in steps of {FINE_STEP_S} s. FASTSim's first second takes no fuel, and its engine may not raise its power faster than in "
        f"{fusion['train']['fc']['pwr_ramp_lag_seconds']:g} s from nothing to all, which this cycle does not ask.",
        "",
        *head(zoe),
        *at_the_wheels(zoe, drawn),
        *of_the_battery(zoe, drawn),
        row(f"net of its cells, `QuasiStatic` in steps of {STEP_S:g} s", cells, once_drawn),
        "",
        "The motor's efficiency over power stands as a `loss_map` of a `BatteryElectric`; gears and consumers are FASTSim's. In every step that "
        f"brakes FASTSim's motor has one efficiency, {braking:g}, that of no power (checked in its record); the map has it so. With the same "
        f"efficiency over power for braking as for driving Headland draws {100 * (net[1] / net[0] - 1):+.1f} % net of the terminals. What differs beside the steps: FASTSim's battery loses "
        f"{100 * (1 - zoe['train']['res']['eff_interp']['Constant']):.2f} % of every power, one with a resistance loses R I²: "
        f"{1e3 * zoe['resistance']:.1f} mΩ at {VOLTS:g} V lose as much at {zoe['typical'] / 1e3:.1f} kW, the mean power out of the battery "
        "weighted by energy. The energy of its cells and its charge depend on that choice, that of its terminals does not.",
        "",
    ]
    if wanted.step_rate:
        cars = [
            (CONVENTIONAL, fusion, lambda fidelity: scenario(fusion, burns, STEP_S, fidelity=fidelity)),
            (ELECTRIC, zoe, lambda fidelity: scenario(zoe, draws, STEP_S, fidelity=fidelity)),
            (HYBRID, prius, lambda fidelity: scenario(prius, shares, STEP_S, management, fidelity)),
        ]
        lines += [
            *rates(wanted.step_rate, wanted.rounds, wanted.turns, cars),
            "",
            "The hybrid in Headland is a `PowerSplitHybrid` with `Thresholds`, its mass, drag, powers and battery those of FASTSim's car; gears, losses "
            "and thresholds are ours. Two managements of their own make two different runs, so only their speed is compared.",
            "",
        ]
    print("\n".join(lines))
    if wanted.markdown:
        pathlib.Path(wanted.markdown).write_text("\n".join(lines))
    if told := missed(lines):
        sys.exit("not met: " + "; ".join(told))


if __name__ == "__main__":
    main()
