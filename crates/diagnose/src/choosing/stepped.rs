//! Courses in steps: where a function that may jump has edges, and stays otherwise.
//!
//! The rows of a run are cut into parts of one level each so that Σ −½ (Σ c r)² / (σ² Σ c²) + β k is least, c what a level of one does to a
//! row, r what the rows show of the function, k the number of edges, β what an edge has to bring. The least is found by dynamic programming.
//! Rows count as if none knew of another here, and the noise of the balance judges what comes of it.
//! Increments of any size everywhere describe what is switched many times at length: most of them are nothing, and each says so by itself.
//! Source: Jackson et al., "An algorithm for optimal partitioning of data on an interval", *IEEE Signal Processing Letters* 12 (2005) 105.

use crate::balances::balance::Kind;
use crate::causes::jumps::{Edges, Jumps, STAYING};
use crate::causes::profile::Spread;
use crate::choosing::state::{Stand, State};
use crate::look::MANY_ROWS;

/// A row of a run: its time, what a level of one does to it, and what it shows, both in units of its noise.
#[derive(Clone, Copy, Debug)]
struct Seen {
    time_s: f64,
    level: f64,
    shown: f64,
}

/// A level shows in so many rows at least: what is switched within a row shows in two.
const SHORTEST: usize = 2;

impl State<'_> {
    /// The balance that shows best what is switched: a battery does better than fuel, in which an engine's power is much of the noise.
    pub fn shows_switching(&self) -> Option<usize> {
        let place = |wanted: Kind| self.system.kinds.iter().position(|kind| *kind == wanted);
        place(Kind::Battery).or_else(|| place(Kind::Shaft)).or_else(|| place(Kind::Fuel))
    }

    /// A set whose last cause is a function that may jump, in steps; none where it is not, or where nothing shows any.
    pub fn stepped(&self, stand: &Stand) -> Option<Stand> {
        /// Edges change what else is found, and that the edges.
        const ROUNDS: usize = 2;
        // In long recordings, where the noise of a minute is not that of an hour, there is always something to step to.
        if self.system.row_count() > MANY_ROWS {
            return None;
        }
        stand.parts.last()?.spread.as_ref()?.jumps.as_ref()?;
        let mut noise = self.quiet(stand).each[self.shows_switching()?].sd();
        let mut best: Option<Stand> = None;
        for _ in 0..ROUNDS {
            let now = best.as_ref().unwrap_or(stand);
            let mut parts = now.parts.clone();
            parts.last_mut()?.spread = Some(self.steps(now, noise)?);
            let stepped = self.settle(&parts, &now.noises)?;
            if best.as_ref().is_some_and(|best| stepped.score <= best.score) {
                break;
            }
            noise = stepped.noises.each[self.shows_switching()?].sd();
            best = Some(stepped);
        }
        best
    }

    /// How the last function of a set is spread once it stays between the edges that rows of a noise show.
    fn steps(&self, stand: &Stand, noise: f64) -> Option<Spread> {
        let balance = self.shows_switching()?;
        let (part, function) = (stand.parts.last()?, stand.functions.last()?.as_ref()?);
        let spread = part.spread.as_ref().filter(|spread| spread.jumps.is_some())?;
        let profile = self.profile(&part.trial, spread.shared);
        let made = profile.rows(self.system, function);
        let step = self.system.blocks_s[balance];
        let mut runs: Vec<Vec<Seen>> = vec![Vec::new(); function.groups.len()];
        for (index, chunk) in self.system.chunks.iter().enumerate().filter(|(_, own)| own.balance == balance)
        {
            let shown = chunk.alike(&(&stand.left[index] + &made[index])).into_owned();
            let level = chunk.alike(&profile.signature[index]).into_owned();
            runs[profile.group_of[chunk.run]].extend(chunk.rows.iter().enumerate().map(|(row, own)| Seen {
                time_s: own.time_s,
                level: level[row] / noise,
                shown: shown[row] / noise,
            }));
        }
        let mut squares = (0.0, 0usize);
        let edges = runs.iter().zip(&function.groups).map(|(rows, group)| {
            let parts = parts(rows);
            for (value, rows) in levels(rows, &parts) {
                squares = (squares.0 + value * value * rows as f64, squares.1 + rows);
            }
            laid(rows, &parts, (group.from, step))
        });
        let edges: Vec<Edges> = edges.collect();
        let size = (squares.0 / squares.1.max(1) as f64).sqrt();
        (size > 0.0).then(|| Spread {
            length: STAYING * step,
            size,
            jumps: Some(Jumps::told(step, edges)),
            ..spread.clone()
        })
    }
}

/// The first row of each part but the first.
fn parts(rows: &[Seen]) -> Vec<usize> {
    let sums = |value: fn(&Seen) -> f64| {
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        sums.extend(rows.iter().map(|row| {
            sum += value(row);
            sum
        }));
        sums
    };
    let (crosses, squares) = (sums(|row| row.level * row.shown), sums(|row| row.level * row.level));
    let cost = |from: usize, to: usize| {
        let square = squares[to] - squares[from];
        if square > 0.0 { -0.5 * (crosses[to] - crosses[from]).powi(2) / square } else { 0.0 }
    };
    let needed = least_gain(rows.len());
    // The least cost of the rows before each, and where its last part begins.
    let mut least = vec![(f64::INFINITY, 0); rows.len() + 1];
    least[0] = (-needed, 0);
    for to in SHORTEST..=rows.len() {
        for from in 0..=to - SHORTEST {
            let whole = least[from].0 + cost(from, to) + needed;
            if whole < least[to].0 {
                least[to] = (whole, from);
            }
        }
    }
    let mut parts = Vec::new();
    let mut begin = least.last().map_or(0, |one| one.1);
    while begin > 0 {
        parts.push(begin);
        begin = least[begin].1;
    }
    parts.reverse();
    parts
}

/// Growth of ln p that an edge has to bring: where it is, and from which level to which.
fn least_gain(rows: usize) -> f64 {
    /// What two levels are known by, over how they are spread: odds of one to twenty.
    const LEVELS: f64 = 3.0;
    (rows.max(1) as f64).ln() + LEVELS
}

/// The level of each part, and how many rows show it.
fn levels(rows: &[Seen], parts: &[usize]) -> Vec<(f64, usize)> {
    let mut all = Vec::new();
    let mut from = 0;
    for to in parts.iter().copied().chain([rows.len()]) {
        let own = &rows[from..to];
        let square: f64 = own.iter().map(|row| row.level * row.level).sum();
        if square > 0.0 {
            all.push((own.iter().map(|row| row.level * row.shown).sum::<f64>() / square, own.len()));
        }
        from = to;
    }
    all
}

/// The edges on knots that lie `step` apart, one at each row; without rows one level from the place where the group begins.
fn laid(rows: &[Seen], parts: &[usize], (begins, step): (f64, f64)) -> Edges {
    let from = rows.first().map_or(begins, |row| row.time_s);
    // Counts of knots in a run.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small and positive")]
    let knot = |time_s: f64| ((time_s - from) / step).round().max(0.0) as usize;
    let increments = rows.last().map_or(1, |row| knot(row.time_s)).max(1);
    let mut free = vec![false; increments];
    let levels = levels(rows, parts);
    for (number, first) in parts.iter().enumerate() {
        let (last, first) = (&rows[first - 1], &rows[*first]);
        let (one, other) = (knot(last.time_s), knot(first.time_s));
        // In a gap nobody saw when it was switched.
        if other > one + 1 {
            free[usize::midpoint(one, other)] = true;
            continue;
        }
        free[one..other].fill(true);
        // What is switched within a row leaves it between two levels.
        let off = |row: &Seen, level: Option<&(f64, usize)>| {
            level.map_or(0.0, |(level, _)| (row.shown - level * row.level).abs())
        };
        let before = off(last, levels.get(number)) > off(first, levels.get(number + 1));
        if before && one > 0 {
            free[one - 1] = true;
        } else if !before && other < increments {
            free[other] = true;
        }
    }
    Edges { from, free, count: parts.len() }
}

#[cfg(test)]
mod tests {
    use super::{Seen, laid, levels, parts};

    /// Rows of a second whose noise is one and has no course.
    fn rows(level: impl Fn(usize) -> f64) -> Vec<Seen> {
        let noise = |row: usize| [0.7, -1.1, 0.4, 0.9, -0.8, 1.2, -1.3][row % 7];
        (0..60)
            .map(|row| Seen { time_s: 1.0 + row as f64, level: 1.0, shown: level(row) + noise(row) })
            .collect()
    }

    #[test]
    fn what_is_switched_is_cut_where_it_is_switched() {
        let switched =
            |row: usize| if (11..24).contains(&row) || (40..45).contains(&row) { 8.0 } else { 0.0 };
        let rows = rows(switched);
        let parts = parts(&rows);
        assert_eq!(parts, [11, 24, 40, 45]);
        let powers: Vec<f64> = levels(&rows, &parts).iter().map(|(level, _)| *level).collect();
        let near = |(power, level): (&f64, f64)| (power - level).abs() < 0.7;
        assert!(powers.iter().zip([0.0, 8.0, 0.0, 8.0, 0.0]).all(near), "{powers:?}");
    }

    #[test]
    fn what_stays_has_no_edge_and_neither_has_what_nobody_saw() {
        assert!(parts(&rows(|_| 5.0)).is_empty());
        assert!(parts(&[]).is_empty());
        let nothing = laid(&[], &[], (3.0, 1.0));
        assert!(nothing.from == 3.0 && nothing.count == 0 && nothing.free == [false]);
    }

    /// Where the rows between two levels are missing it is switched once, half way.
    #[test]
    fn what_is_switched_in_a_gap_is_switched_in_the_middle_of_it() {
        let mut rows = rows(|row| if row < 30 { 0.0 } else { 20.0 });
        rows.drain(25..35);
        let parts = parts(&rows);
        let edges = laid(&rows, &parts, (0.0, 1.0));
        let free: Vec<usize> = (0..edges.free.len()).filter(|place| edges.free[*place]).collect();
        assert_eq!((free, edges.count), (vec![29], 1));
    }

    /// Switched in the middle of a row, which is half a level then: the increments before and behind it are free.
    #[test]
    fn an_edge_within_a_row_lies_on_both_sides_of_it() {
        let half = |row: usize| match row {
            0..20 => 0.0,
            20 => 3.0,
            _ => 6.0,
        };
        let rows = rows(half);
        let parts = parts(&rows);
        let edges = laid(&rows, &parts, (0.0, 1.0));
        let free: Vec<usize> = (0..edges.free.len()).filter(|place| edges.free[*place]).collect();
        assert_eq!((free, edges.count, edges.free.len()), (vec![19, 20], 1, 59));
    }
}
