//! A recorded run as rows: one for each pair of neighbouring blocks of samples.
//!
//! The weak form of a balance. Averaged with the hat function over two blocks of length T,
//! m dv/dt = F becomes m (v̄₂ − v̄₁)/T = ⟨F⟩: every sample counts and none is differentiated. White noise of the speed
//! comes out with a known covariance, 2 on the diagonal and −1 beside it.
//!
//! Source: the test-function form of system identification, Messenger and Bortz, *Multiscale Model. Simul.* 19 (2021),
//! with the hat as test function.

use nalgebra::DVector;
use std::borrow::Cow;
use std::ops::Range;

/// Which samples make a row.
#[derive(Clone, Debug)]
pub struct Row {
    /// First sample of the first block, first of the second, and the one behind it.
    pub samples: [usize; 3],
    /// Weight of each sample, 1 in all.
    pub weights: Vec<f64>,
    /// Middle of the row [s].
    pub time_s: f64,
}

/// Rows that follow each other without a gap.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// Number of its balance.
    pub balance: usize,
    /// Index of the run.
    pub run: usize,
    /// Its rows.
    pub rows: Vec<Row>,
    /// Noise of each row over the usual one (loudness.rs); empty where all are alike.
    pub loudness: Vec<f64>,
}

impl Chunk {
    /// Rows by their own noise, so that all are alike.
    pub fn alike<'a>(&self, values: &'a DVector<f64>) -> Cow<'a, DVector<f64>> {
        if self.loudness.is_empty() {
            return Cow::Borrowed(values);
        }
        let all = values.iter().zip(&self.loudness).map(|(value, loud)| value / loud);
        Cow::Owned(DVector::from_iterator(values.len(), all))
    }
}

/// Number of a block, its first sample and the one behind its last.
type Block = (f64, usize, usize);

/// Longer chunks cost more than they tell: what a function is made of is dense within a chunk.
const LONGEST_CHUNK: usize = 150;
/// A shorter chunk tells less about the noise than its ends disturb.
const SHORTEST_CHUNK: usize = 2;

/// Cuts a run into chunks of rows of blocks `block_s` long. Samples that are not `usable` break a chunk, and the blocks begin
/// anew behind them: in a town what is left between two brakes is short.
pub fn chunks(balance: usize, run: usize, time_s: &[f64], usable: &[bool], block_s: f64) -> Vec<Chunk> {
    let mut chunks = Vec::new();
    let mut open: Vec<Row> = Vec::new();
    let mut close = |open: &mut Vec<Row>| {
        let rows = std::mem::take(open);
        let pieces = rows.len().div_ceil(LONGEST_CHUNK).max(1);
        for piece in rows.chunks(rows.len().div_ceil(pieces).max(1)) {
            if piece.len() >= SHORTEST_CHUNK {
                chunks.push(Chunk { balance, run, rows: piece.to_vec(), loudness: Vec::new() });
            }
        }
    };
    for (number, stretch) in stretches(usable).into_iter().enumerate() {
        // Blocks are counted from the begin of the recording, and anew behind what may not be used.
        let start_s = time_s[if number == 0 { 0 } else { stretch.start }];
        let blocks = blocks(time_s, stretch, start_s, block_s);
        for pair in blocks.windows(2) {
            let ((one, from, middle), (two, _, to)) = (pair[0], pair[1]);
            if two - one > 1.5 {
                close(&mut open);
                continue;
            }
            open.push(row(time_s, [from, middle, to], block_s));
        }
        close(&mut open);
    }
    chunks
}

/// Samples that follow each other and are usable.
fn stretches(usable: &[bool]) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for sample in (0..usable.len()).filter(|sample| usable[*sample]) {
        match all.last_mut() {
            Some(last) if last.end == sample => last.end = sample + 1,
            _ => all.push(sample..sample + 1),
        }
    }
    all
}

/// A stretch cut into blocks of one length, which are counted from a time; what is left at its ends is none.
fn blocks(time_s: &[f64], stretch: Range<usize>, start_s: f64, block_s: f64) -> Vec<Block> {
    let block_of = |sample: usize| ((time_s[sample] - start_s) / block_s + 1e-9).floor();
    let mut blocks: Vec<Block> = Vec::new();
    for sample in stretch.clone() {
        let block = block_of(sample);
        match blocks.last_mut() {
            Some((number, _, end)) if *number == block => *end = sample + 1,
            _ => blocks.push((block, sample, sample + 1)),
        }
    }
    let cut = |last: &Block| stretch.end < time_s.len() && block_of(stretch.end) == last.0;
    if blocks.last().is_some_and(cut) {
        blocks.pop();
    }
    if stretch.start > 0 && blocks.first().is_some_and(|first| block_of(stretch.start - 1) == first.0) {
        blocks.remove(0);
    }
    without_pieces(&blocks)
}

/// The row of two blocks.
fn row(time_s: &[f64], samples: [usize; 3], block_s: f64) -> Row {
    let [from, middle, to] = samples;
    // The slope is that between the blocks' means, so the hat stands half way between them.
    let mean_s = |samples: &[f64]| samples.iter().sum::<f64>() / samples.len() as f64;
    let edge_s = 0.5 * (mean_s(&time_s[from..middle]) + mean_s(&time_s[middle..to]));
    let hat = |sample: usize| (1.0 - (time_s[sample] - edge_s).abs() / block_s).max(1e-3);
    let sum: f64 = (from..to).map(hat).sum();
    Row { samples, weights: (from..to).map(|sample| hat(sample) / sum).collect(), time_s: edge_s }
}

/// Blocks without those beside a gap or at an end that hold few samples: their means are noisier than the others', and no
/// row knows it.
fn without_pieces(blocks: &[Block]) -> Vec<Block> {
    /// Fewer samples than this share of what a block usually holds are a piece.
    const WHOLE: f64 = 0.6;
    let mut counts: Vec<usize> = blocks.iter().map(|(_, from, to)| to - from).collect();
    counts.sort_unstable();
    let usual = counts.get(counts.len() / 2).copied().unwrap_or(0) as f64;
    let apart = |one: usize, two: usize| blocks[two].0 - blocks[one].0 > 1.5;
    let last = blocks.len().saturating_sub(1);
    let at_end =
        |place: usize| place == last || apart(place, place + 1) || place > 0 && apart(place - 1, place);
    let whole =
        |place: &usize| !at_end(*place) || (blocks[*place].2 - blocks[*place].1) as f64 >= WHOLE * usual;
    (0..blocks.len()).filter(whole).map(|place| blocks[place]).collect()
}

impl Row {
    /// Hat-weighted mean of samples.
    pub fn mean(&self, samples: &[f64]) -> f64 {
        let range = self.samples[0]..self.samples[2];
        samples[range].iter().zip(&self.weights).map(|(value, weight)| value * weight).sum()
    }

    /// Variance of the hat-weighted mean of a series of which the impulse is open by so much for each second, sample by sample.
    pub fn mean_variance(&self, time_s: &[f64], open: &[f64]) -> f64 {
        let [from, _, to] = self.samples;
        let Some(open) = open.get(from..to) else { return 0.0 };
        let step_s = (time_s[to - 1] - time_s[from]) / (to - 1 - from) as f64;
        open.iter().zip(&self.weights).map(|(open, weight)| open * weight * weight / step_s).sum()
    }

    /// Hat-weighted mean of every so many samples of the run, from its first on: of those that are given.
    pub fn mean_of_every(&self, every: usize, samples: &[f64]) -> f64 {
        let [from, _, to] = self.samples;
        let places = (from.div_ceil(every)..to.div_ceil(every)).zip(&samples[from.div_ceil(every)..]);
        let (mut sum, mut weight) = (0.0, 0.0);
        for (place, sample) in places {
            let own = self.weights[place * every - from];
            (sum, weight) = (sum + own * sample, weight + own);
        }
        sum / weight
    }

    /// Slope of samples: the difference of the blocks' means over that of their times.
    pub fn slope(&self, time_s: &[f64], samples: &[f64]) -> f64 {
        let [from, middle, to] = self.samples;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        (mean(&samples[middle..to]) - mean(&samples[from..middle]))
            / (mean(&time_s[middle..to]) - mean(&time_s[from..middle]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weak_form_of_a_line_and_of_a_parabola_is_exact() {
        let time_s: Vec<f64> = (0..100).map(|index| 0.1 * f64::from(index)).collect();
        let chunks = chunks(0, 0, &time_s, &[true; 100], 0.5);
        let speed: Vec<f64> = time_s.iter().map(|time| 3.0 - 0.4 * time * time).collect();
        let force: Vec<f64> = time_s.iter().map(|time| -0.8 * time).collect();
        for row in &chunks[0].rows {
            let middle = row.slope(&time_s, &speed);
            assert!((middle - row.mean(&force)).abs() < 1e-9, "{middle} against {}", row.mean(&force));
        }
    }

    /// Of many samples a few are enough: what bends within a row comes out within a thousandth.
    #[test]
    fn every_third_sample_has_nearly_the_mean_of_all() {
        let time_s: Vec<f64> = (0..400).map(|index| 0.02 * f64::from(index)).collect();
        let chunks = chunks(0, 0, &time_s, &[true; 400], 0.4);
        let law = |time: &f64| (1.3 * time).sin() + 0.2 * time * time;
        let all: Vec<f64> = time_s.iter().map(law).collect();
        let some: Vec<f64> = time_s.iter().step_by(3).map(law).collect();
        for row in &chunks[0].rows {
            let (whole, part) = (row.mean(&all), row.mean_of_every(3, &some));
            assert!((whole - part).abs() < 0.01 * whole.abs().max(1.0), "{whole} against {part}");
            assert!((row.mean_of_every(1, &all) - whole).abs() < 1e-12);
        }
    }

    /// Twenty samples between two brakes are four blocks of five, wherever they begin.
    #[test]
    fn a_short_stretch_is_cut_from_its_begin() {
        let time_s: Vec<f64> = (0..100).map(|index| 0.1 * f64::from(index)).collect();
        let usable: Vec<bool> = (0..100).map(|index| index < 3 || (7..29).contains(&index)).collect();
        let chunks = chunks(0, 0, &time_s, &usable, 0.5);
        let samples: Vec<[usize; 3]> = chunks[0].rows.iter().map(|row| row.samples).collect();
        assert_eq!((chunks.len(), samples), (1, vec![[7, 12, 17], [12, 17, 22], [17, 22, 27]]));
        assert!(super::chunks(0, 0, &time_s, &[false; 100], 0.5).is_empty());
    }

    #[test]
    fn a_piece_of_a_block_at_the_end_makes_no_row() {
        let time_s: Vec<f64> = (0..101).map(|index| 0.1 * f64::from(index)).collect();
        let with = |samples: usize| chunks(0, 0, &time_s[..samples], &vec![true; samples], 0.5);
        let last = |samples: usize| with(samples)[0].rows.last().unwrap().samples[2];
        assert_eq!([last(100), last(101)], [100, 100]);
        assert_eq!([last(99), last(97)], [99, 95]);
    }

    #[test]
    fn a_gap_and_an_unusable_sample_break_a_chunk() {
        let time_s: Vec<f64> =
            (0..100).map(|index| 0.1 * f64::from(index) + if index >= 50 { 3.0 } else { 0.0 }).collect();
        let mut usable = vec![true; 100];
        usable[75] = false;
        let chunks = chunks(0, 0, &time_s, &usable, 0.2);
        assert_eq!(chunks.len(), 3);
        assert!(
            chunks
                .iter()
                .flat_map(|chunk| &chunk.rows)
                .all(|row| !(row.samples[0]..row.samples[2]).contains(&75))
        );
    }
}
