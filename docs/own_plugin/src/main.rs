//! `headland` with three models more: every command knows them, every scenario can name them.

#[cfg(test)]
mod diagnosed;
mod snow;
mod standing_crop;
mod washboard;

use headland_plugin::Registry;
use std::process::ExitCode;

fn main() -> ExitCode {
    headland::run(&registry(), std::env::args_os())
}

/// Everything that is built in, and ours.
fn registry() -> Registry {
    let mut registry = headland_stock::registry();
    registry.soil::<snow::Snow>();
    registry.effect::<standing_crop::StandingCrop>();
    registry.effect::<washboard::Washboard>();
    registry
}
