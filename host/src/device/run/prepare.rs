//! Prepares a board for a run.

use std::time::{Duration, Instant};

use anyhow::Context;
use socam_core::{Refusal, Request};

use super::columns::fault_text;
use super::plan::Plan;
use crate::device::session::Session;
use crate::output;

/// Longest time until a bench is at rest.
const STOP_WITHIN: Duration = Duration::from_secs(20);

/// Interval at which a busy board is asked again.
const ASK_EVERY: Duration = Duration::from_millis(100);

/// Sends calibration and profile to the board; reports and clears a fault that it still has.
pub(super) fn prepare(session: &mut Session, plan: &Plan) -> anyhow::Result<()> {
    session.request(Request::Stream(false))?.ok();
    let config = plan.calibration.config(plan.period_us)?;
    let mut result = session.request(Request::Configure(config))?;
    if let Err(Refusal::Faulted(fault)) = result {
        let fault = fault_text(&fault, &plan.calibration);
        output::warn(format_args!("the board remembers an earlier fault, which is cleared now: {fault}"));
        session.request(Request::ClearFault)?.ok();
        result = session.request(Request::Configure(config))?;
    }
    if let Err(Refusal::WrongState { .. }) = result {
        output::warn("the board was still at work; it is stopped first");
        session.request(Request::Stop)?.ok();
        result = wait_for_rest(session, config)?;
    }
    result.context("the board refuses the calibration")?;
    session.request(Request::Load(plan.profile))?.context("the board refuses the profile")
}

fn wait_for_rest(session: &mut Session, config: socam_core::Config) -> anyhow::Result<Result<(), Refusal>> {
    let begin = Instant::now();
    loop {
        let result = session.request(Request::Configure(config))?;
        let is_busy = matches!(result, Err(Refusal::WrongState { .. }));
        if !is_busy || begin.elapsed() > STOP_WITHIN {
            return Ok(result);
        }
        std::thread::sleep(ASK_EVERY);
    }
}
