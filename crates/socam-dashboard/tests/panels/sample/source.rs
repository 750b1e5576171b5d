//! The live view of other devices than the own board: one of text whose units are not known, and a drive that is recorded, or that follows a
//! signal.

use std::f64::consts::TAU;

use socam_chart::theme::Look;
use socam_core::State;
use socam_dashboard::{Dashboard, View};
use socam_recording::{Channel, Unit};
use socam_workbench::device::{Effort, Offer, Peer, Source, SourceState, Unstated};
use socam_workbench::link::{Bench, News};
use socam_workbench::queue::{Batch, Gap};

use super::bench::{health, linked, tell};
use super::{Noise, dashboard};

/// Eight seconds at 100 Hz, of which some rows are missing.
fn samples(channels: usize, missing: std::ops::Range<usize>) -> Batch {
    let mut noise = Noise(7);
    let mut batch =
        Batch { time_s: Vec::new(), step_s: 0.0, after_setup: false, gaps: None, values: Vec::new() };
    let mut gaps = Vec::new();
    for row in (0..800).filter(|row| !missing.contains(row)) {
        if row == missing.end {
            gaps.push(Gap { row: batch.time_s.len(), missed: missing.len() as u64 });
        }
        let time_s = 0.01 * row as f64;
        batch.time_s.push(time_s);
        let value = |channel: usize| {
            let slow = (TAU * (0.2 + 0.15 * channel as f64) * time_s).sin();
            (3.0 + 20.0 * (channel % 3) as f64) * slow + 0.3 * noise.next()
        };
        batch.values.extend((0..channels).map(value));
    }
    batch.gaps = Some(gaps);
    batch
}

fn connected(
    look: Look,
    device: &str,
    source: Source,
    board: &str,
    channels: Vec<Channel>,
) -> (Dashboard, Bench) {
    let mut dashboard = dashboard(look, View::Live);
    dashboard.workspace.device = device.into();
    let (dashboard, bench) = linked(dashboard);
    let limits = vec![None; channels.len()];
    let peer = Peer::Source(source);
    bench.news.send(News::Connected { peer, board: board.into(), channels, limits }).unwrap();
    (dashboard, bench)
}

/// A device whose units are not known, one with a long name among them.
pub(crate) fn text(look: Look) -> Dashboard {
    let device = "serial:/dev/serial/by-id/usb-Raspberry_Pi_Pico_E6612483CB1A2B2B-if00?baud=115200";
    let names = ["enc", "temperature_of_the_bearing_at_the_output_side", "i_motor"];
    let channels = names.map(|name| Channel::new(name, Unit::One)).into();
    let sentence = "the device does not state the unit of `enc`, the unit of `temperature_of_the_bearing_at_the_output_side`, the unit of `i_motor`";
    let unstated = Some(Unstated { sentence: sentence.into(), description: String::new() });
    let source = Source { unstated, ..Source::default() };
    let board = format!("a device that sends columns of text, at {device}");
    let (dashboard, bench) = connected(look, device, source, &board, channels);
    bench.samples.push(samples(3, 0..0));
    let state = SourceState {
        received: 800,
        counted_by: "by the device's clock, which ticks every 0.010000 s".into(),
        times: "times by the device's clock, +12.4 ppm against this computer's, within 0.083 ms".into(),
        ..SourceState::default()
    };
    bench.news.send(News::Source(state)).unwrap();
    dashboard
}

const DRIVE: &str = "moteus:/dev/ttyACM0?id=1";

/// A drive at rest that can be commanded, with these limits of its channels.
fn offered(look: Look, does: &str, limits: Vec<Option<f64>>) -> (Dashboard, Bench) {
    let mut dashboard = dashboard(look, View::Live);
    dashboard.workspace.device = DRIVE.into();
    let (mut dashboard, bench) = linked(dashboard);
    let (torque, current) = (Channel::new("torque", Unit::Nm), Channel::new("current", Unit::A));
    let (speed, command) = (Channel::new("speed", Unit::RadPerS), Channel::new("command", Unit::RadPerS));
    let channels = vec![Channel::new("position", Unit::Rad), speed, torque, current, command];
    let offer = Offer {
        effort: Effort::Torque,
        kept: vec![
            "Each command holds a largest torque of 0.5 N m.".into(),
            "Each command holds a watchdog: the drive leaves its position mode 0.25 s after the last command that it got.".into(),
        ],
        not_promised: vec![
            "Once its watchdog has acted, it does what its setting `servo.timeout_mode` says, by default braking with up to `servo.timeout_max_torque_Nm`, 5 N m by default; it cannot be read here.".into(),
            "When the run ends the motor is switched off: it coasts, and a weight falls.".into(),
        ],
        command: format!("socam-host record --device '{DRIVE}' -o run.mcap --profile speeds.toml --limit 30rad/s --limit 0.5Nm --arm"),
    };
    let peer = Peer::Source(Source { is_asked: true, offer: Some(offer), unstated: None });
    let board = format!("the moteus 1 behind an fdcanusb, which {does}, at {DRIVE}");
    bench.news.send(News::Connected { peer, board, channels, limits }).unwrap();
    bench.news.send(health(State::Idle, None)).unwrap();
    dashboard.workspace.listen();
    (dashboard, bench)
}

/// A drive that is connected and at rest.
pub(crate) fn at_rest(look: Look) -> (Dashboard, Bench) {
    offered(look, "is only asked", vec![None; 5])
}

/// A drive that is recorded and not commanded, and whose cable was pulled for a second.
pub(crate) fn drive(look: Look) -> Dashboard {
    let (dashboard, bench) = at_rest(look);
    bench.news.send(News::Began { path: "runs/rotor-3.mcap".into(), planned_s: 0.0 }).unwrap();
    tell(&bench, 1.0, "start", "the recording begins");
    tell(&bench, 4.99, "fault", "the link broke: the other end closed it");
    tell(&bench, 5.99, "note", "the link is back");
    bench.samples.push(samples(5, 500..600));
    let state = SourceState {
        received: 700,
        lost: 100,
        interruptions: 1,
        counted_by: "where they are damaged only: the device states neither time nor number".into(),
        times: "times of arrival, within 1.4 ms".into(),
        recorded: Some([600, 100]),
        ..SourceState::default()
    };
    bench.news.send(News::Source(state)).unwrap();
    dashboard
}

/// A drive that follows a signal within its limits.
pub(crate) fn commanded(look: Look) -> Dashboard {
    let limits = vec![None, Some(30.0), Some(45.0), None, Some(30.0)];
    let (mut dashboard, bench) = offered(look, "follows a profile", limits);
    dashboard.workspace.drive.set_speed(30.0);
    dashboard.workspace.drive.set_effort(Effort::Torque, 0.5);
    bench.news.send(News::Began { path: "runs/rotor-4.mcap".into(), planned_s: 20.5 }).unwrap();
    bench.news.send(health(State::Running, None)).unwrap();
    tell(&bench, 1.0, "start", "the run begins");
    bench.samples.push(samples(5, 0..0));
    let state = SourceState {
        received: 800,
        counted_by: "where they are damaged only: the device states neither time nor number".into(),
        times: "times of arrival, within 1.4 ms".into(),
        recorded: Some([700, 0]),
        ..SourceState::default()
    };
    bench.news.send(News::Source(state)).unwrap();
    dashboard
}
