//! What one cell of a log holds.

/// A cell, read as a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cell {
    /// Nothing, or a word that says so.
    Missing,
    /// A finite number.
    Number(f64),
    /// Anything else.
    Text,
}

/// Words that loggers and spreadsheets write where they have no value.
const MISSING: &[&str] =
    &["nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "inf", "-inf", "+inf", "infinity", "-infinity"];

/// Reads a cell; with `comma` as decimal mark where a log has that.
pub(crate) fn number(cell: &str, comma: bool) -> Cell {
    let cell = cell.trim();
    if cell.is_empty() {
        return Cell::Missing;
    }
    let parsed = if comma && cell.contains(',') && !cell.contains('.') {
        cell.replacen(',', ".", 1).parse::<f64>()
    } else {
        cell.parse::<f64>()
    };
    match parsed {
        Ok(value) if value.is_finite() => Cell::Number(value),
        // Numbers beyond the range of a double parse as infinite: no measurement.
        Ok(_) => Cell::Missing,
        Err(_) if MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word)) => Cell::Missing,
        Err(_) => Cell::Text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_with_either_mark() {
        assert_eq!(number(" 1.5 ", false), Cell::Number(1.5));
        assert_eq!(number("-0,25", true), Cell::Number(-0.25));
        assert_eq!(number("1e-3", true), Cell::Number(1e-3));
        assert_eq!(number("1,5", false), Cell::Text);
        assert_eq!(number("1.234,5", true), Cell::Text);
    }

    #[test]
    fn words_for_no_value_are_missing_and_other_words_are_text() {
        for word in ["", "  ", "NaN", "n/a", "NULL", "-", "inf", "1e999"] {
            assert_eq!(number(word, false), Cell::Missing, "{word}");
        }
        for word in ["fast", "12 km/h", "0x10", "1.2.3"] {
            assert_eq!(number(word, false), Cell::Text, "{word}");
        }
    }
}
