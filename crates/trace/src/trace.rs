//! A set of channels on one time base.

use crate::{Channel, Origin, TraceError};

/// Channels on a strictly increasing, not necessarily even, time base.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    time_s: Vec<f64>,
    channels: Vec<Channel>,
}

/// One run of a recording or of a simulation: a trace with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name, unique among the runs that belong together.
    pub id: String,
    /// Its channels.
    pub trace: Trace,
}

impl Trace {
    /// A trace without channels on this time base [s].
    ///
    /// # Errors
    /// [`TraceError::Time`] where time does not strictly increase or is not finite.
    pub fn new(time_s: Vec<f64>) -> Result<Self, TraceError> {
        if let Some(first) = time_s.first()
            && !first.is_finite()
        {
            return Err(TraceError::Time { index: 0, before: f64::NAN, after: *first });
        }
        for (index, pair) in time_s.windows(2).enumerate() {
            if !(pair[1] > pair[0] && pair[1].is_finite()) {
                return Err(TraceError::Time { index: index + 1, before: pair[0], after: pair[1] });
            }
        }
        Ok(Self { time_s, channels: Vec::new() })
    }

    /// Adds a channel, one value a sample.
    ///
    /// # Errors
    /// [`TraceError::Length`] or [`TraceError::Twice`].
    pub fn push(
        &mut self,
        name: impl Into<String>,
        values: Vec<f64>,
        origin: Origin,
    ) -> Result<(), TraceError> {
        let name = name.into();
        if values.len() != self.time_s.len() {
            return Err(TraceError::Length { name, found: values.len(), expected: self.time_s.len() });
        }
        if name == "time_s" || self.channel(&name).is_some() {
            return Err(TraceError::Twice { name });
        }
        self.channels.push(Channel { name, values, origin });
        Ok(())
    }

    /// The same, with those channels called from another origin that `is_of` names.
    #[must_use]
    pub fn with_origin(mut self, origin: Origin, is_of: impl Fn(&str) -> bool) -> Self {
        for channel in self.channels.iter_mut().filter(|channel| is_of(&channel.name)) {
            channel.origin = origin;
        }
        self
    }

    /// Time of each sample [s].
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// Time from the first sample to the last [s].
    pub fn duration_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Mean time between samples [s]; the whole duration where there is but one step or none.
    pub fn period_s(&self) -> f64 {
        self.duration_s() / (self.len().max(2) - 1) as f64
    }

    /// All channels, in the order in which they were added.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The channel of this name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// The values of the channel of this name; time included.
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        if name == "time_s" {
            return Some(&self.time_s);
        }
        self.channel(name).map(|channel| channel.values.as_slice())
    }

    /// The values of a channel that has to be there.
    ///
    /// # Errors
    /// [`TraceError::Missing`] names the channels that are there.
    pub fn require(&self, name: &str) -> Result<&[f64], TraceError> {
        self.get(name).ok_or_else(|| TraceError::Missing {
            name: name.to_owned(),
            present: self.channels.iter().map(|channel| channel.name.clone()).collect(),
        })
    }

    /// Takes a channel out of the trace.
    pub fn remove(&mut self, name: &str) -> Option<Channel> {
        let index = self.channels.iter().position(|channel| channel.name == name)?;
        Some(self.channels.remove(index))
    }

    /// The value of a channel at a time [s], linear between samples; NaN outside the time base, or beside a NaN.
    pub fn at(&self, name: &str, time_s: f64) -> Option<f64> {
        self.get(name).map(|values| interpolate(&self.time_s, values, time_s))
    }

    /// The samples with `from_s <= time <= to_s`.
    #[must_use]
    pub fn slice(&self, from_s: f64, to_s: f64) -> Self {
        let first = self.time_s.partition_point(|time| *time < from_s);
        let end = self.time_s.partition_point(|time| *time <= to_s).max(first);
        Self {
            time_s: self.time_s[first..end].to_vec(),
            channels: self
                .channels
                .iter()
                .map(|channel| Channel { values: channel.values[first..end].to_vec(), ..channel.clone() })
                .collect(),
        }
    }

    /// The same channels on another time base, linear between samples and NaN outside.
    ///
    /// # Errors
    /// [`TraceError::Time`] where the new time base does not increase.
    pub fn resample(&self, time_s: &[f64]) -> Result<Self, TraceError> {
        let mut resampled = Self::new(time_s.to_vec())?;
        for channel in &self.channels {
            let values =
                time_s.iter().map(|time| interpolate(&self.time_s, &channel.values, *time)).collect();
            resampled.push(channel.name.clone(), values, channel.origin)?;
        }
        Ok(resampled)
    }
}

/// Linear interpolation on a strictly increasing base; NaN outside it.
fn interpolate(base: &[f64], values: &[f64], at: f64) -> f64 {
    let right = base.partition_point(|point| *point < at);
    if right == base.len() {
        return f64::NAN;
    }
    if base[right] == at {
        return values[right];
    }
    if right == 0 {
        return f64::NAN;
    }
    let share = (at - base[right - 1]) / (base[right] - base[right - 1]);
    values[right - 1] + share * (values[right] - values[right - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Trace {
        let mut trace = Trace::new(vec![0.0, 1.0, 3.0]).unwrap();
        trace.push("speed_m_s", vec![0.0, 2.0, 6.0], Origin::Measured).unwrap();
        trace
    }

    #[test]
    fn values_between_samples_are_linear_and_outside_missing() {
        assert_eq!(ramp().at("speed_m_s", 2.0), Some(4.0));
        assert_eq!(ramp().at("speed_m_s", 3.0), Some(6.0));
        assert!(ramp().at("speed_m_s", 3.1).unwrap().is_nan());
        assert!(ramp().at("speed_m_s", -0.1).unwrap().is_nan());
    }

    #[test]
    fn time_that_stands_still_is_refused() {
        assert!(matches!(Trace::new(vec![0.0, 1.0, 1.0]), Err(TraceError::Time { index: 2, .. })));
        assert!(matches!(Trace::new(vec![0.0, f64::NAN]), Err(TraceError::Time { index: 1, .. })));
        assert!(matches!(Trace::new(vec![f64::NAN]), Err(TraceError::Time { index: 0, .. })));
    }

    #[test]
    fn a_channel_of_another_length_or_a_second_of_its_name_is_refused() {
        let mut trace = ramp();
        assert!(matches!(trace.push("grade", vec![0.0], Origin::Measured), Err(TraceError::Length { .. })));
        assert!(matches!(
            trace.push("speed_m_s", vec![0.0; 3], Origin::Measured),
            Err(TraceError::Twice { .. })
        ));
    }

    #[test]
    fn a_slice_holds_both_ends() {
        let part = ramp().slice(1.0, 3.0);
        assert_eq!(part.time_s(), [1.0, 3.0]);
        assert_eq!(part.get("speed_m_s").unwrap(), [2.0, 6.0]);
        assert!(ramp().slice(5.0, 4.0).is_empty());
    }

    #[test]
    fn a_missing_channel_is_answered_with_those_that_are_there() {
        let error = ramp().require("fuel_rate_kg_s").unwrap_err();
        assert_eq!(error.to_string(), "no channel `fuel_rate_kg_s`; there are: speed_m_s");
    }
}
