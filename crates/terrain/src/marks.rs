//! Marks along a path, by name.

/// Marks of one name, in the order of the path.
#[derive(Clone, Debug, Default)]
pub(crate) struct Marks {
    named: Vec<(String, Vec<f64>)>,
}

impl Marks {
    /// Sets one; each name's positions have to come in their order.
    pub fn set(&mut self, name: &str, position_m: f64) {
        match self.named.iter_mut().find(|(own, _)| own == name) {
            Some((_, positions)) => positions.push(position_m),
            None => self.named.push((name.to_owned(), vec![position_m])),
        }
    }

    /// The same marks where `place` puts them, in the same order.
    pub fn moved(&self, place: impl Fn(f64) -> f64) -> Self {
        let named = (self.named.iter())
            .map(|(name, positions)| (name.clone(), positions.iter().map(|at| place(*at)).collect()))
            .collect();
        Self { named }
    }

    /// Their names.
    pub fn names(&self) -> Vec<&str> {
        self.named.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// The next one of a name beyond a position.
    pub fn next_m(&self, name: &str, position_m: f64) -> Option<f64> {
        let (_, positions) = self.named.iter().find(|(own, _)| own == name)?;
        positions.get(positions.partition_point(|at| *at <= position_m)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_mark_lies_beyond_and_the_last_has_none_after_it() {
        let mut marks = Marks::default();
        for at in [10.0, 30.0] {
            marks.set("turn", at);
        }
        assert_eq!(marks.next_m("turn", 9.0), Some(10.0));
        assert_eq!(marks.next_m("turn", 10.0), Some(30.0));
        assert_eq!((marks.next_m("turn", 30.0), marks.next_m("gate", 0.0)), (None, None));
        assert_eq!(marks.names(), ["turn"]);
    }
}
