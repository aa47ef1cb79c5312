//! What ends a phase, as a quantity that falls to zero.

use crate::plan::Until;
use crate::step::{Machine, Moment};

/// How a phase knows that it is over.
#[derive(Clone, Debug)]
pub(crate) struct Ending {
    /// Instant at which it ends at the latest [s]; infinite where time does not end it.
    pub end_s: f64,
    measures: Vec<Measure>,
    words: Vec<String>,
}

/// One quantity that is more than zero as long as the phase lasts.
#[derive(Clone, Copy, Debug)]
enum Measure {
    Time(f64),
    Speed { than: f64, way: f64 },
    Place { end_m: f64, way: f64 },
    Rest { way: f64 },
    State { index: usize, than: f64, way: f64 },
}

impl Measure {
    #[allow(clippy::inline_always, reason = "it is asked within each step")]
    #[inline(always)]
    fn left(&self, at: &Moment) -> f64 {
        match *self {
            // The step is cut to meet times.
            Self::Time(_) => f64::INFINITY,
            Self::Speed { than, way } => way * (at.speed_m_s - than),
            Self::Place { end_m, way } => way * (end_m - at.position_m),
            Self::Rest { way } => way * at.speed_m_s,
            Self::State { index, than, way } => way * (at.states[index] - than),
        }
    }
}

/// A position that was to be reached and was passed by less than this is the rounding of a located end [m].
const PASSED_M: f64 = 1e-6;

/// The same for times [s].
const PASSED_S: f64 = 1e-9;

impl Ending {
    /// What `until` means for the machine where it stands now.
    ///
    /// # Errors
    /// Why it can never come, in a sentence.
    pub fn of(until: &Until, machine: &Machine) -> Result<Self, String> {
        Self::toward(until, machine, machine.speed_m_s() < 0.0)
    }

    /// The same for a machine that is to go forward or backward.
    ///
    /// # Errors
    /// As [`Ending::of`].
    pub fn toward(until: &Until, machine: &Machine, backward: bool) -> Result<Self, String> {
        let mut ending = Self::never();
        ending.add(until, machine, (true, backward))?;
        Ok(ending)
    }

    /// What is to be true at once: nothing in it can lie behind.
    ///
    /// # Errors
    /// As [`Ending::of`].
    pub fn conditions(when: &[Until], machine: &Machine) -> Result<Self, String> {
        let mut ending = Self::never();
        for condition in when {
            ending.add(condition, machine, (false, machine.speed_m_s() < 0.0))?;
        }
        Ok(ending)
    }

    /// At a speed that is risen or fallen to.
    pub fn at_speed(than: f64, rising: bool) -> Self {
        let measure = Measure::Speed { than, way: if rising { -1.0 } else { 1.0 } };
        Self { measures: vec![measure], words: vec![format!("it drives at {than:.2} m/s")], ..Self::never() }
    }

    /// At an instant.
    pub fn at_time(end_s: f64, words: String) -> Self {
        Self { end_s, measures: vec![Measure::Time(end_s)], words: vec![words] }
    }

    fn never() -> Self {
        Self { end_s: f64::INFINITY, measures: Vec::new(), words: Vec::new() }
    }

    /// Nothing lies behind in a `strict` phase; one that goes `backward` has its places behind and its speeds below 0.
    fn add(
        &mut self,
        until: &Until,
        machine: &Machine,
        (strict, backward): (bool, bool),
    ) -> Result<(), String> {
        let way = if backward { -1.0 } else { 1.0 };
        let ahead = |end_m: f64, here_m: f64| if strict { ahead(end_m, here_m, way) } else { Ok(end_m) };
        let (now_s, here_m) = (machine.time_s, machine.position_m());
        let (measure, words) = match until {
            Until::Any(ends) => {
                let gone =
                    |end: &&Until| !matches!(end, Until::Mark(name) if next_mark_m(machine, name).is_none());
                let mut come = ends.iter().filter(gone).peekable();
                if come.peek().is_none() {
                    return ends.first().map_or(Ok(()), |end| self.add(end, machine, (strict, backward)));
                }
                return come.try_for_each(|end| self.add(end, machine, (strict, backward)));
            }
            Until::Stopped => (Measure::Rest { way }, "the vehicle rests".to_owned()),
            Until::SpeedBelow(than) => {
                (Measure::Speed { than: way * than, way }, format!("its speed has fallen to {than:.2} m/s"))
            }
            Until::SpeedAbove(than) => (
                Measure::Speed { than: way * than, way: -way },
                format!("its speed has risen to {than:.2} m/s"),
            ),
            Until::Elapsed(for_s) => (Measure::Time(now_s + for_s), format!("after {for_s} s")),
            Until::Time(end_s) => {
                if strict && now_s - end_s > PASSED_S {
                    return Err(format!(
                        "the phase is to end at {end_s} s, which is {:.3} s ago",
                        now_s - end_s
                    ));
                }
                (Measure::Time(*end_s), format!("at {end_s} s"))
            }
            Until::Travelled(far_m) => {
                (Measure::Place { end_m: here_m + way * far_m, way }, format!("after {far_m} m"))
            }
            Until::Position(end_m) => {
                (Measure::Place { end_m: ahead(*end_m, here_m)?, way }, format!("at {end_m} m"))
            }
            Until::Mark(name) if backward => {
                return Err(format!(
                    "marks are looked for ahead, and the vehicle is to drive backward to `{name}`"
                ));
            }
            Until::Mark(name) => {
                let Some(end_m) = next_mark_m(machine, name) else {
                    return Err(format!("no mark `{name}` stands on the path beyond {here_m:.1} m"));
                };
                (Measure::Place { end_m, way }, format!("at the mark `{name}`"))
            }
            Until::PathEnd => {
                let Some((begin_m, end_m)) = machine.model.terrain.extent_m() else {
                    return Err(
                        "the phase is to last until the path ends, and this path never does".to_owned()
                    );
                };
                let (end_m, words) = if backward { (begin_m, "begin") } else { (end_m, "end") };
                (Measure::Place { end_m: ahead(end_m, here_m)?, way }, format!("at the {words} of the path"))
            }
            Until::StateAbove { state, value } => {
                (state_measure(machine, state, *value, -1.0)?, format!("{state} has risen to {value}"))
            }
            Until::StateBelow { state, value } => {
                (state_measure(machine, state, *value, 1.0)?, format!("{state} has fallen to {value}"))
            }
        };
        if let Measure::Time(end_s) = measure {
            self.end_s = self.end_s.min(end_s);
        }
        self.measures.push(measure);
        self.words.push(words);
        Ok(())
    }

    /// What is left of the phase; it falls to zero as the first of its ends comes. Ends by time are kept in `end_s`.
    #[allow(clippy::inline_always, reason = "it is asked within each step")]
    #[inline(always)]
    pub fn left(&self, at: &Moment) -> f64 {
        self.measures.iter().fold(f64::INFINITY, |least, measure| least.min(measure.left(at)))
    }

    /// Whether every end has come: how conditions of entry are read.
    pub fn all(&self, at: &Moment) -> bool {
        self.measures.iter().all(|measure| match measure {
            Measure::Time(end_s) => at.time_s >= *end_s,
            other => other.left(at) <= 0.0,
        })
    }

    /// Whether time, or something that changes at rest, can end the phase.
    pub fn comes_at_rest(&self) -> bool {
        self.measures.iter().any(|measure| match measure {
            Measure::Time(_) | Measure::State { .. } => true,
            Measure::Speed { .. } | Measure::Rest { .. } | Measure::Place { .. } => false,
        })
    }

    /// Whether a vehicle that rests has to set off before a rest can end the phase; then it is no end yet.
    pub fn without_rest(mut self) -> Self {
        let keep: Vec<bool> = self
            .measures
            .iter()
            .map(|measure| match measure {
                Measure::Rest { .. } => false,
                Measure::Speed { than, way } => *than != 0.0 || *way <= 0.0,
                _ => true,
            })
            .collect();
        let mut kept = keep.iter();
        self.measures.retain(|_| kept.next().copied().unwrap_or(true));
        let mut kept = keep.iter();
        self.words.retain(|_| kept.next().copied().unwrap_or(true));
        self
    }

    /// What has come, in words.
    pub fn told(&self, at: &Moment) -> String {
        let come = self.measures.iter().zip(&self.words).find(|(measure, _)| match measure {
            Measure::Time(end_s) => at.time_s >= *end_s,
            other => other.left(at) <= 0.0,
        });
        come.map_or_else(String::new, |(_, words)| words.clone())
    }
}

/// Where the next mark stands ahead; one that was just reached is none.
fn next_mark_m(machine: &Machine, name: &str) -> Option<f64> {
    machine.model.terrain.next_mark_m(name, machine.position_m() + PASSED_M)
}

/// A position that lies where the vehicle goes, forward or backward; a rounding on the other side counts as here.
fn ahead(end_m: f64, here_m: f64, way: f64) -> Result<f64, String> {
    let passed_m = way * (here_m - end_m);
    if passed_m > PASSED_M {
        return Err(if way > 0.0 {
            format!("the phase is to end at {end_m} m, which lies {passed_m:.1} m behind the vehicle")
        } else {
            format!(
                "the phase is to end at {end_m} m, which lies {passed_m:.1} m ahead of a vehicle that drives backward"
            )
        });
    }
    Ok(end_m)
}

fn state_measure(machine: &Machine, name: &str, than: f64, way: f64) -> Result<Measure, String> {
    let index = machine.layout.states.iter().position(|(own, _)| own == name);
    let index =
        index.ok_or_else(|| format!("the phase waits for `{name}`, which no model of the vehicle has"))?;
    Ok(Measure::State { index, than, way })
}
