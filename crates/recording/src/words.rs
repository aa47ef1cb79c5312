//! What a misspelt word was meant to be.

use crate::column_unit::unit_in_words;
use headland_trace::names;
use headland_units::{stem, unit_of_name};

/// The known channel that a name is one slip away from, or whose quantity it names with another ending.
pub(crate) fn misspelt(name: &str) -> Option<String> {
    if names::is_known(name) {
        return None;
    }
    let near = names::KNOWN.iter().find(|known| strsim::damerau_levenshtein(known.name, name) == 1);
    let same = || {
        let unitless = unit_of_name(name).is_none();
        names::KNOWN.iter().find(|known| {
            let own = stem(known.name);
            own != known.name
                && unitless
                && (name == own || name.strip_prefix(own).is_some_and(is_unit_ending))
        })
    };
    near.or_else(same).map(|known| known.name.to_owned())
}

/// Whether what follows a known quantity's name is a unit that names do not end in: `_kmh`.
fn is_unit_ending(rest: &str) -> bool {
    rest.strip_prefix('_').is_some_and(|unit| unit_in_words(unit).is_ok())
}

/// RON's reasons in our words, with the field that was meant.
pub(crate) fn reason(code: &ron::Error) -> String {
    let nearest = |found: &str, known: &[&str]| {
        let near = known.iter().min_by_key(|known| strsim::damerau_levenshtein(known, found)).copied();
        match near.filter(|near| strsim::damerau_levenshtein(near, found) <= 2.max(found.len() / 3)) {
            Some(near) => format!("; did you mean `{near}`?"),
            None => format!("; known: {}", known.join(", ")),
        }
    };
    match code {
        ron::Error::NoSuchStructField { expected, found, outer } => {
            let of = outer.as_deref().unwrap_or("this");
            format!("`{of}` has no field `{found}`{}", nearest(found, expected))
        }
        ron::Error::NoSuchEnumVariant { expected, found, .. } => {
            format!("`{found}` is none of the choices here{}", nearest(found, expected))
        }
        ron::Error::MissingStructField { field, outer } => {
            format!("`{}` lacks the field `{field}`", outer.as_deref().unwrap_or("this"))
        }
        ron::Error::DuplicateStructField { field, .. } => format!("the field `{field}` stands twice"),
        other => format!("not the RON of a recording: {other}"),
    }
}
