//! Every kind of plot and item on one page, from formulas: `cargo run -p headland-report --example gallery -- gallery.html`.

use headland_report::build::{self, Parameter};
use headland_report::{
    Axis, Bar, Bars, Cell, Cloud, Figure, Interval, Item, Line, Lines, Mark, Plot, Report, Scatter, Section,
    Series, Table, Tone,
};
use headland_trace::{Origin, Trace};
use std::error::Error;
use std::path::Path;

/// Mass of the vehicle of the gallery, in kg.
const MASS_KG: f64 = 13_000.0;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("expected the file to write, as in `gallery.html`")?;
    let (measured, predicted) = (drive(0.0, 1.0)?, drive(0.4, 0.0)?);
    let report = Report::new(
        "Gallery of a report",
        "Each kind of plot, table and figure once. Nothing here was measured: all numbers come from formulas.",
    )
    .with(overview())
    .with(over_time(&measured, &predicted)?)
    .with(ground(&measured, &predicted)?)
    .with(balances(&predicted)?)
    .with(statistics(&measured, &predicted)?)
    .with(awkward());
    report.write(Path::new(&path))?;
    Ok(())
}

/// A lap at about 8 m/s, by formula; `noise` scales a fixed pattern on the speed.
fn drive(slower_m_s: f64, noise: f64) -> Result<Trace, Box<dyn Error>> {
    let time: Vec<f64> = (0..60_000).map(|step| f64::from(step) * 0.01).collect();
    let ripple = |t: f64| noise * 0.08 * ((t * 37.0).sin() + (t * 91.7).sin() + (t * 13.3).cos());
    let soft = |t: f64| if (210.0..290.0).contains(&t) { 1.0 } else { 0.0 };
    let clean = |t: f64| 8.0 + 2.0 * (t / 40.0).sin() + 0.5 * (t / 7.0).cos() - slower_m_s * soft(t);
    let angle = |t: f64| std::f64::consts::TAU * t / 640.0;
    let channel = |value: &dyn Fn(f64) -> f64| time.iter().map(|t| value(*t)).collect::<Vec<f64>>();
    // The sensor is out for three seconds.
    let speed = channel(&|t| {
        if noise > 0.0 && (400.0..403.0).contains(&t) { f64::NAN } else { clean(t) + ripple(t) }
    });
    let mut trace = Trace::new(time.clone())?;
    let mut add = |name: &str, values: Vec<f64>| trace.push(name, values, Origin::Predicted);
    add("speed_m_s", speed)?;
    add("east_m", channel(&|t| 420.0 * angle(t).sin() + 60.0 * (3.0 * angle(t)).sin()))?;
    add("north_m", channel(&|t| 260.0 * (1.0 - angle(t).cos())))?;
    add(
        "heading_rad",
        channel(&|t| {
            let east = 420.0 * angle(t).cos() + 180.0 * (3.0 * angle(t)).cos();
            east.atan2(260.0 * angle(t).sin())
        }),
    )?;
    add("rolling_resistance_n", channel(&|t| -MASS_KG * 9.81 * (0.05 + 0.02 * soft(t))))?;
    add("air_drag_n", channel(&|t| -0.5 * 1.2 * 6.0 * clean(t).powi(2)))?;
    add("grade_force_n", channel(&|t| -MASS_KG * 9.81 * 0.02 * (t / 60.0).sin()))?;
    add("tractive_force_n", channel(&|t| 7_500.0 + 2_600.0 * (t / 60.0).sin() + 2_500.0 * soft(t)))?;
    Ok(trace)
}

fn soft_patch() -> Vec<Interval> {
    vec![Interval { from: 210.0, to: 290.0, label: "soft patch".to_owned() }]
}

fn overview() -> Section {
    let mut braking = Figure::new("Energy into the brakes", 0.0, "J");
    braking = braking.note("no braking in this lap");
    Section::new("Key figures")
        .with(Item::Figures(vec![
            Figure::new("RMSE of speed", 0.213, "m/s").note("at most 0.25 is asked for").tone(Tone::Good),
            Figure::new("Work at the wheels", 36.4e6, "J").note("4.1 % below the recording").tone(Tone::Good),
            Figure::new("Greatest residual", 0.71, "m/s").note("at most 0.5 is asked for").tone(Tone::Bad),
            Figure::new("Greatest tractive force", 12_600.0, "N"),
            braking,
        ]))
        .with(Item::Words("A paragraph stands wherever it is needed.".to_owned()))
        .with(Item::Sentences(vec![
            "Mass and rolling resistance cannot be separated: only their product acts.".to_owned(),
            "The wind was not logged; a constant head wind would look like drag.".to_owned(),
        ]))
}

fn over_time(measured: &Trace, predicted: &Trace) -> Result<Section, Box<dyn Error>> {
    let speed =
        build::over_time("speed_m_s", &[("measured", measured), ("simulated", predicted)], soft_patch())?;
    let residual = build::residual_over_time("speed_m_s", measured, predicted, Some(0.1), soft_patch())?;
    let temperature: Vec<f64> = (0..=60).map(|minute| f64::from(minute) * 10.0).collect();
    let value: Vec<f64> = temperature.iter().map(|t| 40.0 + 35.0 * (1.0 - (-t / 150.0).exp())).collect();
    let width: Vec<f64> = temperature.iter().map(|t| 6.0 * (-t / 300.0).exp() + 1.0).collect();
    let edge = |sign: f64| value.iter().zip(&width).map(|(v, w)| v + sign * w).collect::<Vec<f64>>();
    let readings: Vec<f64> = value.iter().zip(&temperature).map(|(v, t)| v + 1.5 * (t * 0.7).sin()).collect();
    let oil = Lines::over_time(
        Axis::of("oil_temperature_c"),
        vec![
            Series::new("estimate (95 % band)", temperature.clone(), value.clone())
                .band(edge(-1.0), edge(1.0)),
            Series::new("readings", temperature, readings).drawn(Line::Dots),
        ],
    )
    .marked(vec![
        Mark { at: 70.0, label: "working temperature".to_owned(), level: true },
        Mark { at: 290.0, label: "firm again".to_owned(), level: false },
    ]);
    Ok(Section::new("Over time")
        .words("Drag across one plot to zoom into all three; double-click to see everything again.")
        .with(speed)
        .with(residual)
        .with(Plot::new("Temperature of the oil", oil)))
}

fn ground(measured: &Trace, predicted: &Trace) -> Result<Section, Box<dyn Error>> {
    Ok(Section::new("Where")
        .with(build::path_map(measured, Some("speed_m_s"), &soft_patch())?)
        .with(build::residual_against("speed_m_s", "speed_m_s", measured, predicted)?))
}

fn balances(predicted: &Trace) -> Result<Section, Box<dyn Error>> {
    let flow = build::energy_flow(
        "vehicle",
        &[("fuel", 110.2e6), ("kinetic energy", 0.6e6)],
        &[
            ("heat of the engine", 66.1e6),
            ("driveline", 8.2e6),
            ("rolling resistance", 31.0e6),
            ("air", 1.3e6),
            ("grade", -0.4e6),
            ("auxiliaries", 4.5e6),
            ("kinetic energy", 0.1e6),
        ],
    );
    let named =
        |name: &str, values: [f64; 4]| Bar { name: name.to_owned(), values: values.to_vec(), error: None };
    let consumption = Bars {
        categories: ["ploughing", "transport", "seeding", "mixed day"].map(str::to_owned).to_vec(),
        axis: Axis::new("fuel", "kg"),
        bars: vec![
            named("engine", [31.0, 12.0, 18.0, 61.0]),
            named("driveline", [6.0, 2.5, 3.0, 11.5]),
            named("auxiliaries", [2.0, 1.0, 4.0, 7.0]),
        ],
        stacked: true,
        horizontal: false,
    };
    Ok(Section::new("Forces and energy")
        .with(build::force_budget(predicted, &[], true)?)
        .with(Plot {
            title: "Traction against rolling resistance".to_owned(),
            ..build::force_budget(predicted, &["tractive_force_n", "rolling_resistance_n"], false)?
        })
        .with(flow)
        .with(Plot::new("Fuel by cycle", consumption)))
}

fn statistics(measured: &Trace, predicted: &Trace) -> Result<Section, Box<dyn Error>> {
    let parameter = |name: &str, prior, value, half| Parameter {
        name: name.to_owned(),
        prior,
        value,
        ci95: (value - half, value + half),
    };
    let parameters = build::parameter_table(
        "Estimates",
        &[
            parameter("mass_kg", 13_000.0, 13_012.4, 31.0),
            parameter("rolling_coefficient", 0.06, 0.069_04, 0.002_1),
            parameter("drag_area_m2", 6.0, 5.43, 0.62),
            parameter("wind_speed_m_s", f64::NAN, 5.31, 0.42),
        ],
    );
    let correlation = build::correlation(
        &["mass_kg", "rolling_coefficient", "drag_area_m2", "wind_speed_m_s"],
        &[
            vec![1.0, -0.91, 0.12, 0.05],
            vec![-0.91, 1.0, -0.34, f64::NAN],
            vec![0.12, -0.34, 1.0, 0.77],
            vec![0.05, f64::NAN, 0.77, 1.0],
        ],
    );
    let thinner = |trace: &Trace| -> Result<Vec<f64>, Box<dyn Error>> {
        Ok(trace.require("speed_m_s")?.iter().step_by(60).copied().collect())
    };
    let (one, other) = (thinner(measured)?, thinner(predicted)?);
    let distribution = build::cumulative_probability(
        Axis::of("speed_m_s"),
        &[("measured", &one, 0.06), ("simulated", &other, 0.0)],
    );
    let trips = ["city, winter", "city, summer", "motorway with a rather long name", "field road"];
    let bar = |name: &str, values: [f64; 4], half: f64| Bar {
        name: name.to_owned(),
        values: values.to_vec(),
        error: Some((values.map(|v| v - half).to_vec(), values.map(|v| v + half).to_vec())),
    };
    let errors = Bars {
        categories: trips.map(str::to_owned).to_vec(),
        axis: Axis::new("RMSE of speed", "m/s"),
        bars: vec![
            bar("before", [0.61, 0.44, 0.83, 0.52], 0.06),
            bar("after", [0.22, 0.18, 0.31, 0.2], 0.03),
        ],
        stacked: false,
        horizontal: true,
    };
    let metrics = Table {
        title: "Agreement".to_owned(),
        columns: vec![
            Axis::new("channel", ""),
            Axis::new("bias", ""),
            Axis::new("RMSE", ""),
            Axis::new("rating", ""),
            Axis::new("note", ""),
        ],
        rows: vec![
            vec!["speed [m/s]".into(), (-0.053).into(), 0.213.into(), 0.94.into(), "validated".into()],
            vec!["tractive force [N]".into(), 121.0.into(), 1_840.7.into(), 0.81.into(), "validated".into()],
            vec![
                "coasting".into(),
                Cell::Number(f64::NAN),
                Cell::Number(f64::NAN),
                Cell::Number(f64::NAN),
                "driven: not counted".into(),
            ],
        ],
    };
    Ok(Section::new("Statistics")
        .with(metrics)
        .with(parameters)
        .with(correlation)
        .with(distribution)
        .with(Plot::new("Before and after", errors)))
}

/// What is apt to break a page: hostile names, one sample, none, twelve series.
fn awkward() -> Section {
    let name = "r1</script><b onmouseover=\"alert(1)\">&";
    let x: Vec<f64> = (0..200).map(f64::from).collect();
    let many = (0..12)
        .map(|index| {
            let shift = f64::from(index);
            Series::new(
                format!("run {}", index + 1),
                x.clone(),
                x.iter().map(|x| shift + (x / 20.0 + shift).sin()).collect::<Vec<_>>(),
            )
        })
        .collect();
    let cloud = |name: &str, shift: f64| Cloud {
        name: name.to_owned(),
        x: x.clone(),
        y: x.iter().map(|x| shift + (x * 1.7).sin()).collect(),
        colour: None,
        joined: false,
    };
    Section::new("Awkward things")
        .with(Plot::new(
            name,
            Lines::over_time(Axis::new("speed", "m/s"), vec![Series::new(name, [0.0, 1.0], [1.0, 2.0])]),
        ))
        .with(Plot::new("Nothing was recorded", Lines::over_time(Axis::of("speed_m_s"), Vec::new())))
        .with(Plot::new("Twelve runs", Lines::over(Axis::of("position_m"), Axis::of("speed_m_s"), many)))
        .with(Plot::new(
            "Two clouds without colours",
            Scatter {
                x: Axis::of("speed_m_s"),
                y: Axis::new("residual force", "N"),
                clouds: vec![cloud("there", 0.0), cloud("back", 1.0)],
            },
        ))
}
