use super::*;
use crate::course::Course;
use crate::hidden::Law;

fn tractor(creep: f64) -> Vehicle {
    Vehicle {
        mass_kg: 13_019.3,
        turning_kg: 700.0,
        drag_area_m2: 0.0,
        ground: Ground::Linear { coefficient: 0.069, scale_m_s: 100.0 / 3.6 },
        air_density_kg_m3: 1.2,
        gravity_m_s2: 9.81,
        creep,
        pitch_gain_rad_s2_m: 0.002,
        pitch_hz: 1.6,
        pitch_damping: 0.3,
        antenna_m: 0.0,
        electric: None,
        engine: None,
    }
}

fn begin(speed_m_s: f64) -> Begin {
    Begin {
        position_m: 0.0,
        speed_m_s,
        before_s: 0.0,
        reversed: false,
        run: 0,
        passes_before: 0.0,
        extra_mass_kg: 0.0,
        air_c: 15.0,
        lane_m: 0.0,
        wind: [0.0, 0.0],
    }
}

const NEVER: Stop = Stop { after_s: 100.0, below_m_s: 1.0 };

/// dv/dt = −c g μ (1 + v/v_s), μ = m / (m + m_w): v = (v₀ + v_s) e^(−c g μ t / v_s) − v_s.
#[test]
fn a_coast_down_follows_the_closed_form_within_a_thousandth() {
    let vehicle = tractor(5e-4);
    let v_s = 100.0 / 3.6;
    let samples = drive(&vehicle, &Course::default(), &[], &Goal::Coast, &begin(30.0 / 3.6), NEVER);
    let share = 13_019.3 / 13_719.3;
    for sample in samples.iter().step_by(500) {
        let closed = (30.0 / 3.6 + v_s) * (-0.069 * 9.81 * share * sample.time_s / v_s).exp() - v_s;
        let error = (sample.speed_m_s / closed - 1.0).abs();
        assert!(error < 1e-3, "{} s: {} and {closed} m/s", sample.time_s, sample.speed_m_s);
    }
    let last = samples.last().unwrap();
    assert!(last.time_s > 8.0, "it rolls for {} s", last.time_s);
}

/// m dv/dt = −½ ρ A v²: v = v₀ / (1 + k v₀ t), k = ½ ρ A / m.
#[test]
fn air_alone_slows_it_as_a_hyperbola() {
    let vehicle = Vehicle {
        drag_area_m2: 8.0,
        ground: Ground::Linear { coefficient: 0.0, scale_m_s: 1.0 },
        ..tractor(5e-4)
    };
    let samples = drive(&vehicle, &Course::default(), &[], &Goal::Coast, &begin(15.0), NEVER);
    let last = samples.last().unwrap();
    let k = 0.5 * 1.2 * 8.0 / 13_719.3;
    let closed = 15.0 / (1.0 + k * 15.0 * last.time_s);
    assert!((last.speed_m_s / closed - 1.0).abs() < 1e-4, "{} {closed}", last.speed_m_s);
}

#[test]
fn work_is_kinetic_energy_and_losses() {
    let plan = Goal::Follow(vec![(0.0, 3.0), (10.0, 9.0), (20.0, 9.0), (30.0, 4.0)]);
    let law = Law::Wind { speed_m_s: 5.0, from_rad: 0.4 };
    let vehicle = Vehicle { drag_area_m2: 6.0, ..tractor(5e-4) };
    let stop = Stop { after_s: 35.0, below_m_s: 0.5 };
    let samples = drive(&vehicle, &Course::default(), &[law], &plan, &begin(3.0), stop);
    let (first, last) = (samples.first().unwrap(), samples.last().unwrap());
    let gain = last.kinetic_j - first.kinetic_j;
    let gap = (last.work_j - last.lost_j - gain).abs();
    // The implicit rule takes a little of the creep's energy; a thousandth of the work is far below any sensor.
    assert!(gap < 1e-3 * last.work_j, "work {} lost {} gain {gain}", last.work_j, last.lost_j);
    assert!(last.work_j > 5e5);
}

/// Steady pull F: slip k F / N.
#[test]
fn wheels_creep_in_proportion_to_pull() {
    let plan = Goal::Follow(vec![(0.0, 5.0)]);
    let law = Law::WheelSlip { coefficient: 0.2 };
    let stop = Stop { after_s: 60.0, below_m_s: 0.5 };
    let samples = drive(&tractor(1e-9), &Course::default(), &[law], &plan, &begin(5.0), stop);
    let last = samples.last().unwrap();
    let expected = 0.2 * last.drive_n / (13_019.3 * 9.81);
    let slip = 1.0 - last.speed_m_s / last.wheel_speed_m_s;
    assert!((slip / expected - 1.0).abs() < 0.01, "{slip} {expected}");
    assert!((last.drive_n / (0.069 * 1.18 * 13_019.3 * 9.81) - 1.0).abs() < 0.01);
}

/// Uphill at slope θ an accelerometer at steady speed feels g sin θ; the slope costs m g sin θ.
#[test]
fn a_slope_is_felt_and_turns_with_the_direction() {
    let plan = Goal::Follow(vec![(0.0, 5.0)]);
    let law = Law::GradeConstant { grade: 0.03 };
    let stop = Stop { after_s: 80.0, below_m_s: 0.5 };
    let mut forces = Vec::new();
    for (reversed, sign) in [(false, 1.0), (true, -1.0)] {
        let begin = Begin { reversed, ..begin(5.0) };
        let samples =
            drive(&tractor(1e-4), &Course::default(), std::slice::from_ref(&law), &plan, &begin, stop);
        let last = samples.last().unwrap();
        assert!((last.specific_force_m_s2 / (sign * 9.81 * 0.03_f64.atan().sin()) - 1.0).abs() < 0.02);
        forces.push(last.drive_n);
    }
    let difference = forces[0] - forces[1];
    assert!((difference / (2.0 * 13_019.3 * 9.81 * 0.03_f64.atan().sin()) - 1.0).abs() < 0.005, "{forces:?}");
}

/// The pitch settles at γ a and rings at its own frequency meanwhile.
#[test]
fn the_body_pitches_with_acceleration() {
    let plan = Goal::Follow(vec![(0.0, 3.0), (20.0, 13.0)]);
    let stop = Stop { after_s: 19.0, below_m_s: 0.5 };
    let samples = drive(&tractor(1e-4), &Course::default(), &[], &plan, &begin(3.0), stop);
    let last = samples.last().unwrap();
    let acceleration = (last.speed_m_s - samples[samples.len() - 1001].speed_m_s) / 1.0;
    assert!((last.pitch_rad / (0.002 * acceleration) - 1.0).abs() < 0.05);
    assert!((last.specific_force_m_s2 - acceleration - 9.81 * last.pitch_rad).abs() < 0.01);
}

/// Braking from 10 m/s with 1 m/s² asks for 25 kW; the drive may give back 12 kW, and brakes do the rest.
#[test]
fn where_the_drive_may_not_brake_friction_brakes_do() {
    let plan = Goal::Follow(vec![(0.0, 10.0), (3.0, 10.0), (9.0, 4.0)]);
    let stop = Stop { after_s: 9.0, below_m_s: 0.5 };
    let limit = Law::RegenerationLimit { power_w: 12_000.0, no_speed_m_s: 1.0, full_speed_m_s: 2.0 };
    let free = drive(&tractor(1e-4), &Course::default(), &[], &plan, &begin(10.0), stop);
    let limited = drive(&tractor(1e-4), &Course::default(), &[limit], &plan, &begin(10.0), stop);
    let last = (free.last().unwrap(), limited.last().unwrap());
    assert!((last.0.speed_m_s - last.1.speed_m_s).abs() < 0.02, "{} {}", last.0.speed_m_s, last.1.speed_m_s);
    let least =
        |samples: &[Sample]| samples.iter().map(|one| one.drive_n * one.wheel_speed_m_s).fold(0.0, f64::min);
    assert!(least(&free) < -20_000.0, "{}", least(&free));
    assert!((least(&limited) / -12_000.0 - 1.0).abs() < 1e-6, "{}", least(&limited));
    assert!(limited.iter().any(|one| one.hidden[0] < -500.0));
}

/// What the engine lacks when the load steps up comes with the time constant of the boost.
#[test]
fn an_engine_without_boost_falls_behind_and_catches_up() {
    let plan = Goal::Follow(vec![(0.0, 3.0), (2.0, 3.0), (7.0, 8.0), (50.0, 8.0)]);
    let stop = Stop { after_s: 50.0, below_m_s: 0.5 };
    let lag = Law::TurboLag { time_constant_s: 1.5, unboosted_power_w: 30_000.0 };
    let samples = drive(&tractor(1e-4), &Course::default(), &[lag], &plan, &begin(3.0), stop);
    let lacking =
        |from: usize, to: usize| samples[from..to].iter().map(|one| one.hidden[0]).fold(0.0, f64::min);
    assert!(lacking(2000, 7000) < -1000.0, "{}", lacking(2000, 7000));
    assert!(lacking(48_000, 49_900) > -50.0, "{}", lacking(48_000, 49_900));
}

/// A flap opens at 8 m/s and stays open until 5 m/s.
#[test]
fn a_latch_remembers() {
    use crate::hidden::Unlisted;
    let plan = Goal::Follow(vec![(0.0, 4.0), (8.0, 10.0), (16.0, 3.0)]);
    let stop = Stop { after_s: 16.0, below_m_s: 0.5 };
    let law = Law::Other(Unlisted::Latch { force_n: 100.0, on_m_s: 8.0, off_m_s: 5.0 });
    let samples = drive(&tractor(1e-4), &Course::default(), &[law], &plan, &begin(4.0), stop);
    let open_at_6: Vec<bool> = samples
        .iter()
        .filter(|one| (one.speed_m_s - 6.0).abs() < 0.05)
        .map(|one| one.hidden[0] < 0.0)
        .collect();
    assert!(!open_at_6[0] && open_at_6[open_at_6.len() - 1]);
}
