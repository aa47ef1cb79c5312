use super::*;

fn build(text: &str) -> Result<Tillage, String> {
    let mut task: Tillage = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(text)
        .map_err(|error| error.to_string())?;
    task.settle(Path::new(".")).map_err(|refusal| refusal.to_string())?;
    Ok(task)
}

fn at_km_h(speed: f64) -> Situation {
    Situation { speed_m_s: speed / 3.6, gravity_m_s2: 10.0, ..Situation::default() }
}

fn draft_n(text: &str, speed_km_h: f64) -> f64 {
    build(text).unwrap().load(&at_km_h(speed_km_h), &[0.0], &mut [0.0]).drawbar_force_n
}

const PLOUGH: &str = "(implement: \"moldboard plough\", texture: Fine, width_m: 0.3, depth_m: 0.15)";

/// The same on a hitch.
fn hitched() -> String {
    PLOUGH.replace(
        "depth_m: 0.15",
        "depth_m: 0.15, hitch: (mass_kg: 1800, height_m: 0.8, time_s: 3, efficiency: 0.75, working_share: 0.2, \
         lifted_share: 1)",
    )
}

/// (652 + 5.1 · 2.5²) · 0.3 · 15 = 683.875 · 4.5 N.
#[test]
fn a_moldboard_plough_of_30_cm_by_hand() {
    assert!((draft_n(PLOUGH, 2.5) / 3077.4375 - 1.0).abs() < 1e-12);
    assert!((draft_n(&PLOUGH.replace("Fine", "Medium"), 2.5) / (0.7 * 3077.4375) - 1.0).abs() < 1e-12);
    assert!((draft_n(&PLOUGH.replace("Fine", "Coarse"), 2.5) / (0.45 * 3077.4375) - 1.0).abs() < 1e-12);
}

/// 0.7 · (91 + 5.4 · 10) · 45 · 15 = 68 512.5 N. The published case takes 0.7, the table 0.85 in medium soil.
#[test]
fn a_chisel_plough_of_45_tools_as_published() {
    let chisel = "(implement: \"chisel plough, straight points\", texture: Factor(0.7), width_m: 13.7, tools: 45, \
                  depth_m: 0.15)";
    assert!((draft_n(chisel, 10.0) / 68_512.5 - 1.0).abs() < 1e-12);
    let own = "(draft: (a: 91, b: 5.4, c: 0, per_tool: true), texture: Factor(0.7), width_m: 13.7, tools: 45, \
               depth_m: 0.15)";
    assert_eq!(draft_n(own, 10.0), draft_n(chisel, 10.0));
    assert!((draft_n(&chisel.replace("Factor(0.7)", "Medium"), 10.0) / 68_512.5 - 0.85 / 0.7).abs() < 1e-12);
}

/// 24 rows of 200 N, whatever speed and depth.
#[test]
fn a_drill_counts_rows_and_neither_speed_nor_depth() {
    let drill = "(implement: \"grain drill\", texture: Coarse, width_m: 3, tools: 24)";
    assert_eq!((draft_n(drill, 0.0), draft_n(drill, 12.0)), (4800.0, 4800.0));
}

#[test]
fn draft_and_area_follow_the_hitch() {
    let task = build(&hitched()).unwrap();
    assert_eq!(task.states()[LIFTED].initial, 1.0);
    let mut rates = [0.0; 2];
    let half = task.load_in(Mode::Rest, &at_km_h(2.5), &[0.0, 0.5], &mut rates);
    assert!((half.drawbar_force_n / (0.5 * 3077.4375) - 1.0).abs() < 1e-12);
    assert!((half.hydraulic_power_w - 6400.0).abs() < 1e-9 && rates[LIFTED] > 0.0);
    assert!((rates[AREA] - 0.5 * 0.3 * 2.5 / 3.6).abs() < 1e-12);
    let up = task.load_in(Mode::Rest, &at_km_h(2.5), &[0.0, 1.0], &mut rates);
    assert_eq!(up, Load { mass_kg: 1800.0, ..Load::default() });
    assert_eq!(rates, [0.0, 0.0]);
}

/// Width, depth and way of the hitch as the scenario says them; coulters, whose depth nothing says, on top of the ground.
#[test]
fn its_tools_hang_on_the_hitch_as_deep_as_they_work() {
    let hangs = |text: &str| build(text).unwrap().implement().unwrap();
    let plough = Implement { width_m: 0.3, depth_m: Some(0.15), tools: None, lift_m: None };
    assert_eq!(hangs(PLOUGH), plough);
    assert_eq!(hangs(&hitched()), Implement { lift_m: Some(0.8), ..plough });
    let drill = hangs("(implement: \"grain drill\", texture: Fine, width_m: 3, tools: 24)");
    assert_eq!(drill, Implement { width_m: 3.0, depth_m: Some(0.0), tools: Some(24.0), lift_m: None });
}

#[test]
fn it_fluctuates_with_the_place_about_its_mean() {
    let rough = PLOUGH.replace(
        "depth_m: 0.15",
        "depth_m: 0.15, fluctuation: (sd: 0.15, length_m: 0.5, trend_sd: 0.1, trend_length_m: 30, seed: 3)",
    );
    let task = build(&rough).unwrap();
    let draft = |position_m: f64| {
        let at = Situation { position_m, ..at_km_h(2.5) };
        task.load(&at, &[0.0], &mut [0.0]).drawbar_force_n
    };
    let mean = (0..20_000).map(|i| draft(f64::from(i))).sum::<f64>() / 20_000.0;
    // 20 km are 670 lengths of the trend: its mean is known to 0.1 · √(2 / 670) = 0.5 % of the draft.
    assert!((mean / 3077.4375 - 1.0).abs() < 0.015, "{mean}");
    assert_ne!(draft(10.0), draft(11.0));
}

#[test]
fn what_is_missing_or_too_much_is_refused_by_name() {
    for (text, told) in [
        ("(implement: \"plough\", texture: Fine, width_m: 1, depth_m: 0.2)", "`implement` is `plough`"),
        ("(texture: Fine, width_m: 1, depth_m: 0.2)", "`implement` is not given"),
        ("(implement: \"subsoiler\", texture: Fine, width_m: 1, depth_m: 0.2)", "`tools` is not given"),
        ("(implement: \"moldboard plough\", texture: Fine, width_m: 1)", "`depth_m` is not given"),
        (
            "(implement: \"grain drill\", texture: Fine, width_m: 3, tools: 24, depth_m: 0.2)",
            "`depth_m` is 0.2",
        ),
        (
            "(implement: \"moldboard plough\", texture: Fine, width_m: 1, depth_m: 0.2, tools: 4)",
            "`tools` is 4",
        ),
        ("(implement: \"moldboard plough\", texture: Factor(0), width_m: 1, depth_m: 0.2)", "`texture` is 0"),
    ] {
        let message = build(text).unwrap_err();
        assert!(message.starts_with(told), "{text}: {message}");
    }
}
