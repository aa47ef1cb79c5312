//! What coast-downs cannot separate, asked of these and said in sentences.
//!
//! A coast-down shows force over effective mass. Each thing that might be at work is a column of the Jacobian; one
//! that is a combination of those before it is invisible beside them, and the combination says what it looks like.

use super::CoastDownError;
use super::fit::{Fitted, Model};
use super::input::SpeedUnit;
use super::motion::Term;
use super::segment::Coast;
use super::study::Study;
use crate::separable::{Blind, blind_directions};
use nalgebra::DMatrix;

/// What the runs see and what they do not.
#[derive(Clone, Debug)]
pub struct Sight {
    terms: Vec<Term>,
    blind: Vec<Blind>,
}

impl Sight {
    /// Asks the runs, at a fit of the road load.
    pub fn of(study: &Study, model: &Model, fitted: &Fitted) -> Result<Self, CoastDownError> {
        let coasts = &study.coasts;
        let terms = candidates(coasts, study.paths.len());
        let clusters = Model { terms: terms.clone(), ..model.clone() }.information(fitted)?;
        let mut information = DMatrix::zeros(terms.len(), terms.len());
        for cluster in &clusters {
            information += &cluster.information;
        }
        let sizes: Vec<f64> = terms.iter().map(|term| size(*term, coasts)).collect();
        let blind = blind_directions(&information, &sizes);
        Ok(Self { terms, blind })
    }

    /// Terms of a road load that have an effect of their own, however weak.
    pub fn separable(&self) -> Vec<Term> {
        let kept = self.terms.iter().enumerate().filter(|(index, term)| match term {
            Term::RotatingMass | Term::SpeedScale => false,
            Term::Headwind { .. } => self.found(*index).is_none(),
            _ => self.found(*index).is_none_or(|blind| !blind.exact),
        });
        let mut terms: Vec<Term> = kept.map(|(_, term)| *term).collect();
        // Asked in another order than told: air drag is sure to be there, a viscous part is not.
        terms.sort_by_key(|term| match term {
            Term::Constant => 0,
            Term::Linear => 1,
            Term::Quadratic => 2,
            _ => 3,
        });
        terms
    }

    /// The same without wind: it is only let in where it stands out.
    pub fn without_wind(&self) -> Vec<Term> {
        let mut terms = self.separable();
        terms.retain(|term| !matches!(term, Term::Headwind { .. }));
        terms
    }

    /// Those that change sign with the direction.
    pub fn directional(&self) -> impl Iterator<Item = Term> {
        self.separable().into_iter().filter(|term| matches!(term, Term::Grade { .. } | Term::Headwind { .. }))
    }

    fn found(&self, candidate: usize) -> Option<&Blind> {
        self.blind.iter().find(|blind| blind.candidate == candidate)
    }
}

fn candidates(coasts: &[Coast], paths: usize) -> Vec<Term> {
    let mut terms = vec![Term::Constant, Term::Quadratic, Term::Linear];
    terms.extend((0..paths).map(|path| Term::Grade { path }));
    terms.extend((0..paths).filter(|path| air(coasts, *path).is_some()).map(|path| Term::Headwind { path }));
    terms.extend([Term::RotatingMass, Term::SpeedScale]);
    terms
}

/// ½ρCdA of the first run on a path.
fn air(coasts: &[Coast], path: usize) -> Option<f64> {
    let coast = coasts.iter().find(|coast| coast.path == path)?;
    coast.half_density_drag_area_kg_m.filter(|k| *k > 0.0)
}

/// The smallest change that would matter in practice: 2 % of the resistance, at top speed where it grows with speed;
/// 0.1 % of grade; 1 m/s of wind; 1 % of mass; 0.5 % of the sensor.
fn size(term: Term, coasts: &[Coast]) -> f64 {
    let force = mean_force_n(coasts);
    let top = coasts.iter().map(|coast| coast.speed_m_s[0]).fold(0.0, f64::max);
    match term {
        Term::Constant => 0.02 * force,
        Term::Linear => 0.02 * force / top,
        Term::Quadratic => 0.02 * force / (top * top),
        Term::Headwind { .. } => 1.0,
        Term::RotatingMass => 0.01 * mean_mass_kg(coasts),
        Term::SpeedScale => 0.005,
        Term::Rolling { .. } | Term::Grade { .. } | Term::Offset => 0.001,
    }
}

fn mean_mass_kg(coasts: &[Coast]) -> f64 {
    coasts.iter().map(|coast| coast.effective_mass_kg).sum::<f64>() / coasts.len() as f64
}

fn mean_force_n(coasts: &[Coast]) -> f64 {
    let force = |coast: &Coast| {
        coast.effective_mass_kg * (coast.speed_m_s[0] - coast.last_m_s()) / coast.duration_s()
    };
    coasts.iter().map(force).sum::<f64>() / coasts.len() as f64
}

/// One sentence for each.
pub fn sentences(study: &Study, sight: &Sight, fitted: &Fitted, unit: Option<SpeedUnit>) -> Vec<String> {
    let mut sentences: Vec<String> = sight.blind.iter().map(|blind| sentence(study, sight, blind)).collect();
    sentences.push(even_part(study, sight));
    if let Some(unit) = unit {
        sentences.push(format!(
            "The unit of v in c_w (1 + v/100) was stated as {} and is not in the data: the other units fit with \
             another c_w, and only a bend of the resistance over speed tells them apart.",
            unit.symbol()
        ));
    }
    if unit.is_some() && study.coasts.iter().any(|coast| coast.half_density_drag_area_kg_m.is_none()) {
        sentences.push(
            "Drag area or air density is not known in every run, so c_w holds the air drag of those runs."
                .to_owned(),
        );
    }
    if study.coasts.len() == 1 {
        sentences.push(
            "With a single run nothing tells what changes from run to run, so there are no intervals."
                .to_owned(),
        );
    } else if fitted.noise.between_runs > 0.0 {
        sentences.push(format!(
            "Resistance varied between runs by {:.2} % of the weight beyond sensor noise: whether ground, grade, wind \
             or temperature changed, the runs do not say.",
            100.0 * fitted.noise.between_runs
        ));
    }
    sentences
}

/// What both directions leave together.
fn even_part(study: &Study, sight: &Sight) -> String {
    let both = sight.terms.iter().enumerate().any(|(index, term)| {
        matches!(term, Term::Grade { .. }) && sight.found(index).is_none_or(|blind| !blind.exact)
    });
    let opening = if both {
        "Both directions separate grade and mean wind along the path from resistance; what resists alike in both"
    } else {
        "What resists alike in both directions"
    };
    let cross =
        study.coasts.iter().find_map(|coast| coast.half_density_drag_area_kg_m).map_or(String::new(), |k| {
            let v = study.coasts.iter().map(|coast| coast.speed_m_s[0]).fold(0.0, f64::max);
            let force = k * (v.hypot(3.0) * v - v * v);
            format!(" (3 m/s across would add {force:.0} N at {v:.1} m/s)")
        });
    format!(
        "{opening} stays in f0 and c_w as one sum: tyres and soil, driveline drag in neutral, a dragging brake, and \
         cross wind that was not recorded{cross}."
    )
}

fn sentence(study: &Study, sight: &Sight, blind: &Blind) -> String {
    let term = sight.terms[blind.candidate];
    let (name, unit) = study.name(term);
    let size = size(term, &study.coasts);
    let looks = blind
        .imitated_by
        .iter()
        .map(|(other, per_unit)| {
            let (name, unit) = study.name(sight.terms[*other]);
            amount(&name, per_unit * size, unit)
        })
        .collect::<Vec<_>>();
    let looks = match looks.split_last() {
        None => String::new(),
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    };
    let own = amount(&name, size, unit);
    let known = format!(
        "it is known to ±{} only (one standard deviation)",
        number(blind.deviation, unit).trim_start_matches('+')
    );
    match (term, blind.exact, looks.is_empty()) {
        (Term::Grade { .. }, true, false) => format!(
            "The {name} and the level of resistance cannot be separated, as it was driven in one direction only: {own} \
             looks like {looks}; drive it in both directions."
        ),
        (Term::RotatingMass, exact, false) => format!(
            "The rotating mass and the level of resistance cannot be separated, as only force over mass is seen: \
             {own} looks like {looks}{}; repeat with a known ballast or against a known force.",
            if exact { String::new() } else { format!(", and {known}") }
        ),
        (Term::SpeedScale, exact, false) => format!(
            "A scale error of the speed sensor and the level of resistance cannot be separated: {own} looks like \
             {looks}{}; check the sensor against a measured distance.",
            if exact { String::new() } else { format!(", and {known}") }
        ),
        (_, true, false) => {
            format!("The {name} cannot be separated from the rest: {own} looks like {looks}.")
        }
        (_, true, true) => format!("The runs do not react to {name} at all."),
        (Term::Linear | Term::Quadratic, false, false) => format!(
            "{name} can hardly be separated in the range of speeds that was driven: {own} looks like {looks}, and \
             {known}; coast down from a higher speed."
        ),
        (_, false, false) => {
            format!("The {name} can hardly be separated: {own} looks like {looks}, and {known}.")
        }
        (_, false, true) => format!("The {name} hardly shows: {known}."),
    }
}

fn amount(name: &str, value: f64, unit: &str) -> String {
    format!("{} of {name}", number(value, unit))
}

/// Three significant digits and the unit; pure numbers in per cent.
fn number(value: f64, unit: &str) -> String {
    let (value, unit) = if unit == "1" { (100.0 * value, "%") } else { (value, unit) };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=6")]
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:+.digits$} {unit}").replacen('-', "−", 1)
}
