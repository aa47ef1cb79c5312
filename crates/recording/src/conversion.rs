//! From the unit of a column to that of its channel.

use crate::column_unit::unit_in_words;
use crate::describe::ChannelDescription;
use crate::plan::Columns;
use crate::{Notice, NoticeKind, Place, RecordingError};
use headland_trace::names;
use headland_units::{Dimension, Unit, UnitError, parse_unit, unit_of_name};

/// Factor and offset from a described column's unit to its channel's.
pub(crate) fn unit_of(
    channel: &ChannelDescription,
    at: &Place,
    columns: &Columns<'_>,
    column: usize,
    run: &str,
    notices: &mut Vec<Notice>,
) -> Result<(f64, f64), RecordingError> {
    let to = unit_of_name(&channel.is);
    let header = columns.unit(column);
    let from = match (&channel.unit, header) {
        (Some(text), header) => {
            let unit = unit_in_words(text).map_err(|text| no_unit(at, &text, parse_unit(&text).err()))?;
            if let Some(Ok(said)) = header
                && (said.dimension != unit.dimension
                    || (said.factor - unit.factor).abs() > 1e-9 * unit.factor)
            {
                let text = format!(
                    "column `{}` says {}, the description says {}; the description is followed",
                    columns.names[column], said.symbol, unit.symbol
                );
                notices.push(Notice::new(run, NoticeKind::Assumed, text).channel(&channel.is));
            }
            unit
        }
        (None, Some(Ok(unit))) => unit,
        (None, Some(Err(text))) if to.is_some() => return Err(no_unit(at, &text, parse_unit(&text).err())),
        (None, _) => {
            if let Some(to) = to {
                let text = format!(
                    "column `{}` shows no unit; it is taken to be in {}, the unit of `{}`",
                    columns.names[column], to.symbol, channel.is
                );
                notices.push(Notice::new(run, NoticeKind::Assumed, text).channel(&channel.is));
            }
            return Ok((1.0, 0.0));
        }
    };
    let expected = to.unwrap_or(Unit {
        symbol: "a pure number".to_owned(),
        dimension: Dimension::NONE,
        factor: 1.0,
        offset: 0.0,
    });
    let mut turned = from.clone();
    for (amount, unit) in [(channel.radius_m, "m/rad"), (channel.density_kg_m3, "kg/m^3")] {
        if let (Some(amount), Ok(unit)) = (amount, parse_unit(unit)) {
            turned.dimension = turned.dimension + unit.dimension;
            turned.factor *= amount;
        }
    }
    if turned.dimension != expected.dimension {
        return Err(RecordingError::UnitMisfit {
            at: at.clone(),
            expected: format!("{}{}", expected.symbol, hint(&turned, &expected, &channel.is)),
            unit: from.symbol,
            channel: channel.is.clone(),
        });
    }
    Ok(line(&turned, &expected))
}

/// What else a unit that does not fit could mean.
fn hint(from: &Unit, to: &Unit, channel: &str) -> String {
    let is = |unit: &str, of: &Unit| parse_unit(unit).is_ok_and(|unit| unit.dimension == of.dimension);
    if is("rad/s", from) && is("m/s", to) {
        "; give `radius_m` to turn a wheel's speed of rotation into a speed".to_owned()
    } else if is("L/s", from) && is("kg/s", to) {
        "; give `density_kg_m3` to turn a volume flow into a mass flow".to_owned()
    } else if is("Hz", from) && is("rad/s", to) {
        "; for turns per second write \"rev/s\"".to_owned()
    } else if unit_of_name(channel).is_none() && !names::is_known(channel) {
        "; let the channel's name end in its unit, as `boost_pa` does".to_owned()
    } else {
        String::new()
    }
}

fn no_unit(at: &Place, text: &str, error: Option<UnitError>) -> RecordingError {
    let reason = error.map_or_else(|| "it is not known".to_owned(), |error| error.to_string());
    RecordingError::Unit { at: at.clone(), text: text.to_owned(), reason }
}

/// Slope and offset between two units of one dimension.
pub(crate) fn line(from: &Unit, to: &Unit) -> (f64, f64) {
    let zero = to.from_si(from.to_si(0.0));
    (from.factor / to.factor, zero)
}
