use super::*;

fn build(text: &str) -> Result<Harvester, String> {
    let mut task: Harvester = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(text)
        .map_err(|error| error.to_string())?;
    task.settle(Path::new(".")).map_err(|refusal| refusal.to_string())?;
    Ok(task)
}

const BALER: &str = "(machine: \"baler, round, variable chamber\", width_m: 6, crop_kg_per_m2: 0.4, kept_share: 1, \
                     capacity_kg: 300, empty_rate_kg_s: 100, empty_power_w: 2000, bale: true)";

fn at(speed_m_s: f64) -> Situation {
    Situation { speed_m_s, gravity_m_s2: 10.0, ..Situation::default() }
}

/// 0.4 kg/m² · 6 m · 2.5 m/s = 6 kg/s = 21.6 t/h; half full g = ½ + 3/8: 4 + 1.1 · 21.6 · 0.875 = 24.79 kW; the straw
/// takes 6 kg/s · 2.5 m/s = 15 N.
#[test]
fn a_round_baler_half_full_by_hand() {
    let mut rates = [0.0; 3];
    let load = build(BALER).unwrap().load(&at(2.5), &[150.0, 0.0, 0.0], &mut rates);
    assert!((load.pto_power_w / 24_790.0 - 1.0).abs() < 1e-12);
    assert!((load.drawbar_force_n - 15.0).abs() < 1e-12 && load.mass_kg == 150.0);
    assert!((rates[PAYLOAD] - 6.0).abs() < 1e-12 && rates[AREA] == 15.0);
}

/// The table holds for a whole bale: Simpson's rule is exact for the parabola g.
#[test]
fn the_mean_power_over_a_bale_is_that_of_the_table() {
    let (baler, steady) =
        (build(BALER).unwrap(), build(&BALER.replace("bale: true", "bale: false")).unwrap());
    let power =
        |task: &Harvester, payload| task.load(&at(2.5), &[payload, 0.0, 0.0], &mut [0.0; 3]).pto_power_w;
    let mean = (power(&baler, 0.0) + 4.0 * power(&baler, 150.0) + power(&baler, 300.0)) / 6.0;
    assert!((mean / power(&steady, 0.0) - 1.0).abs() < 1e-12);
}

#[test]
fn it_is_emptied_at_its_rate_and_takes_the_power_for_it() {
    let mut rates = [0.0; 3];
    let baler = build(BALER).unwrap();
    let load = baler.load_in(Mode::Empty, &at(0.0), &[300.0, 0.0, 0.0], &mut rates);
    assert_eq!((rates, load.pto_power_w), ([-100.0, 0.0, 0.0], 6000.0));
    let load = baler.load_in(Mode::Rest, &at(2.0), &[300.0, 0.0, 0.0], &mut rates);
    assert_eq!((rates, load), ([0.0; 3], Load { mass_kg: 300.0, ..Load::default() }));
}

#[test]
fn what_it_cannot_do_is_told() {
    let baler = build(BALER).unwrap();
    assert!(baler.trouble(Mode::Work, &at(2.0), &[300.1, 0.0, 0.0]).unwrap().contains("full"));
    assert!(baler.trouble(Mode::Empty, &at(0.0), &[-0.1, 0.0, 0.0]).unwrap().contains("empty"));
    assert!(baler.trouble(Mode::Fill, &at(0.0), &[0.0; 3]).unwrap().contains("its work alone"));
    assert_eq!(baler.trouble(Mode::Work, &at(2.0), &[299.0, 0.0, 0.0]), None);
    assert!(build(&BALER.replace("bale: true", "initial_kg: 301")).unwrap_err().contains("initial_kg"));
}
