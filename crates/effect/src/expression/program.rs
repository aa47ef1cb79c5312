//! An expression as a list of steps on a stack; evaluating it allocates nothing.

use headland_plugin::Situation;

/// Values that may wait at once.
const STACK: usize = 64;

/// One step; it takes its operands from the stack and leaves its result there.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// A number.
    Push(f64),
    /// A variable.
    Load(fn(&Situation) -> f64),
    /// A function of one operand.
    One(fn(f64) -> f64),
    /// A function of two.
    Two(fn(f64, f64) -> f64),
    /// A function of three.
    Three(fn(f64, f64, f64) -> f64),
    /// What is remembered in a place; it takes nothing.
    Recall(usize),
    /// A switch that is remembered in a place: of a value, and of those at which it goes on and off.
    Latch(usize),
    /// What follows a value late and is remembered in a place: of that value, and of a time constant [s].
    Lag(usize),
}

/// What is remembered, with what it is set or led by.
enum Asked {
    Nothing,
    /// A value, and where it goes on and off.
    Switch([f64; 3]),
    /// A value, and the time constant [s].
    Lag([f64; 2]),
}

/// More values wait than there is room for.
#[derive(Debug, PartialEq)]
pub(super) struct TooDeep;

/// A compiled expression.
#[derive(Clone, Debug, Default)]
pub(super) struct Program {
    steps: Vec<Step>,
    waiting: usize,
}

impl Program {
    /// Appends a step; what has constant operands is done at once.
    pub(super) fn push(&mut self, step: Step) -> Result<(), TooDeep> {
        let result = match (step, self.steps.as_slice()) {
            (Step::One(f), [.., Step::Push(a)]) => Some((1, f(*a))),
            (Step::Two(f), [.., Step::Push(a), Step::Push(b)]) => Some((2, f(*a, *b))),
            (Step::Three(f), [.., Step::Push(a), Step::Push(b), Step::Push(c)]) => Some((3, f(*a, *b, *c))),
            _ => None,
        };
        self.waiting = self.waiting + 1 - step.operands();
        if let Some((operands, value)) = result {
            self.steps.truncate(self.steps.len() - operands);
            self.steps.push(Step::Push(value));
        } else {
            self.steps.push(step);
        }
        if self.waiting > STACK { Err(TooDeep) } else { Ok(()) }
    }

    /// Its value in a situation, with what is remembered; NaN where it is not defined there.
    pub(super) fn value(&self, at: &Situation, memory: &[f64]) -> f64 {
        self.run(at, |place, asked| match asked {
            Asked::Lag([value, _]) => late(memory[place], value),
            _ => memory[place],
        })
    }

    /// Sets how fast each place changes that follows a value late [1/s of its unit]; the others stay.
    pub(super) fn rates(&self, at: &Situation, memory: &[f64], rates: &mut [f64]) {
        self.run(at, |place, asked| {
            let Asked::Lag([value, lag_s]) = asked else { return memory[place] };
            let own = late(memory[place], value);
            rates[place] = (value - own) / lag_s;
            own
        });
    }

    /// Sets the switches that are remembered as a situation has them, and begins what was not begun; whether any changed.
    pub(super) fn switch(&self, at: &Situation, memory: &mut [f64]) -> bool {
        let mut changed = false;
        self.run(at, |place, asked| {
            let before = memory[place];
            match asked {
                Asked::Nothing => {}
                Asked::Switch([value, on, off]) => memory[place] = switched(before, value, on, off),
                Asked::Lag([value, _]) => memory[place] = late(before, value),
            }
            changed |= memory[place].to_bits() != before.to_bits();
            memory[place]
        });
        changed
    }

    fn run(&self, at: &Situation, mut recall: impl FnMut(usize, Asked) -> f64) -> f64 {
        let mut stack = [0.0; STACK];
        let mut top = 0;
        for step in &self.steps {
            let first = top - step.operands();
            stack[first] = match *step {
                Step::Push(value) => value,
                Step::Load(variable) => variable(at),
                Step::One(f) => f(stack[first]),
                Step::Two(f) => f(stack[first], stack[first + 1]),
                Step::Three(f) => f(stack[first], stack[first + 1], stack[first + 2]),
                Step::Recall(place) => recall(place, Asked::Nothing),
                Step::Latch(place) => {
                    let of = [stack[first], stack[first + 1], stack[first + 2]];
                    let known = !of.iter().any(|value| value.is_nan());
                    if known { recall(place, Asked::Switch(of)) } else { f64::NAN }
                }
                Step::Lag(place) => {
                    let of = [stack[first], stack[first + 1]];
                    // What takes no time, or less, follows nothing.
                    if of[0].is_nan() || of[1].is_nan() || of[1] <= 0.0 {
                        f64::NAN
                    } else {
                        recall(place, Asked::Lag(of))
                    }
                }
            };
            top = first + 1;
        }
        stack[0]
    }

    /// The number that the last step leaves, where it is one.
    pub(super) fn last(&self) -> Option<f64> {
        match self.steps.last() {
            Some(Step::Push(value)) => Some(*value),
            _ => None,
        }
    }
}

impl Step {
    fn operands(self) -> usize {
        match self {
            Self::Push(_) | Self::Load(_) | Self::Recall(_) => 0,
            Self::One(_) => 1,
            Self::Two(_) | Self::Lag(_) => 2,
            Self::Three(_) | Self::Latch(_) => 3,
        }
    }
}

/// What follows a value late; before it has begun it is that value, as if that had always been so.
fn late(before: f64, value: f64) -> f64 {
    if before.is_nan() { value } else { before }
}

/// A switch, 1 or 0: it goes on at `on` and off at `off`, and between them it stays what it is. Where `on` lies below, it goes on as
/// the value falls.
fn switched(before: f64, value: f64, on: f64, off: f64) -> f64 {
    let (is_on, is_off) = if on >= off { (value >= on, value <= off) } else { (value <= on, value >= off) };
    if is_on {
        1.0
    } else if is_off {
        0.0
    } else {
        before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program(steps: &[Step]) -> Program {
        let mut program = Program::default();
        for step in steps {
            program.push(*step).unwrap();
        }
        program
    }

    /// (7 − 2) · v.
    #[test]
    fn constants_are_reckoned_once_and_operands_keep_their_order() {
        let minus = Step::Two(|a, b| a - b);
        let times = Step::Two(|a, b| a * b);
        let load = Step::Load(|at| at.speed_m_s);
        let five_v = program(&[Step::Push(7.0), Step::Push(2.0), minus, load, times]);
        assert_eq!(five_v.steps.len(), 3);
        assert_eq!(five_v.value(&Situation { speed_m_s: 3.0, ..Situation::default() }, &[]), 15.0);
        assert_eq!(five_v.last(), None);
        assert_eq!(program(&[Step::Push(7.0), Step::Push(2.0), minus]).last(), Some(5.0));
    }

    #[test]
    fn a_stack_that_would_overflow_is_refused_before_it_runs() {
        let mut full = program(&[Step::Load(|at| at.speed_m_s); STACK]);
        assert_eq!(full.push(Step::Push(1.0)), Err(TooDeep));
    }
}
