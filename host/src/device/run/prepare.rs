//! Prepares a board for a run.

use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use socam_core::{Fault, Refusal, Request};
use socam_wire::{EnableFeedback, Identity, Image};

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
    judge(session.identity())?;
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

/// Refuses a board whose program is damaged, and lists the checks that a board cannot do on itself.
fn judge(identity: &Identity) -> anyhow::Result<()> {
    match identity.image {
        Image::Whole => {}
        Image::Unsealed => output::warn(
            "the board's program carries no checksum, so damage to its flash is not noticed: put it there with `socam-host flash`",
        ),
        Image::Damaged => bail!("{}", Fault::ImageDamaged),
    }
    match identity.enable_feedback {
        EnableFeedback::Nowhere => {}
        EnableFeedback::Pin => output::warn(
            "the drive's enable line is read back at the board's pin only, so a fault behind the pin is not noticed: \
             wire GP21 to the drive's enable input and GP20 to ground",
        ),
        EnableFeedback::Drive => output::say("the drive's enable line is read back at the drive"),
    }
    Ok(())
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
