//! Reads an expression, checks its units and compiles it, in one pass from left to right.
//!
//! ```text
//! comparison = sum [("<" | "<=" | ">" | ">=" | "==" | "!=") sum]
//! sum        = product {("+" | "-") product}
//! product    = unary {("*" | "/") unary}
//! unary      = "-" unary | power
//! power      = primary ["^" unary]
//! primary    = number | variable | constant | function "(" comparison {"," comparison} ")" | "(" comparison ")"
//! ```

use super::dimension::Dimension;
use super::fault::Fault;
use super::lexer::{Kind, Token, next};
use super::names::{
    COMPARISONS, FUNCTIONS, Function, LAG_UNIT, LAGS, MADE, Rule, SWITCHES, VARIABLES, WAY, WAY_STATE,
    WAY_UNIT, power,
};
use super::program::{Program, Step};
use super::units::{Operand, same_unit};
use headland_units::parse_unit;
use std::ops::Range;

/// How deep brackets, signs and powers may nest.
const DEEPEST: usize = 64;

/// A constant of the scenario, in SI units.
#[derive(Clone, Debug)]
pub(super) struct Constant {
    pub name: String,
    pub value: f64,
    pub dimension: Dimension,
}

/// A compiled expression, and which of the constants it names.
#[derive(Debug)]
pub(super) struct Compiled {
    pub program: Program,
    pub dimension: Dimension,
    /// A lone 0, which has every unit.
    pub any_unit: bool,
    pub uses: Vec<bool>,
    /// Where it names what forces make.
    pub made: Vec<Range<usize>>,
}

/// Compiles a text; `memory` holds what the texts before it remember, and holds what this one does as well then.
pub(super) fn compile(
    text: &str,
    constants: &[Constant],
    memory: &mut Vec<&'static str>,
) -> Result<Compiled, Fault> {
    let uses = vec![false; constants.len()];
    let (token, program) = (next(text, 0), Program::default());
    let mut parser =
        Parser { text, constants, memory, token, end: 0, program, uses, made: Vec::new(), depth: 0 };
    let whole = parser.comparison()?;
    if parser.token.kind != Kind::End {
        return Err(parser.unexpected("an operator or the end"));
    }
    let Parser { program, uses, made, .. } = parser;
    Ok(Compiled { program, dimension: whole.dimension, any_unit: whole.is_zero(), uses, made })
}

struct Parser<'a> {
    text: &'a str,
    constants: &'a [Constant],
    memory: &'a mut Vec<&'static str>,
    /// The word that comes next.
    token: Token,
    /// Where the last word ended.
    end: usize,
    program: Program,
    uses: Vec<bool>,
    made: Vec<Range<usize>>,
    depth: usize,
}

impl<'a> Parser<'a> {
    fn word(&self) -> &'a str {
        &self.text[self.token.span.clone()]
    }

    fn advance(&mut self) -> Token {
        let following = next(self.text, self.token.span.end);
        self.end = self.token.span.end;
        std::mem::replace(&mut self.token, following)
    }

    /// Takes the next word where it is one of these signs.
    fn take(&mut self, signs: &[&str]) -> Option<&'a str> {
        let word = self.word();
        (self.token.kind == Kind::Sign && signs.contains(&word)).then(|| {
            self.advance();
            word
        })
    }

    fn unexpected(&self, expected: &str) -> Fault {
        Fault::at(self.text, self.token.span.clone(), "", expected)
    }

    fn emit(&mut self, step: Step, span: Range<usize>) -> Result<(), Fault> {
        if self.program.push(step).is_err() {
            return Err(Fault::at(self.text, span, "", "fewer values that wait for the rest of the text"));
        }
        match self.program.last() {
            Some(value) if !value.is_finite() => {
                Err(Fault::at(self.text, span, &format!(", which is {value}"), "a finite number"))
            }
            _ => Ok(()),
        }
    }

    fn comparison(&mut self) -> Result<Operand, Fault> {
        let left = self.sum()?;
        let Some((_, step)) =
            COMPARISONS.iter().find(|(sign, _)| self.token.kind == Kind::Sign && *sign == self.word())
        else {
            return Ok(left);
        };
        self.advance();
        let right = self.sum()?;
        same_unit(self.text, &left, &right)?;
        let span = left.span.start..self.end;
        self.emit(*step, span.clone())?;
        Ok(Operand { dimension: Dimension::NONE, literal: None, span })
    }

    fn sum(&mut self) -> Result<Operand, Fault> {
        let mut left = self.product()?;
        while let Some(sign) = self.take(&["+", "-", "−"]) {
            let right = self.product()?;
            let dimension = same_unit(self.text, &left, &right)?;
            let operation: fn(f64, f64) -> f64 = if sign == "+" { |a, b| a + b } else { |a, b| a - b };
            left = self.two(operation, dimension, &left, &right)?;
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Operand, Fault> {
        let mut left = self.unary()?;
        while let Some(sign) = self.take(&["*", "/"]) {
            let right = self.unary()?;
            let (operation, exponent): (fn(f64, f64) -> f64, f64) =
                if sign == "*" { (|a, b| a * b, 1.0) } else { (|a, b| a / b, -1.0) };
            let dimension = left.dimension.times(right.dimension.to_the(exponent));
            left = self.two(operation, dimension, &left, &right)?;
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Operand, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.unexpected(&format!("brackets, signs and powers at most {DEEPEST} deep")));
        }
        let start = self.token.span.start;
        let operand = if self.take(&["-", "−"]).is_some() {
            let operand = self.unary()?;
            let span = start..self.end;
            self.emit(Step::One(|a| -a), span.clone())?;
            Operand { literal: operand.literal.map(|value| -value), span, ..operand }
        } else {
            self.power()?
        };
        self.depth -= 1;
        Ok(operand)
    }

    fn power(&mut self) -> Result<Operand, Fault> {
        let base = self.primary()?;
        if self.take(&["^"]).is_none() {
            return Ok(base);
        }
        let exponent = self.unary()?;
        let dimension = base.raised(self.text, &exponent)?;
        self.two(power, dimension, &base, &exponent)
    }

    fn primary(&mut self) -> Result<Operand, Fault> {
        let Token { kind, span } = self.token.clone();
        match kind {
            Kind::Number(value) => {
                self.advance();
                self.emit(Step::Push(value), span.clone())?;
                Ok(Operand { dimension: Dimension::NONE, literal: Some(value), span })
            }
            Kind::Name => self.name(),
            Kind::Sign if self.word() == "(" => {
                self.advance();
                let inner = self.comparison()?;
                if self.take(&[")"]).is_none() {
                    return Err(self.unexpected("an operator or `)`"));
                }
                Ok(Operand { span: span.start..self.end, ..inner })
            }
            _ => Err(self.unexpected("a number, a name or `(`")),
        }
    }

    fn name(&mut self) -> Result<Operand, Fault> {
        let name = self.word();
        let Token { span, .. } = self.advance();
        let operand = |dimension| Operand { dimension, literal: None, span: span.clone() };
        if let Some(function) = FUNCTIONS.iter().find(|function| function.name == name) {
            return self.call(function, span.start);
        }
        if let Some(index) = self.constants.iter().position(|constant| constant.name == name) {
            let constant = &self.constants[index];
            self.uses[index] = true;
            self.emit(Step::Push(constant.value), span.clone())?;
            return Ok(operand(constant.dimension));
        }
        if name == WAY {
            let place = self.place_of_way();
            self.emit(Step::Recall(place), span.clone())?;
            return Ok(operand(dimension(WAY_UNIT)));
        }
        let Some(variable) = VARIABLES.iter().find(|variable| variable.name == name) else {
            return Err(Fault::unknown(self.text, span, self.constants));
        };
        if MADE.contains(&variable.name) {
            self.made.push(span.clone());
        }
        self.emit(Step::Load(variable.of), span.clone())?;
        Ok(operand(dimension(variable.unit)))
    }

    /// Where the way is remembered; all that name it share one place.
    fn place_of_way(&mut self) -> usize {
        self.memory.iter().position(|name| *name == WAY_STATE).unwrap_or_else(|| {
            self.memory.push(WAY_STATE);
            self.memory.len() - 1
        })
    }

    /// Where the next switch is remembered, or what follows late; each has a place of its own.
    fn next_place(
        &mut self,
        names: &'static [&'static str],
        what: &str,
        span: &Range<usize>,
    ) -> Result<usize, Fault> {
        let Some(free) = names.iter().find(|name| !self.memory.contains(name)) else {
            let expected = format!("at most {} {what} in all formulas", names.len());
            return Err(Fault::at(self.text, span.clone(), "", &expected));
        };
        self.memory.push(free);
        Ok(self.memory.len() - 1)
    }

    fn call(&mut self, function: &Function, start: usize) -> Result<Operand, Fault> {
        if self.take(&["("]).is_none() {
            return Err(self.unexpected(&format!("`(` behind the function `{}`", function.name)));
        }
        let mut arguments = Vec::with_capacity(function.arguments);
        while arguments.len() < function.arguments {
            arguments.push(self.comparison()?);
            let last = arguments.len() == function.arguments;
            if self.take(&[if last { ")" } else { "," }]).is_none() {
                let expected = format!(
                    "an operator or `{}`; `{}` has {} argument{}",
                    if last { ")" } else { "," },
                    function.name,
                    function.arguments,
                    if function.arguments == 1 { "" } else { "s" }
                );
                return Err(self.unexpected(&expected));
            }
        }
        let span = start..self.end;
        let dimension = self.dimension_of(function, &arguments)?;
        let step = match function.step {
            Step::Latch(_) => Step::Latch(self.next_place(&SWITCHES, "switches", &span)?),
            Step::Lag(_) => Step::Lag(self.next_place(&LAGS, "`lagged`", &span)?),
            other => other,
        };
        self.emit(step, span.clone())?;
        Ok(Operand { dimension, literal: None, span })
    }

    fn dimension_of(&self, function: &Function, arguments: &[Operand]) -> Result<Dimension, Fault> {
        let first = &arguments[0];
        match function.rule {
            Rule::Same => {
                let mut known = first.clone();
                for argument in &arguments[1..] {
                    known.dimension = same_unit(self.text, &known, argument)?;
                    if known.is_zero() {
                        known = argument.clone();
                    }
                }
                Ok(known.dimension)
            }
            Rule::Pure => {
                first.pure(self.text, &format!("a pure number, as `{}` wants", function.name))?;
                Ok(Dimension::NONE)
            }
            Rule::Sign => Ok(Dimension::NONE),
            Rule::Switch => {
                for argument in &arguments[1..] {
                    same_unit(self.text, first, argument)?;
                }
                Ok(Dimension::NONE)
            }
            Rule::Lag => {
                let lag_s = &arguments[1];
                if lag_s.dimension == dimension(LAG_UNIT) {
                    return Ok(first.dimension);
                }
                Err(lag_s.fault(self.text, "a time constant in s, as the second argument of `lagged`"))
            }
            Rule::Root => Ok(first.dimension.to_the(0.5)),
            Rule::Power => first.raised(self.text, &arguments[1]),
        }
    }

    fn two(
        &mut self,
        operation: fn(f64, f64) -> f64,
        dimension: Dimension,
        left: &Operand,
        right: &Operand,
    ) -> Result<Operand, Fault> {
        let span = left.span.start..self.end;
        self.emit(Step::Two(operation), span.clone())?;
        let literal = left.literal.zip(right.literal).map(|(a, b)| operation(a, b));
        Ok(Operand { dimension, literal, span })
    }
}

fn dimension(unit: &str) -> Dimension {
    parse_unit(unit).map_or(Dimension::NONE, |unit| Dimension::of(&unit))
}
