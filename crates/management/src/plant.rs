//! A driveline whose costs are known in closed form, for tests.

use headland_plugin::{Consequence, Outlook, Share, Stores};

/// An engine that burns 8 kW + 2.2 P + P²/400 kW, and a store of 36 MJ without losses that gives and takes 100 kW.
#[derive(Clone, Copy, Debug)]
pub struct Plant {
    pub power_w: f64,
    pub state_of_charge: f64,
    pub engine_runs: bool,
}

impl Default for Plant {
    fn default() -> Self {
        Self { power_w: 50e3, state_of_charge: 0.5, engine_runs: false }
    }
}

pub const STORE_J: f64 = 36e6;
pub const MOST_STORE_W: f64 = 100e3;
pub const MOST_ENGINE_W: f64 = 200e3;

/// Power of the fuel for a power at the shaft.
pub fn fuel_w(engine_w: f64) -> f64 {
    8e3 + 2.2 * engine_w + engine_w * engine_w / 400e3
}

impl Stores for Plant {
    fn outlook(&self) -> Outlook {
        Outlook {
            power_w: self.power_w,
            most_engine_w: MOST_ENGINE_W,
            state_of_charge: self.state_of_charge,
            window: (0.2, 0.8),
            most_store_w: (MOST_STORE_W, MOST_STORE_W),
            engine_runs: self.engine_runs,
        }
    }

    fn weigh(&self, share: Share) -> Consequence {
        let engine_w = if share.engine_runs { share.engine_w } else { 0.0 };
        let wanted = self.power_w - engine_w;
        let store_w = wanted.clamp(-MOST_STORE_W, MOST_STORE_W);
        Consequence {
            fuel_w: if share.engine_runs { fuel_w(engine_w) } else { 0.0 },
            store_w,
            charge_per_s: -store_w / STORE_J,
            short_w: (wanted - store_w).abs(),
            engine_w,
        }
    }
}
