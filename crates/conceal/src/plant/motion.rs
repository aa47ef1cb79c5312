//! One run of the plant.

use super::{Driver, Goal, STEP_S, Vehicle};
use crate::course::Course;
use crate::hidden::{Law, Now, Push};

/// When a run ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Longest time of the log [s].
    pub after_s: f64,
    /// Speed below which it ends [m/s].
    pub below_m_s: f64,
}

/// One instant of the plant, before any sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time since the log began [s].
    pub time_s: f64,
    /// Place on the lane [m].
    pub position_m: f64,
    /// Speed of the antenna over ground [m/s].
    pub speed_m_s: f64,
    /// What an accelerometer on the body feels along it [m/s²].
    pub specific_force_m_s2: f64,
    /// Speed of the wheels' rim [m/s].
    pub wheel_speed_m_s: f64,
    /// Torque at the axles over the rolling radius [N].
    pub drive_n: f64,
    /// 1 in neutral.
    pub coasting: f64,
    /// 1 braked.
    pub brake: f64,
    /// Direction of travel [rad].
    pub heading_rad: f64,
    /// Curvature in the direction of travel [1/m].
    pub curvature_per_m: f64,
    /// Motor torque [N m].
    pub motor_torque_n_m: f64,
    /// Motor speed [rad/s].
    pub motor_speed_rad_s: f64,
    /// Terminal voltage [V].
    pub battery_voltage_v: f64,
    /// Terminal current [A].
    pub battery_current_a: f64,
    /// Charge, 0 to 1.
    pub charge: f64,
    /// Temperature of the air [°C].
    pub air_c: f64,
    /// Wind that the anemometer beside the lane shows [m/s].
    pub wind_m_s: f64,
    /// Where it blows from [rad].
    pub wind_from_rad: f64,
    /// Speed of the engine [rad/s].
    pub engine_speed_rad_s: f64,
    /// Torque at its crankshaft [N m].
    pub engine_torque_n_m: f64,
    /// Fuel [kg/s].
    pub fuel_kg_s: f64,
    /// Power of battery or fuel for each newton that resists [W/N].
    pub source_per_n: f64,
    /// Acceleration of the body [m/s²].
    pub acceleration_m_s2: f64,
    /// Load on the ground, hidden parts not included [N].
    pub load_n: f64,
    /// Speed against the air, squared, with its sign [m²/s²].
    pub air_speed_2: f64,
    /// Pitch of the body, nose up [rad].
    pub pitch_rad: f64,
    /// Work of the drive since the run began [J].
    pub work_j: f64,
    /// Energy that resistances took since then [J].
    pub lost_j: f64,
    /// Kinetic energy of body and wheels [J].
    pub kinetic_j: f64,
    /// Unit and value of each hidden cause.
    pub hidden: Vec<f64>,
}

/// Where and how a run begins.
#[derive(Clone, Debug)]
pub(crate) struct Begin {
    pub position_m: f64,
    pub speed_m_s: f64,
    /// Time that it rolls before the log begins [s].
    pub before_s: f64,
    pub reversed: bool,
    pub run: usize,
    pub passes_before: f64,
    pub extra_mass_kg: f64,
    pub air_c: f64,
    /// Where on the ground the lane begins [m].
    pub lane_m: f64,
    /// Wind that is known: towards which it has to be met, north and east [m/s].
    pub wind: [f64; 2],
}

/// Drives a run, a sample a step.
#[allow(clippy::too_many_lines, reason = "one step, read from top to bottom")]
pub(crate) fn drive(
    vehicle: &Vehicle,
    course: &Course,
    laws: &[Law],
    goal: &Goal,
    begin: &Begin,
    stop: Stop,
) -> Vec<Sample> {
    let coasting = *goal == Goal::Coast;
    let load_kg = vehicle.mass_kg + begin.extra_mass_kg;
    let g = vehicle.gravity_m_s2;
    let mut driver = Driver::new(load_kg, -0.25 * load_kg * g, 0.35 * load_kg * g);
    let v0 = begin.speed_m_s;
    driver.settle(
        vehicle.ground.share(v0) * load_kg * g
            + 0.5 * vehicle.air_density_kg_m3 * vehicle.drag_area_m2 * v0 * v0,
    );
    let (mut v, mut u, mut x, mut a) = (v0, v0, begin.position_m, 0.0_f64);
    let (mut pitch, mut pitch_rate) = (0.0_f64, 0.0_f64);
    let mut charge = vehicle.electric.as_ref().map_or(f64::NAN, |electric| electric.charge);
    let mut current_a = 0.0_f64;
    let mut engine_rad_s = 0.0_f64;
    let mut memories = vec![0.0; laws.len()];
    let (mut work_j, mut lost_j) = (0.0, 0.0);
    let (mut braked, mut step) = (false, 0u32);
    let omega = std::f64::consts::TAU * vehicle.pitch_hz;
    let mut samples = Vec::new();
    loop {
        let time_s = f64::from(step) * STEP_S - begin.before_s;
        if time_s > stop.after_s || v < stop.below_m_s {
            return samples;
        }
        let asked_n = driver.ask(goal, time_s, v, braked, STEP_S);
        let (least_n, most_n) = laws.iter().zip(&memories).fold(
            (f64::NEG_INFINITY, f64::INFINITY),
            |(least, most), (law, memory)| {
                let (lower, upper) = law.limits_n(*memory, u);
                (lower.max(least), upper.min(most))
            },
        );
        // Friction brakes make up for what the drive may not brake; nothing makes up for a lack of power.
        let (weakest_n, strongest_n) = vehicle
            .engine
            .as_ref()
            .map_or((f64::NEG_INFINITY, f64::INFINITY), |engine| engine.rim_limits_n(u));
        let allowed_n = asked_n.max(least_n.max(weakest_n)).min(most_n.min(strongest_n));
        let (torque, drive_n) = match &vehicle.electric {
            Some(electric) => {
                let torque = electric.torque_n_m(allowed_n, u);
                (torque, electric.rim_n(torque))
            }
            None => (f64::NAN, allowed_n),
        };
        let (overflow_n, lacking_n) = ((asked_n - least_n).min(0.0), (most_n - asked_n).min(0.0));
        // Forces at mid-step.
        let (v_mid, x_mid) = (v + 0.5 * STEP_S * a, x + 0.5 * STEP_S * v * way(begin.reversed));
        let heading_rad = course.heading_rad(x_mid, begin.reversed);
        let met = [v_mid * heading_rad.cos() + begin.wind[0], v_mid * heading_rad.sin() + begin.wind[1]];
        let air_speed_2 = met[0].hypot(met[1]) * (met[0] * heading_rad.cos() + met[1] * heading_rad.sin());
        let now = Now {
            time_s: time_s + 0.5 * STEP_S,
            position_m: begin.lane_m + x_mid,
            lane_position_m: x_mid,
            air_speed_2,
            known_wind_m_s: begin.wind,
            reversed: begin.reversed,
            run: begin.run,
            passes_before: begin.passes_before,
            speed_m_s: v_mid,
            acceleration_m_s2: a,
            heading_rad,
            curvature_per_m: course.curvature_per_m(x_mid, begin.reversed),
            mass_kg: load_kg,
            gravity_m_s2: g,
            ground_share: vehicle.ground.share(v_mid),
            drag_area_m2: vehicle.drag_area_m2,
            air_density_kg_m3: vehicle.air_density_kg_m3,
            air_c: begin.air_c,
            drive_n,
            coasting,
            current_a,
            asked_n,
            overflow_n,
            lacking_n,
            engine_rad_s,
            fuel_per_shaft: vehicle.engine.as_ref().map_or(0.0, |engine| 1.0 / engine.efficiency),
            shaft_per_electric: vehicle.engine.as_ref().map_or(1.0, |engine| 1.0 / engine.alternator),
            memory: 0.0,
        };
        for (law, memory) in laws.iter().zip(&mut memories) {
            *memory = law.remember(&Now { memory: *memory, ..now }, STEP_S);
        }
        let push = laws
            .iter()
            .zip(&memories)
            .map(|(law, memory)| law.push(&Now { memory: *memory, ..now }))
            .fold(Push::default(), Push::and);
        braked = push.braked;
        let mass = load_kg + push.mass_kg;
        let turning = vehicle.turning_kg + push.turning_kg;
        let cos_slope = (1.0 - push.sin_slope * push.sin_slope).sqrt();
        let load_n = mass * g * cos_slope;
        let ground_n = now.ground_share * load_n;
        let air_n = 0.5 * vehicle.air_density_kg_m3 * vehicle.drag_area_m2 * air_speed_2;
        let body_n = push.forward_n - ground_n - air_n - mass * g * push.sin_slope;
        // Creep by the implicit rule: w = u − v.
        let damping = load_n / ((vehicle.creep + push.creep) * u.max(0.5));
        let w = (u - v + STEP_S * (drive_n / turning - body_n / mass))
            / (1.0 + STEP_S * damping * (1.0 / turning + 1.0 / mass));
        let v_next = v + STEP_S * (body_n + damping * w) / mass;
        let u_next = u + STEP_S * (drive_n - damping * w) / turning;
        let a_next = (v_next - v) / STEP_S;
        let pitch_acceleration = omega * omega * (vehicle.pitch_gain_rad_s2_m * a_next - pitch)
            - 2.0 * vehicle.pitch_damping * omega * pitch_rate;
        let mut sample = Sample {
            time_s,
            position_m: x,
            speed_m_s: v - vehicle.antenna_m * pitch_rate,
            specific_force_m_s2: a_next + g * push.sin_slope + g * pitch.sin(),
            wheel_speed_m_s: u,
            drive_n,
            coasting: f64::from(u8::from(coasting)),
            brake: f64::from(u8::from(push.braked)),
            heading_rad: now.heading_rad,
            curvature_per_m: now.curvature_per_m,
            motor_torque_n_m: torque,
            air_c: begin.air_c,
            wind_m_s: begin.wind[0].hypot(begin.wind[1]),
            wind_from_rad: begin.wind[1].atan2(begin.wind[0]).rem_euclid(std::f64::consts::TAU),
            acceleration_m_s2: a_next,
            load_n: load_kg * g,
            air_speed_2,
            pitch_rad: pitch,
            charge,
            work_j,
            lost_j,
            kinetic_j: 0.5 * (mass * v * v + turning * u * u),
            hidden: laws
                .iter()
                .zip(&memories)
                .map(|(law, memory)| {
                    law.amount(&Now { acceleration_m_s2: a_next, memory: *memory, ..now }, u - v).1
                })
                .collect(),
            ..Sample::default()
        };
        if let Some(electric) = &vehicle.electric {
            let motor = u * electric.gear_ratio / electric.radius_m;
            let power = electric.inverter_w(torque, motor) + electric.standby_w + push.power_w;
            let (voltage, current) = electric.battery(charge, power, push.resistance_ohm, current_a);
            current_a = current;
            charge -= current * STEP_S / (3600.0 * electric.capacity_a_h);
            sample.motor_speed_rad_s = motor;
            sample.battery_voltage_v = voltage;
            sample.battery_current_a = current;
        }
        if let Some(engine) = &vehicle.engine {
            let power = engine.shaft_w(drive_n * u, push.power_w);
            let running = engine.step(power, push.engine_n_m, engine_rad_s);
            engine_rad_s = running.speed_rad_s;
            sample.engine_speed_rad_s = running.speed_rad_s;
            sample.engine_torque_n_m = running.torque_n_m;
            sample.fuel_kg_s = running.fuel_kg_s;
            let driving = drive_n > 0.0 && running.fuel_kg_s > 0.0;
            let share = if driving { 1.0 / engine.transmission } else { engine.transmission };
            sample.source_per_n = if running.fuel_kg_s > 0.0 { share * u / engine.efficiency } else { 0.0 };
        }
        if time_s >= -0.5 * STEP_S {
            samples.push(sample);
        }
        let (v_mean, u_mean) = (0.5 * (v + v_next), 0.5 * (u + u_next));
        work_j += STEP_S * drive_n * u_mean;
        lost_j += STEP_S * (damping * w * (u_mean - v_mean) - body_n * v_mean);
        pitch_rate += STEP_S * pitch_acceleration;
        pitch += STEP_S * pitch_rate;
        x += STEP_S * v_mean * way(begin.reversed);
        (v, u, a) = (v_next, u_next, a_next);
        step += 1;
    }
}

fn way(reversed: bool) -> f64 {
    if reversed { -1.0 } else { 1.0 }
}
