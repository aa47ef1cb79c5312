//! Measured speed of each coast-down beside the fitted one, for plots.

use super::CoastDownError;
use super::motion::{Air, Motion, Term};
use super::study::Study;

/// One coast-down.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name of the run.
    pub run: String,
    /// Time in the trace [s].
    pub time_s: Vec<f64>,
    /// Measured speed [m/s].
    pub measured_m_s: Vec<f64>,
    /// Speed of the road load that all runs share, with the run's own offset [m/s].
    pub fitted_m_s: Vec<f64>,
}

impl Study {
    /// The curves of the road load, run by run.
    ///
    /// # Errors
    /// [`CoastDownError`] where the fit fails.
    pub fn curves(&self) -> Result<Vec<Curve>, CoastDownError> {
        let fitted = self.fit_road_load()?;
        let mut terms = fitted.terms.clone();
        terms.push(Term::Offset);
        let curve = |(index, coast): (usize, &super::segment::Coast)| {
            let mut parameters = fitted.parameters.clone();
            parameters.push(fitted.offsets[index].0);
            let motion = Motion { terms: &terms, parameters: &parameters, air: Air::WindOnly };
            let (speeds, _) = motion.roll_out(coast, fitted.initial_m_s[index]);
            Curve {
                run: coast.id.clone(),
                time_s: coast.time_s.iter().map(|time| coast.from_s + time).collect(),
                measured_m_s: coast.speed_m_s.clone(),
                fitted_m_s: speeds.as_slice().to_vec(),
            }
        };
        Ok(self.coasts.iter().enumerate().map(curve).collect())
    }

    /// Coefficient of every sample, run by run, as the first stage of the two-stage method has it.
    pub fn samples(&self, unit: super::SpeedUnit) -> Vec<(String, Vec<f64>)> {
        let of = |coast: &super::segment::Coast| {
            let width = self.settings.difference_s;
            let all = super::two_stage::coefficients(coast, unit.hundred_m_s(), width, false);
            (coast.id.clone(), all)
        };
        self.coasts.iter().map(of).collect()
    }
}
