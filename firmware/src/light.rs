//! The light on the board.

use core::sync::atomic::Ordering;

use embassy_rp::gpio::Output;
use embassy_time::Timer;
use socam_core::State;

use crate::sampling::STATE_AND_FAULT;

/// Idle: one short blink per second. Armed: two. Drive enabled: steady. Fault: as many blinks as the fault's number, then a pause of
/// two seconds.
#[embassy_executor::task]
pub(crate) async fn show(mut light: Output<'static>) {
    loop {
        let state_and_fault = STATE_AND_FAULT.load(Ordering::Relaxed);
        let (state, fault) = (State::from_code(state_and_fault as u8), state_and_fault >> 8);
        match state {
            Some(State::Running | State::Stopping) => {
                light.set_high();
                Timer::after_millis(100).await;
            }
            Some(State::Fault) => blink(&mut light, fault, 250, 2000).await,
            Some(State::Armed) => blink(&mut light, 2, 100, 600).await,
            Some(State::Idle) | None => blink(&mut light, 1, 100, 800).await,
        }
    }
}

async fn blink(light: &mut Output<'static>, times: u32, each_ms: u64, pause_ms: u64) {
    for _ in 0..times {
        light.set_high();
        Timer::after_millis(each_ms).await;
        light.set_low();
        Timer::after_millis(each_ms).await;
    }
    light.set_low();
    Timer::after_millis(pause_ms).await;
}
