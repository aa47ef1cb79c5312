//! Where a balance does not close, in a sentence.

use super::number::{number, plus_minus};
use super::{capital, listed};
use crate::balances::balance::Kind;
use crate::told::map::{Map, Mismatch, Over};

/// So many stretches are told; the others are counted.
const TOLD: usize = 3;

/// 'The motion balance fails first: ...', or nothing where every balance closes.
pub fn first(map: &Map) -> Option<String> {
    let (kind, best) = (map.first?, map.best?);
    // Runs that were held out have no part in it.
    let fitted = map.stretches.iter().zip(&map.fitted).filter(|(_, fitted)| **fitted).map(|(one, _)| one);
    let mut own: Vec<&Mismatch> = fitted.filter(|one| one.balance == kind && one.over == best).collect();
    // The strongest are told, in their order along the axis.
    own.sort_by(|one, other| other.sigma.abs().total_cmp(&one.sigma.abs()));
    let more = own.len().saturating_sub(TOLD);
    own.truncate(TOLD);
    own.sort_by(|one, other| one.run.cmp(&other.run).then(one.from.total_cmp(&other.from)));
    let told: Vec<String> = own
        .iter()
        .enumerate()
        .map(|(index, one)| format!("{} {}", amount(one, index == 0), place(one)))
        .collect();
    let rest = match more {
        0 => String::new(),
        1 => "; and in one more stretch".to_owned(),
        more => format!("; and in {more} more stretches"),
    };
    let ways = match both_ways(map, kind, best) {
        Some(both) if best == Over::Position => both,
        _ => "",
    };
    Some(format!(
        "{} is the first that does not close: {}{rest}{ways}.",
        capital(&format!("the {} balance", kind.name())),
        listed(&told)
    ))
}

/// What is measured beyond what is modelled; in full for the first of a list.
fn amount(one: &Mismatch, full: bool) -> String {
    let more = one.mean > 0.0;
    let size = plus_minus(one.mean.abs(), one.sd, one.unit_of_mean);
    let way = if more { "more" } else { "less" };
    let beyond = |noun: &str| {
        if full { format!("{size} {way} {noun} than modelled") } else { format!("{size} {way}") }
    };
    match one.balance {
        Kind::Motion => beyond("resistance"),
        Kind::Shaft => beyond("power of the engine"),
        Kind::Battery | Kind::Charge => beyond("power"),
        Kind::Voltage => beyond("voltage"),
        Kind::Fuel => beyond("power in the fuel"),
        Kind::Slip => beyond("speed of the wheels"),
        Kind::Parity if full => format!("the accelerometer reads {size} {way} than the speed says"),
        Kind::Parity => format!("{size} {way}"),
    }
}

fn place(one: &Mismatch) -> String {
    let between = |unit: &str| format!("between {} and {}{unit}", number(one.from), number(one.to));
    match (one.over, one.everywhere) {
        (Over::Time, true) => format!("throughout {}", one.run.as_deref().unwrap_or("")),
        (Over::Time, false) => format!("in {} {}", one.run.as_deref().unwrap_or(""), between(" s")),
        (Over::Position, true) => match (&one.path, &one.run) {
            (None, Some(run)) => format!("along the whole way of {run}"),
            _ => "along the whole path".to_owned(),
        },
        (Over::Position, false) => match (&one.path, &one.run) {
            (Some(path), _) => format!("{} of the path {path}", between(" m")),
            (None, Some(run)) => format!("{} of {run}", between(" m")),
            (None, None) => between(" m"),
        },
        (Over::Speed, true) => "at every speed".to_owned(),
        (Over::Speed, false) => format!("at speeds {}", between(" m/s")),
        (Over::Direction, true) => "in both directions".to_owned(),
        (Over::Direction, false) if one.from < 0.5 => "along the path".to_owned(),
        (Over::Direction, false) => "against the path's direction".to_owned(),
        (Over::Temperature, true) => "at every temperature".to_owned(),
        (Over::Temperature, false) => format!("at temperatures {}", between(" °C")),
    }
}

/// Whether direction matters, as far as the map over direction tells.
fn both_ways(map: &Map, kind: Kind, best: Over) -> Option<&'static str> {
    let ways: Vec<&Mismatch> = map
        .stretches
        .iter()
        .filter(|one| one.balance == kind && one.over == Over::Direction && best != Over::Direction)
        .collect();
    match ways[..] {
        [one] if one.everywhere => Some(", in both directions alike"),
        [one, other] if one.mean * other.mean < 0.0 => Some(", the other way round in the other direction"),
        [one] if one.from < 0.5 => Some(", mostly along the path"),
        [_] => Some(", mostly against the path's direction"),
        _ => None,
    }
}
