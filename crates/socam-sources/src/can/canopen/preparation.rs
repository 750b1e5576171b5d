//! What a drive is told before it moves, and the trial of its heartbeat consumer: enabled at speed 0 it is left without the heartbeat of this
//! computer, and must state in time that it is enabled no longer.

use super::commands::Marked;
use super::control::{CONTROLWORD, State};
use super::messages::{Answer, abort_text};
use super::place::written;
use super::requests::Request;
use super::settings::{CONSUMER, CONSUMER_SHARE, Setting, TARGET, purpose, settings};
use crate::drive::Limits;

/// It must not react before this share of its own time: then something else stopped it.
const EARLIEST_SHARE: f64 = 0.9;
/// Longest time until it is enabled, ns, and how often a setting is read back.
const ENABLED_WITHIN_NS: i64 = 1_000_000_000;
const READ_BACK: u32 = 10;
/// How often its heartbeat is tried where answers came too late to say when it reacted.
const TRIALS: u32 = 4;

/// How far the preparation is.
#[derive(Debug, Clone, PartialEq)]
enum Stage {
    Idle,
    Reading(usize),
    Writing(usize, u32),
    /// `is_tried`: its heartbeat consumer was seen to act.
    Enabling {
        since_ns: i64,
        is_tried: bool,
    },
    /// No heartbeat leaves; the last one left and had arrived at these times, ns.
    Silent {
        sent_ns: i64,
        arrived_ns: i64,
    },
    Ready,
    Failed(String),
}

/// The preparation of a drive.
#[derive(Debug)]
pub(super) struct Preparation {
    settings: Vec<Setting>,
    stage: Stage,
    own_node: u8,
    watchdog_s: f64,
    /// How often its heartbeat was tried.
    trials: u32,
}

/// What an answer says, for the preparation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stated {
    pub(super) state: State,
    /// When it was asked for, and arrived, ns.
    pub(super) asked_ns: i64,
    pub(super) arrival_ns: i64,
    /// When the last heartbeat left, ns.
    pub(super) beat_ns: i64,
}

impl Preparation {
    /// That of a drive whose list is marked like this; `effort_factor`: torque or current of one count.
    pub(super) fn new(marked: &Marked, limits: &Limits, effort_factor: f64) -> Self {
        let settings = settings(marked, limits, effort_factor);
        Self {
            settings,
            stage: Stage::Idle,
            own_node: marked.own_node,
            watchdog_s: limits.watchdog_s,
            trials: 0,
        }
    }

    /// Begins, unless it has begun.
    pub(super) fn begin(&mut self) {
        if self.stage == Stage::Idle {
            self.stage = Stage::Reading(0);
        }
    }

    pub(super) fn is_ready(&self) -> bool {
        self.stage == Stage::Ready
    }

    /// Why the drive must not be commanded.
    pub(super) fn failed(&self) -> Option<&str> {
        if let Stage::Failed(why) = &self.stage { Some(why) } else { None }
    }

    /// Whether the drive may be enabled by this program, at speed 0.
    pub(super) fn is_enabling(&self) -> bool {
        !matches!(self.stage, Stage::Idle | Stage::Reading(_) | Stage::Writing(..))
    }

    /// Whether a heartbeat leaves with each question.
    pub(super) fn beats(&self) -> bool {
        !matches!(self.stage, Stage::Idle | Stage::Silent { .. })
    }

    /// Whether a fault is part of the trial.
    pub(super) fn expects_fault(&self) -> bool {
        match self.stage {
            Stage::Silent { .. } => true,
            Stage::Enabling { .. } => self.trials > 0,
            _ => false,
        }
    }

    /// What the next question carries.
    pub(super) fn requests(&self, state: State) -> Vec<Request> {
        match self.stage {
            Stage::Reading(index) => vec![Request::Read(self.settings[index].place)],
            Stage::Writing(index, 0) => {
                let setting = &self.settings[index];
                vec![setting.write(setting.want), Request::Read(setting.shown)]
            }
            Stage::Writing(index, _) => vec![Request::Read(self.settings[index].shown)],
            Stage::Enabling { .. } => state.towards_operation().iter().map(|word| control(*word)).collect(),
            Stage::Idle | Stage::Silent { .. } | Stage::Ready | Stage::Failed(_) => Vec::new(),
        }
    }

    /// What puts the settings back, but for the target, which stays 0; the heartbeat that it waits for comes last.
    pub(super) fn release(&self) -> Vec<Request> {
        let is_put_back = |setting: &&Setting| setting.is_changed() && setting.place != TARGET;
        let changed = self.settings.iter().rev().filter(is_put_back);
        let back = changed.filter_map(|setting| Some(setting.write(setting.before?)));
        let is_told = self.stage != Stage::Idle;
        is_told.then(|| target(0)).into_iter().chain(back).collect()
    }

    /// The drive has answered to requests.
    pub(super) fn take(&mut self, replies: &[(Request, Answer)], stated: Stated) {
        let next = match self.stage {
            Stage::Reading(index) => self.was_read(index, replies, stated),
            Stage::Writing(index, times) => self.was_written(index, times, replies, stated),
            Stage::Enabling { since_ns, is_tried } => self.enables(since_ns, is_tried, stated),
            Stage::Silent { sent_ns, arrived_ns } => self.is_silent(sent_ns, arrived_ns, stated),
            Stage::Idle | Stage::Ready | Stage::Failed(_) => None,
        };
        if let Some(stage) = next {
            self.stage = stage;
        }
    }

    fn was_read(&mut self, index: usize, replies: &[(Request, Answer)], stated: Stated) -> Option<Stage> {
        let own_node = self.own_node;
        let setting = &mut self.settings[index];
        let (_, answer) = replies.iter().find(|(request, _)| *request == Request::Read(setting.place))?;
        let Some(value) = answer.number() else {
            let why =
                if let Answer::Abort(_, code) = answer { abort_text(*code) } else { "it is too long".into() };
            let use_text = purpose(setting.place);
            return Some(Stage::Failed(format!(
                "the drive does not give {} ({use_text}), so it is not commanded: {why}",
                written(setting.place)
            )));
        };
        let watched = (value >> 16) as u8;
        if setting.place == CONSUMER && value & 0xffff != 0 && watched != 0 && watched != own_node {
            return Some(Stage::Failed(format!(
                "the drive waits for the heartbeat of node {watched} already (1016:01), so it is not commanded: end that master, or set 1016:01 to 0"
            )));
        }
        setting.before = Some(value);
        if setting.is_limit {
            setting.want = setting.want.min(value);
        }
        if setting.want == 0 && setting.is_limit {
            return Some(Stage::Failed(format!(
                "the limit in {} is 0: it lets nothing move",
                written(setting.place)
            )));
        }
        // The mode is written in any case, because another object shows what became of it.
        let is_due = setting.is_changed() || setting.place != setting.shown;
        Some(if is_due { Stage::Writing(index, 0) } else { self.after(index, stated) })
    }

    fn was_written(
        &self,
        index: usize,
        times: u32,
        replies: &[(Request, Answer)],
        stated: Stated,
    ) -> Option<Stage> {
        let setting = &self.settings[index];
        let name = written(setting.place);
        let refused = replies.iter().find_map(|(request, answer)| match (request, answer) {
            (Request::Write(..), Answer::Abort(_, code)) => Some(*code),
            _ => None,
        });
        if let Some(code) = refused {
            return Some(Stage::Failed(format!(
                "the drive does not take {name} ({}), so it is not commanded: {}",
                purpose(setting.place),
                abort_text(code)
            )));
        }
        let (_, answer) = replies.iter().find(|(request, _)| *request == Request::Read(setting.shown))?;
        let mask = u32::MAX >> (32 - 8 * setting.width);
        match answer.number() {
            Some(value) if value == setting.want & mask => Some(self.after(index, stated)),
            Some(_) if times < READ_BACK => Some(Stage::Writing(index, times + 1)),
            value => Some(Stage::Failed(format!(
                "the drive was told {} in {name} ({}) and states {} in {}, so it is not commanded",
                setting.want,
                purpose(setting.place),
                value.map_or_else(|| "nothing".into(), |value| value.to_string()),
                written(setting.shown)
            ))),
        }
    }

    /// The stage after a setting.
    fn after(&self, index: usize, stated: Stated) -> Stage {
        if index + 1 < self.settings.len() {
            Stage::Reading(index + 1)
        } else {
            Stage::Enabling { since_ns: stated.arrival_ns, is_tried: false }
        }
    }

    fn enables(&self, since_ns: i64, is_tried: bool, stated: Stated) -> Option<Stage> {
        let failed = |why: &str| Some(Stage::Failed(format!("{why}, so it is not commanded")));
        match stated.state {
            State::Enabled if is_tried => Some(Stage::Ready),
            State::Enabled => Some(Stage::Silent { sent_ns: stated.beat_ns, arrived_ns: stated.arrival_ns }),
            State::Fault if self.trials == 0 => failed("the drive is in a fault as it is enabled"),
            _ if stated.arrival_ns - since_ns > ENABLED_WITHIN_NS => {
                failed("the drive does not become enabled by its controlword (6040)")
            }
            _ => None,
        }
    }

    fn is_silent(&mut self, sent_ns: i64, arrived_ns: i64, stated: Stated) -> Option<Stage> {
        let most_ns = (self.watchdog_s * 1e9) as i64;
        let least_ns = (most_ns as f64 * CONSUMER_SHARE * EARLIEST_SHARE) as i64;
        if stated.state == State::Enabled {
            return (stated.asked_ns - arrived_ns > most_ns).then(|| {
                Stage::Failed(format!(
                    "the drive was still enabled {} s after the last heartbeat of this computer, so it is not commanded: see what 1016:01 and 6007 do in its manual",
                    self.watchdog_s
                ))
            });
        }
        let since_s = (stated.arrival_ns - sent_ns) as f64 * 1e-9;
        if stated.arrival_ns - sent_ns < least_ns {
            return Some(Stage::Failed(format!(
                "the drive was no longer enabled {since_s:.3} s after the last heartbeat, before its time of {} s: something else stopped it, so it is not commanded",
                self.watchdog_s * CONSUMER_SHARE
            )));
        }
        // An answer that came late does not say when the drive reacted.
        let is_tried = stated.arrival_ns - sent_ns <= most_ns;
        self.trials += 1;
        if !is_tried && self.trials >= TRIALS {
            return Some(Stage::Failed(format!(
                "the drive did not state within {} s of the last heartbeat that it reacted, in {TRIALS} trials, so it is not commanded: its answers are too slow, or this computer is too busy",
                self.watchdog_s
            )));
        }
        Some(Stage::Enabling { since_ns: stated.arrival_ns, is_tried })
    }
}

/// The request of a controlword.
pub(super) fn control(word: u16) -> Request {
    Request::Write(CONTROLWORD, word.to_le_bytes().to_vec())
}

/// The request of a target velocity, counts.
pub(super) fn target(counts: i32) -> Request {
    Request::Write(TARGET, counts.to_le_bytes().to_vec())
}
