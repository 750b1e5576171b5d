//! The device that the window wants to connect to.

use std::path::PathBuf;

use socam_workbench::device::{Needs, Stated, Wanted};

use crate::commands::record::described::SourceArgs;
use crate::commands::record::source::{self as record_source, Target};

/// The device that is wanted, with what is said of it.
pub(super) fn target(wanted: &Wanted) -> anyhow::Result<(Target, SourceArgs)> {
    let address = &wanted.address;
    let target: Target =
        address.parse().map_err(|expected| anyhow::anyhow!("`{address}` is no device: {expected}"))?;
    let needs = Needs::of(address);
    let path = |text: &str, is_needed| Some(PathBuf::from(text)).filter(|_| is_needed && !text.is_empty());
    let Stated { description, takes_guesses, dbc } = &wanted.stated;
    let args = SourceArgs {
        describe: path(description.trim(), needs == Needs::Description),
        accept_guesses: *takes_guesses && needs == Needs::Description,
        dbc: path(dbc.trim(), needs == Needs::Dbc),
        is_of_window: true,
    };
    Ok((record_source::of(&target, &args)?, args))
}

/// The interval at which a device is asked, ns.
pub(super) fn period_ns(rate_hz: f64) -> i64 {
    if rate_hz > 0.0 { (1e9 / rate_hz) as i64 } else { 1_000_000 }
}
