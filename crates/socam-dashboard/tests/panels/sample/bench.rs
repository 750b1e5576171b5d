//! A bench that runs and is recorded, or that a fault has stopped.

use std::sync::{Arc, Mutex};

use socam_chart::theme::Look;
use socam_core::State;
use socam_dashboard::{Dashboard, View, wake};
use socam_workbench::about::Happening;
use socam_workbench::device::Peer;
use socam_workbench::link::{Bench, Health, News, link};
use socam_workbench::queue::Batch;

use super::{channels, dashboard, run};

/// A live view that is connected to a board that the test simulates.
pub(crate) fn connected(look: Look) -> (Dashboard, Bench) {
    let (dashboard, bench) = linked(dashboard(look, View::Live));
    let board = "virtual bench, firmware 1.0.0, at sim".into();
    let limits = vec![Some(4.99), Some(149.2), Some(20.52), Some(4.8), Some(38.0)];
    bench.news.send(News::Connected { peer: Peer::Board, board, channels: channels(), limits }).unwrap();
    (dashboard, bench)
}

/// A live view whose link the test serves.
pub(crate) fn linked(mut dashboard: Dashboard) -> (Dashboard, Bench) {
    let ends: Arc<Mutex<Option<Bench>>> = Arc::default();
    let theirs = ends.clone();
    dashboard.workspace.bench.connect_by(Box::new(move |_| {
        let (port, bench) = link();
        *theirs.lock().unwrap() = Some(bench);
        port
    }));
    dashboard.workspace.connect(wake(&egui::Context::default()));
    let bench = ends.lock().unwrap().take().unwrap();
    (dashboard, bench)
}

/// The state of a board, and of a recording of 7350 samples.
pub(crate) fn health(state: State, fault: Option<&str>) -> News {
    News::Status(Health {
        state,
        fault: fault.map(str::to_owned),
        overruns: 0,
        dropped: 0,
        link_errors: if fault.is_some() { 3 } else { 0 },
        recorded: Some([7_350, 0]),
    })
}

/// Eight seconds of a bench: it was set up before the run, and later the link lost 400 samples.
pub(crate) fn samples() -> Vec<Batch> {
    let run = run(2, 8000).samples;
    let columns: Vec<Vec<f64>> = (0..5).map(|channel| run.values(channel, 0..8000)).collect();
    let row = |row: usize| columns.iter().map(move |column| column[row]);
    let batch = |(rows, after_setup): (std::ops::Range<usize>, bool)| Batch {
        time_s: run.times(rows.clone()),
        step_s: 1e-3,
        after_setup,
        gaps: None,
        values: rows.flat_map(row).collect(),
    };
    [(0..500, false), (650..5600, true), (6000..8000, false)].map(batch).into()
}

pub(crate) const FILE: &str = "runs/warm-bench-7.mcap";
pub(crate) const FAULT: &str = "over-speed: motor_speed is 150.013 rad/s, the limit is 149.200 rad/s: \
    lower the amplitude, offset or level of the signal, then clear the fault";

fn begun(look: Look) -> (Dashboard, Bench) {
    let (dashboard, bench) = connected(look);
    bench.news.send(News::Began { path: FILE.into(), planned_s: 10.25 }).unwrap();
    tell(&bench, 0.65, "start", "the run begins");
    tell(&bench, 4.4, "note", "coupling 2 squeaks");
    samples().into_iter().for_each(|batch| bench.samples.push(batch));
    (dashboard, bench)
}

pub(super) fn tell(bench: &Bench, time_s: f64, kind: &str, text: &str) {
    bench.news.send(News::Event(Happening { time_s, kind: kind.into(), text: text.into() })).unwrap();
}

pub(crate) fn running(look: Look) -> Dashboard {
    let (dashboard, bench) = begun(look);
    bench.news.send(health(State::Running, None)).unwrap();
    dashboard
}

pub(crate) fn stopped(look: Look) -> Dashboard {
    let (dashboard, bench) = begun(look);
    tell(&bench, 7.999, "fault", "over-speed: motor_speed is 150.013 rad/s, the limit is 149.200 rad/s");
    let text = format!("stopped by a fault; {FILE}: 7350 samples over 7.35 s, none lost");
    bench.news.send(News::Ended { path: FILE.into(), text, well: false }).unwrap();
    bench.news.send(health(State::Fault, Some(FAULT))).unwrap();
    dashboard
}
