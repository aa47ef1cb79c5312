//! A consumer at a load-sensing hydraulic system.
//!
//! P = (p + Δp) Q / η        p pressure of the consumer, Δp margin of the pump above it, Q flow, η of the pump
//! P_standby = Δp Q_leak / η where it idles
//!
//! Source: definition: pressure times flow; a margin of 20 to 25 bar is usual, from memory (Murrenhoff, *Fundamentals of
//! Fluid Power*).
//! Leaves out other consumers at a higher pressure, for whom the pump would stand higher.

use headland_plugin::{Bound, Card, Load, Mode, Plugin, Situation, Task, parameter};
use serde::Deserialize;

/// A hydraulic consumer: a fan, a pump, a cylinder that keeps moving.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadSensing {
    pressure_pa: f64,
    flow_m3_s: f64,
    margin_pa: f64,
    pump_efficiency: f64,
    standby_flow_m3_s: f64,
}

impl Plugin for LoadSensing {
    const CARD: Card = Card {
        name: "LoadSensing",
        about: "a hydraulic consumer by pressure and flow, with the margin that the pump keeps above it",
        equation: "P = (p + Δp) Q / η; idling P = Δp Q_leak / η",
        source: "definition: pressure times flow; Murrenhoff, Fundamentals of Fluid Power, for the margin, from memory",
        validity: "one consumer at a time; others at a higher pressure would raise its losses",
        parameters: &[
            parameter("pressure_pa", "Pa", "at the consumer, p")
                .must_be(Bound::NotNegative)
                .usually(1e6, 2.5e7),
            parameter("flow_m3_s", "m³/s", "through it, Q; 1e-3 are 60 L/min")
                .must_be(Bound::NotNegative)
                .usually(1e-5, 5e-3),
            parameter("margin_pa", "Pa", "of the pump above the consumer, Δp")
                .must_be(Bound::NotNegative)
                .usually(1e6, 4e6),
            parameter("pump_efficiency", "1", "shaft to oil, η")
                .must_be(Bound::Efficiency)
                .usually(0.7, 0.95),
            parameter("standby_flow_m3_s", "m³/s", "leakage that the pump makes up for, Q_leak")
                .must_be(Bound::NotNegative)
                .usually(0.0, 5e-4),
        ],
    };
}

impl Task for LoadSensing {
    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load_in(Mode::Work, at, states, rates)
    }

    fn load_in(&self, mode: Mode, _: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        let oil_w = match mode {
            Mode::Work => (self.pressure_pa + self.margin_pa) * self.flow_m3_s,
            Mode::Idle => self.margin_pa * self.standby_flow_m3_s,
            Mode::Rest | Mode::Fill | Mode::Empty => 0.0,
        };
        Load { hydraulic_power_w: oil_w / self.pump_efficiency, ..Load::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (160 + 20) bar · 1 L/s / 0.9 = 20 kW; idling 20 bar · 0.09 L/s / 0.9 = 200 W.
    #[test]
    fn a_hydraulic_fan_by_hand() {
        let fan: LoadSensing = ron::from_str(
            "(pressure_pa: 16e6, flow_m3_s: 1e-3, margin_pa: 2e6, pump_efficiency: 0.9, standby_flow_m3_s: 9e-5)",
        )
        .unwrap();
        let power = |mode| fan.load_in(mode, &Situation::default(), &[], &mut []).hydraulic_power_w;
        assert!((power(Mode::Work) / 20_000.0 - 1.0).abs() < 1e-12);
        assert!((power(Mode::Idle) / 200.0 - 1.0).abs() < 1e-12);
        assert_eq!(power(Mode::Rest), 0.0);
    }

    #[test]
    fn a_margin_has_to_be_said() {
        let text = "(pressure_pa: 16e6, flow_m3_s: 1e-3, pump_efficiency: 0.9, standby_flow_m3_s: 0)";
        assert!(ron::from_str::<LoadSensing>(text).is_err());
    }
}
