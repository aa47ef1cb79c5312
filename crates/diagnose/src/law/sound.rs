//! Whether a law is one: known in each of its terms, and no map, level or mass in other words.

use crate::Case;
use crate::law::formula::Sought;
use headland_calibrate::statistics::median;
use headland_symbolic::{Law, Target};

/// The first of some laws, where it is sound.
pub fn first_sound(case: &Case, laws: Vec<Law>, sought: &Sought) -> Option<Law> {
    laws.into_iter().next().filter(|law| is_sound(case, law, sought))
}

/// Whether a law draws no map, each of its terms is known, none of several is a level nor any a mass, what is lost on a way is that, and
/// another sensor says nearly all of it too.
pub fn is_sound(case: &Case, law: &Law, sought: &Sought) -> bool {
    /// What less is left of where another sensor is asked is the noise of the first.
    const NEARLY: f64 = 0.9;
    let noise = law.kept.is_some_and(|kept| kept < NEARLY);
    let level = law.each.len() > 1 && law.each.iter().any(is_level);
    let loose = law.terms > 1 && is_loose(law);
    let mass = goes_as_a_mass(case, law, sought);
    let known = !is_undetermined(law) && !loose && !mass && !is_hurried(law) && !level;
    !noise && !is_map(law, sought.target, sought.places()) && known && is_lost(law, sought)
}

/// Whether what is lost on a way is lost, and is not all of it.
pub fn is_lost(law: &Law, sought: &Sought) -> bool {
    !sought.gains(law) && !sought.answers_itself(law)
}

/// Whether a law draws a map: softer ground and slopes are that by their definition, and so is a consumer that is switched
/// with time, beside something else or in several shapes of one. A wave that goes on all the way is none; places where it is on
/// and others where it is off are patches. Nor is what fades with the way from the start: a tyre or a tank that a run begins with.
/// Where nobody recorded places the place is that way, and where all runs begin at one the way says the place.
pub fn is_map(law: &Law, target: Target, (placed, from_one_place): (bool, bool)) -> bool {
    const WAVE: &str = "sin";
    const FADES: [&str; 2] = ["exp(-", "/ (1 + "];
    const PULSE: &str = " - level";
    /// Of a bump or a step: a wave within it goes on nowhere else.
    const ABOUT_A_PLACE: &str = "((x - ";
    let is_place = |name: &str| name == "x" || from_one_place && name == "way";
    // In a run that goes once along its way places and times both say where it is.
    let only = |term: &[&str]| match target {
        Target::Power => ["x", "t"].iter().any(|name| !term.is_empty() && term.iter().all(|own| own == name)),
        _ => term.iter().any(|own| is_place(own)) && term.iter().all(|own| is_place(own) || *own == "t"),
    };
    let terms = law.variables_of_terms();
    let patches = law.text.contains(PULSE) && terms.iter().any(|term| term.iter().all(|own| *own == "x"));
    let way = if placed { "way" } else { "x" };
    let sizes = [format!("{way} / "), format!("abs({way}) / ")];
    let fades = |text: &str| {
        FADES.iter().any(|fades| sizes.iter().any(|size| text.contains(&format!("{fades}{size}"))))
    };
    let bounded = law.text.contains(ABOUT_A_PLACE);
    let alone = terms.len() == 1 && law.names(WAVE) && !patches && !bounded;
    !alone && terms.iter().zip(law.texts()).any(|(term, text)| only(term) && !fades(text))
}

/// Whether a shape is as well none of its own: the scale that it bends over may be anything, a straight line or a level among that,
/// which other terms and free parameters take back. So is a bump of any width, and a step of which nobody knows where it is; how sharp one
/// is the rows need not show.
fn is_loose(law: &Law) -> bool {
    /// A step is somewhere where its place is known to so many of its widths.
    const WIDTHS: f64 = 3.0;
    let half = |constant: &headland_symbolic::Constant| {
        constant.sd.map_or(0.0, |sd| crate::proof::refine::HALF_95 * sd)
    };
    let named = |name: &str| law.constants.iter().find(|constant| constant.name == name);
    let nowhere = law.text.split("tanh((").skip(1).any(|rest| {
        let Some((inner, rest)) = rest.split_once(") / ") else { return false };
        let place = inner.split(' ').find_map(named);
        let width = rest.split(')').next().and_then(named);
        place.zip(width).is_some_and(|(place, width)| half(place) > WIDTHS * width.value.max(half(width)))
    });
    let scale = |constant: &headland_symbolic::Constant| {
        let bump = law.text.split("exp(-((").skip(1).any(|rest| {
            rest.split_once(") / ")
                .is_some_and(|(_, rest)| rest.starts_with(&format!("{})^2", constant.name)))
        });
        if bump {
            return true;
        }
        ["tanh(", "exp(-", "(1 + "].iter().any(|shape| {
            let mut of = law.text.split(shape).skip(1).filter_map(|rest| rest.split(')').next());
            of.any(|inner| inner.ends_with(&format!("/ {}", constant.name)))
        })
    };
    let loose = |constant: &headland_symbolic::Constant| {
        constant.sd.is_some_and(|sd| constant.value < crate::proof::refine::HALF_95 * sd)
    };
    nowhere || law.constants.iter().any(|constant| scale(constant) && loose(constant))
}

/// Whether a law of a force hangs on the acceleration as a mass does, or as one does that was told too large.
pub fn goes_as_a_mass(case: &Case, law: &Law, sought: &Sought) -> bool {
    sought.is_mass(case, law) || sought.hangs(law) && drives_ahead(law)
}

/// Whether a force goes with the acceleration that it makes: beside a mass told too large it takes back what that is too much, and
/// nothing that resists does.
fn drives_ahead(law: &Law) -> bool {
    let amplitudes = || law.constants.iter().filter(|constant| constant.is_amplitude());
    let ahead = |text: &&str| {
        let own = amplitudes().find(|constant| text.starts_with(&format!("{} ", constant.name)));
        own.is_some_and(|own| own.value < 0.0)
    };
    law.texts().iter().filter(|text| text.contains("acceleration")).any(ahead)
}

/// Whether what follows late does so at once, nearly: a speed that is ahead of itself by a moment is an acceleration, which forces make.
pub fn is_hurried(law: &Law) -> bool {
    /// The shortest time constant that a law may have [s]; the search goes a little below it.
    const SHORTEST_S: f64 = 2.5;
    law.constants.iter().any(|constant| constant.name.starts_with("lag") && constant.value < SHORTEST_S)
}

/// Whether a term is the same nearly always, but for a vehicle that stands now and then: a level has names enough in the library.
pub fn is_level(term: &Law) -> bool {
    are_alike(term.prediction.iter().flatten())
}

/// Whether values are of one size nearly always.
pub fn are_alike<'a>(values: impl Iterator<Item = &'a f64>) -> bool {
    /// So far from the median, as a share of it, is the same.
    const ABOUT: f64 = 0.2;
    /// In this share of the samples. What is switched is off for longer.
    const MOST: f64 = 0.85;
    let sizes: Vec<f64> = values.map(|value| value.abs()).collect();
    if sizes.is_empty() {
        return true;
    }
    let middle = median(&sizes);
    let same = sizes.iter().filter(|size| (**size - middle).abs() <= ABOUT * middle).count();
    same as f64 > MOST * sizes.len() as f64
}

/// Whether a term of a law may as well be none: several that take each other back say nothing of any.
fn is_undetermined(law: &Law) -> bool {
    let nothing = |constant: &headland_symbolic::Constant| {
        constant.sd.is_some_and(|sd| constant.value.abs() < crate::proof::refine::HALF_95 * sd)
    };
    law.constants.iter().any(|constant| constant.is_amplitude() && nothing(constant))
}

/// A law of these constants, for the tests.
#[cfg(test)]
pub fn law(text: &str, constants: &[(&str, f64)]) -> Law {
    let constant = |(name, value): &(&str, f64)| headland_symbolic::Constant {
        name: (*name).to_owned(),
        value: *value,
        sd: None,
        unit: "s".to_owned(),
    };
    let constants = constants.iter().map(constant).collect();
    Law { text: text.to_owned(), constants, terms: 1, ..Law::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_that_goes_with_the_acceleration_drives_ahead() {
        let text = "a1_n * exp(-v / v1_m_s) + a2_n * tanh(acceleration / acceleration1_m_s2)";
        let told = |first: f64, second: f64| drives_ahead(&law(text, &[("a1_n", first), ("a2_n", second)]));
        assert!(!told(-500.0, 700.0) && told(500.0, -700.0));
    }

    #[test]
    fn a_scale_that_may_be_anything_bends_nothing() {
        let with_sd = |text: &str, sd: f64| {
            let mut law = law(text, &[("a1_n", 900.0), ("way1_m", 300.0)]);
            law.constants[1].sd = Some(sd);
            law
        };
        for text in [
            "a1_n * (1 - exp(-way / way1_m))",
            "a1_n * tanh(way / way1_m)",
            "a1_n * (1 / (1 + way / way1_m))",
        ] {
            assert!(is_loose(&with_sd(text, 200.0)) && !is_loose(&with_sd(text, 100.0)), "{text}");
        }
        assert!(!is_loose(&with_sd("a1_n * (way / way1_m)", 200.0)));
    }

    /// A hinge of the slope that fades over 320 s by as much as it likes, and one that sets in somewhere between −200 and 240 s.
    #[test]
    fn a_bump_of_any_width_and_a_step_anywhere_bend_nothing() {
        let with = |text: &str, sds: [f64; 2]| {
            let mut law = law(text, &[("a1_n", 900.0), ("t1_s", 20.0), ("t2_s", 4.0)]);
            (law.constants[1].sd, law.constants[2].sd) = (Some(sds[0]), Some(sds[1]));
            law
        };
        let bump = "a1_n * exp(-((t - t1_s) / t2_s)^2) * max((slope1 - slope) / slope2, 0)";
        assert!(is_loose(&with(bump, [1.0, 3.0])) && !is_loose(&with(bump, [1.0, 1.0])));
        let step = "a1_n * 0.5 * (1 + tanh((t - t1_s) / t2_s)) * max((slope1 - slope) / slope2, 0)";
        assert!(is_loose(&with(step, [110.0, 1.1])) && !is_loose(&with(step, [1.0, 1.1])));
        // One that is as sharp as it may be is still known to be there.
        assert!(!is_loose(&with(step, [1.0, 9.0])));
    }

    #[test]
    fn a_patch_is_a_map_and_what_goes_on_all_the_way_is_none() {
        let told = |text: &str, target: Target| is_map(&law(text, &[]), target, (true, false));
        assert!(told("a1_n * exp(-((x - x1_m) / x2_m)^2)", Target::Force));
        let fades = law("a1_n * (1 - exp(-x / x1_m))", &[]);
        assert!(
            is_map(&fades, Target::Force, (true, false)) && !is_map(&fades, Target::Force, (false, false))
        );
        let beside = law("a1_n * (abs(v) / v1_m_s) + a2_n * exp(-abs(x) / x1_m)", &[]);
        assert!(
            is_map(&beside, Target::Force, (true, false)) && !is_map(&beside, Target::Force, (false, false))
        );
        // From one place the way says the place, but for what fades.
        for (text, map) in [
            ("a1_n * 0.5 * (1 + tanh((way - way1_m) / way2_m))", true),
            ("a1_n * (v / v1_m_s) + a2_n * sin(6.28 * way / way1_m + phase2_rad)", true),
            ("a1_n * (v / v1_m_s) + a2_n * (1 - exp(-way / way1_m))", false),
        ] {
            let law = law(text, &[]);
            assert_eq!(is_map(&law, Target::Force, (true, true)), map, "{text}");
            assert!(!is_map(&law, Target::Force, (true, false)), "{text}");
        }
        assert!(!told("a1_n * sin(6.28 * x / x1_m + phase1_rad)", Target::Force));
        let within = "a1_n * exp(-((x - x1_m) / x2_m)^2) * sin(6.28 * x / x3_m + phase1_rad)";
        assert!(told(within, Target::Force));
        let pulse =
            |of: &str| format!("a1_n * 0.5 * (1 + tanh(20 * (sin(6.28 * ({of} - {of}1) / {of}2) - level1)))");
        assert!(told(&pulse("x"), Target::Force) && !told(&pulse("t"), Target::Force));
        assert!(told("a1_n * (v / v1_m_s) + a2_n * exp(-((x - x1_m) / x2_m)^2)", Target::Force));
        assert!(!told("a1_n * exp(-((t - t1_s) / t2_s)^2)", Target::Force));
        assert!(told("a1_w * exp(-((t - t1_s) / t2_s)^2)", Target::Power));
        assert!(!told("a1_w * (v / v1_m_s)^3", Target::Power));
        // A patch that is switched on when the first run is there.
        let switched = "a1_n * exp(-((x - x1_m) / x2_m)^2) * 0.5 * (1 + tanh((t - t1_s) / t2_s))";
        assert!(told(switched, Target::Force));
    }
}
