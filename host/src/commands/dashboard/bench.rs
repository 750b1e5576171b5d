//! The board of the live view: a thread that talks to it, records, and sends news and samples to the window.

use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::sync::mpsc::TryRecvError;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use socam_core::{Refusal, Request};
use socam_job::VirtualBench;
use socam_recording::{Attachment, Calibration};
use socam_workbench::about::Happening;
use socam_workbench::device::Peer;
use socam_workbench::link::{self, Bench, Connector, News, Order};

use super::attended::Attended;
use super::show::{IDLE_PERIOD_US, Show};
use super::watcher::{Watcher, ended, health};
use super::{source, wanted};
use crate::commands::record::source::Target;
use crate::commands::record::{attachment, now_unix_ns};
use crate::device::run::{self, End, Plan};
use crate::device::session::Heard;
use crate::device::token::Token;
use crate::device::{self, Device, Pace, Session, front_end};

/// Interval of heartbeats; the watchdog of the board waits for 0.5 s.
const HEARTBEAT_EVERY: Duration = Duration::from_millis(100);

/// Makes links to boards and other devices, each in a thread of its own; the virtual board runs on `bench`.
pub(super) fn connector(
    bench: VirtualBench,
    calibration: Option<Calibration>,
    token: Option<Token>,
    attended: &Attended,
) -> Connector {
    let attended = attended.clone();
    Box::new(move |wake| {
        let (port, own) = link::link();
        let (bench, calibration) = (bench.clone(), calibration.clone());
        let token = token.clone();
        let attended = attended.clone();
        let serve = move || {
            let ended = attend(&own, &bench, calibration, token, &attended);
            // The receiver is gone if the window was closed.
            let _ = own.news.send(News::Disconnected(ended.err().map(|error| format!("{error:#}"))));
            wake();
        };
        if let Err(error) = std::thread::Builder::new().name("bench".into()).spawn(serve) {
            crate::output::warn(format_args!("cannot start the bench's thread: {error}"));
        }
        port
    })
}

/// Opens the requested link and serves it until it is closed.
fn attend(
    own: &Bench,
    bench: &VirtualBench,
    calibration: Option<Calibration>,
    token: Option<Token>,
    attended: &Attended,
) -> anyhow::Result<()> {
    let Ok(Order::Connect(wanted)) = own.orders.recv() else { return Ok(()) };
    let device = match wanted::target(&wanted)? {
        (Target::Board(device), _) => device.with_token(token),
        (Target::Source(address), args) => {
            let model = socam_job::model_text(&bench.model)?;
            let period_ns = wanted::period_ns(wanted.rate_hz);
            return source::attend(own, &address, &args, period_ns, model, attended);
        }
    };
    let setup =
        (device == Device::Sim).then(|| bench.setup(&bench.load()?, calibration.clone())).transpose()?;
    let given = setup.as_ref().map(|setup| setup.calibration.clone()).or(calibration);
    let mut session = device::open(&device, setup.map(|setup| (setup, Pace::RealTime)))?;
    let _attending = attended.begin();
    let (text, default) = front_end::default_calibration(&session.identity().front_end)?;
    let calibration = given.unwrap_or_else(|| default.clone());
    front_end::check(&calibration, &session.identity().front_end)?;
    let text = (calibration == default).then_some(text);
    let identity = session.identity();
    let board = format!("{}, firmware {}, at {device}", identity.board, identity.firmware);
    let mut talk = Talk {
        session: &mut session,
        show: Show::new(calibration.clone(), own.samples.clone()),
        own,
        board,
        device: device.to_string(),
        model: socam_job::model_text(&bench.model)?,
        calibration,
        calibration_text: text,
        armed: None,
        is_set_up: false,
        is_faulty: false,
    };
    talk.look()?;
    talk.go_on()
}

/// An open link.
struct Talk<'a> {
    session: &'a mut Session,
    own: &'a Bench,
    show: Show,
    board: String,
    device: String,
    model: String,
    calibration: Calibration,
    calibration_text: Option<String>,
    armed: Option<Plan>,
    /// Whether the board has this calibration.
    is_set_up: bool,
    /// Whether the last status named a fault.
    is_faulty: bool,
}

impl Talk<'_> {
    fn tell(&self, news: News) {
        let _ = self.own.news.send(news);
    }

    /// Configures the board, if it permits, and streams samples while nothing runs.
    fn look(&mut self) -> anyhow::Result<()> {
        self.session.request(Request::Stream(false))?.ok();
        let configured =
            self.session.request(Request::Configure(self.calibration.config(IDLE_PERIOD_US)?))?;
        self.is_set_up = configured.is_ok();
        match configured {
            // A fault is in the board's status, and is shown from there.
            Ok(()) | Err(Refusal::Faulted(_)) => {}
            Err(refusal @ Refusal::WrongState { .. }) => {
                self.tell(News::Problem(format!("the board keeps its settings: {refusal}")));
            }
            Err(refusal) => return Err(refusal).context("the board refuses the calibration"),
        }
        self.show_samples();
        self.show.set_up(IDLE_PERIOD_US);
        let limits = self.calibration.channels.iter().map(|channel| channel.limit);
        let limits = std::iter::once(Some(self.calibration.clamp_v)).chain(limits).collect();
        self.tell(News::Connected {
            peer: Peer::Board,
            board: self.board.clone(),
            channels: self.show.columns.channels.clone(),
            limits: self.show.columns.recorded(limits),
        });
        self.session.request(Request::Stream(true))?.context("the board does not stream")
    }

    /// Shows samples that arrived while the host waited for an answer.
    fn show_samples(&mut self) {
        self.session.take_samples().for_each(|batch| self.show.take(&batch));
    }

    fn take_heard(&mut self, heard: Heard) {
        match heard {
            Heard::Samples(batch) => self.show.take(&batch),
            Heard::Status(status) => {
                let errors = u64::from(status.link.total()) + u64::from(self.session.link_errors());
                let fault = status.board.fault.map(|fault| run::fault_text(&fault, &self.calibration));
                let was_faulty = std::mem::replace(&mut self.is_faulty, fault.is_some());
                if let Some(text) = fault.filter(|_| !was_faulty) {
                    let (time_s, kind) = (self.show.time_s(None), "fault".into());
                    self.tell(News::Event(Happening { time_s, kind, text }));
                }
                self.tell(News::Status(health(&status, &self.calibration, errors, None)));
            }
        }
    }

    fn go_on(&mut self) -> anyhow::Result<()> {
        let mut beat = Instant::now();
        loop {
            if beat.elapsed() >= HEARTBEAT_EVERY {
                self.session.post(Request::Heartbeat)?;
                beat = Instant::now();
            }
            match self.own.presses.swap(0, Ordering::SeqCst) {
                0 => {}
                1 => drop(self.session.post(Request::Stop)?),
                _ => drop(self.session.post(Request::EmergencyStop)?),
            }
            match self.own.orders.try_recv() {
                Ok(Order::Disconnect) | Err(TryRecvError::Disconnected) => {
                    // A bench without a window is stopped.
                    self.session.post(Request::Stop)?;
                    self.session.post(Request::Stream(false))?;
                    return Ok(());
                }
                Ok(order) => self.take(order)?,
                Err(TryRecvError::Empty) => {}
            }
            if let Some(heard) = self.session.next()? {
                self.take_heard(heard);
            }
        }
    }

    fn take(&mut self, order: Order) -> anyhow::Result<()> {
        match order {
            Order::Arm(wish) => {
                let armed = self.plan(&wish).and_then(|plan| {
                    run::arm(self.session, &plan)?;
                    Ok(plan)
                });
                match armed {
                    Ok(plan) => {
                        self.show_samples();
                        self.show.set_up(plan.period_us);
                        self.is_set_up = true;
                        self.armed = Some(plan);
                        self.session.request(Request::Stream(true))?.ok();
                    }
                    Err(error) => {
                        self.tell(News::Problem(format!("{error:#}")));
                        self.look()?;
                    }
                }
            }
            Order::Run => match self.armed.take() {
                Some(plan) => self.record(plan)?,
                None => self.tell(News::Problem("arm the bench first".into())),
            },
            Order::ClearFault => {
                if let Err(refusal) = self.session.request(Request::ClearFault)? {
                    self.tell(News::Problem(format!("the fault stays: {refusal}")));
                } else if !self.is_set_up {
                    self.look()?;
                }
            }
            Order::Note(_) => self.tell(News::Problem("a note can be added while a recording runs".into())),
            Order::Connect(_)
            | Order::Disconnect
            | Order::Alarm(_)
            | Order::Record { .. }
            | Order::EndRecording => {}
        }
        Ok(())
    }

    fn plan(&self, wish: &link::Plan) -> anyhow::Result<Plan> {
        let period_us = (1e6 / wish.rate_hz).round() as u32;
        let mut metadata: BTreeMap<String, String> =
            [("profile".into(), wish.name.clone()), ("device".into(), self.device.clone())].into();
        if !wish.note.is_empty() {
            metadata.insert("note".into(), wish.note.clone());
        }
        let mut attachments: Vec<Attachment> = attachment("profile.toml", wish.signal.to_toml()).to_vec();
        attachments.extend(attachment("model.toml", self.model.clone()));
        attachments.extend(
            self.calibration_text.clone().into_iter().flat_map(|text| attachment("calibration.toml", text)),
        );
        Ok(Plan {
            profile: wish.signal.profile(period_us)?,
            calibration: self.calibration.clone(),
            period_us,
            path: wish.path.clone(),
            replace: false,
            metadata,
            attachments,
            start_unix_ns: now_unix_ns(),
        })
    }

    /// Runs the armed plan. An error is returned only if the link is broken.
    fn record(&mut self, mut plan: Plan) -> anyhow::Result<()> {
        let path = plan.path.clone();
        plan.start_unix_ns = now_unix_ns();
        // A stop that was pressed since Run is not forgotten: it ends the run at its beginning.
        self.tell(News::Began { path: path.clone(), planned_s: plan.planned_s() });
        let mut watcher = Watcher {
            presses: &self.own.presses,
            orders: &self.own.orders,
            news: &self.own.news,
            show: &mut self.show,
            has_begun: false,
            leaves: false,
        };
        let report = run::record_prepared(self.session, plan, &mut watcher);
        let leaves = watcher.leaves;
        self.own.presses.store(0, Ordering::SeqCst);
        let (text, well, broken) = match &report {
            Ok(report) => ended(&path, report),
            Err(error) => {
                // A file that could not be created leaves the bench armed.
                self.session.post(Request::Stop)?;
                (format!("{error:#}"), false, None)
            }
        };
        // The run has reported its fault; the board's next status names it again.
        self.is_faulty = report.is_ok_and(|report| matches!(report.end, End::Fault(_)));
        self.tell(News::Ended { path, text, well });
        if let Some(reason) = broken {
            bail!("{reason}");
        }
        if leaves {
            self.session.post(Request::Stream(false))?;
            bail!("disconnected; the run was stopped");
        }
        // The stream goes on at the run's rate, so that the picture has no gap at the run's end.
        Ok(())
    }
}
