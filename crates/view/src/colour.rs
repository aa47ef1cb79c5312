//! Colours that stay apart for colour-blind readers.
//!
//! Source: Okabe and Ito, *Color Universal Design* (2008). Their black, unseen on a dark ground, is left out.

/// Red, green, blue.
pub(crate) type Colour = [u8; 3];

pub(crate) const ORANGE: Colour = [230, 159, 0];
pub(crate) const SKY_BLUE: Colour = [86, 180, 233];
pub(crate) const GREEN: Colour = [0, 158, 115];
pub(crate) const YELLOW: Colour = [240, 228, 66];
pub(crate) const BLUE: Colour = [0, 114, 178];
pub(crate) const VERMILLION: Colour = [213, 94, 0];
pub(crate) const PURPLE: Colour = [204, 121, 167];

/// For lines that have no fixed meaning.
pub(crate) const SERIES: [Colour; 6] = [VERMILLION, SKY_BLUE, GREEN, YELLOW, PURPLE, BLUE];

/// A model's line, and everything that it moves.
pub(crate) const MODELLED: Colour = ORANGE;
/// A recording's line.
pub(crate) const MEASURED: Colour = SKY_BLUE;
/// The difference of the two.
pub(crate) const RESIDUAL: Colour = GREEN;

/// The line of one of several runs, of which each has its own.
pub(crate) fn of_run(index: usize, count: usize) -> Colour {
    let again = index / SERIES.len() % 2 == 1;
    match SERIES[index % SERIES.len()] {
        _ if count <= 1 => MODELLED,
        // A seventh run is a paler first one.
        colour if again => pale(colour),
        colour => colour,
    }
}

/// The line of the recording that belongs to it.
pub(crate) fn of_recording(index: usize, count: usize) -> Colour {
    if count > 1 { pale(of_run(index, count)) } else { MEASURED }
}

/// Halfway to white.
pub(crate) fn pale(colour: Colour) -> Colour {
    colour.map(|part| 128 + part / 2)
}
