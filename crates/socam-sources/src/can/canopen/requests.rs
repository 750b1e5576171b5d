//! What a question to a drive that is commanded carries beside the objects that are recorded.

use std::collections::VecDeque;

use super::messages::{Answer, commands_node, download, is_heartbeat_of, upload};
use super::place::Place;

/// Error code of CiA 402.
pub(super) const ERROR_CODE: Place = (0x603f, 0);

/// One transfer of SDO.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Request {
    Read(Place),
    Write(Place, Vec<u8>),
}

impl Request {
    pub(super) fn line(&self, node: u8) -> Vec<u8> {
        match self {
            Self::Read(place) => upload(node, *place),
            Self::Write(place, bytes) => download(node, *place, bytes),
        }
    }

    /// Whether an answer is one to it.
    fn fits(&self, answer: &Answer) -> bool {
        match (self, answer) {
            (Self::Read(place), Answer::Value(other, _) | Answer::Abort(other, _) | Answer::Long(other))
            | (Self::Write(place, _), Answer::Done(other) | Answer::Abort(other, _)) => place == other,
            (Self::Read(_), Answer::Done(_)) | (Self::Write(..), Answer::Value(..) | Answer::Long(_)) => {
                false
            }
        }
    }
}

/// Requests of a drive that is commanded, and what is known of it by them.
#[derive(Debug, Default)]
pub(super) struct Requests {
    /// Whether the drive is commanded at all.
    pub(super) is_commanded: bool,
    /// What the next question begins with: a heartbeat, or nothing.
    pub(super) heartbeat: Vec<u8>,
    /// Requests of the next question.
    pub(super) next: Vec<Request>,
    /// Those of the present question without an answer so far.
    queue: VecDeque<Request>,
    /// Answers since the last row.
    pub(super) replies: Vec<(Request, Answer)>,
    /// Its statusword, and its error code while it is in a fault.
    pub(super) word: Option<u16>,
    pub(super) error_code: Option<u16>,
    /// Number of this computer on the bus.
    pub(super) own_node: u8,
    /// What another program on the bus was heard to do that it must not, in words.
    pub(super) rival: Option<String>,
    /// Whether a fault is part of the trial of its heartbeat.
    pub(super) is_tried: bool,
}

impl Requests {
    /// A frame of another node; returns what it must not do, when it does so first.
    pub(super) fn heard(&mut self, id: u32, bytes: &[u8], node: u8) -> Option<String> {
        if !self.is_commanded || self.rival.is_some() {
            return None;
        }
        let own = self.own_node;
        self.rival = if is_heartbeat_of(id, own) {
            Some(format!(
                "another program on the bus sends the heartbeat of node {own}, which is that of this computer: name another `heartbeat_node`"
            ))
        } else {
            commands_node(id, bytes, node).then(|| "another program on the bus commands this drive".into())
        };
        self.rival.clone()
    }

    /// A question begins.
    pub(super) fn begin(&mut self) {
        self.queue = self.next.iter().cloned().collect();
        self.replies.clear();
    }

    /// The request whose answer is waited for, or that leaves next.
    pub(super) fn front(&self) -> Option<&Request> {
        self.queue.front()
    }

    /// Takes the answer to the first of them; `false` if it is none.
    pub(super) fn take(&mut self, answer: &Answer) -> bool {
        let Some(request) = self.queue.pop_front_if(|request| request.fits(answer)) else { return false };
        if let (Request::Read(ERROR_CODE), answer) = (&request, answer) {
            self.error_code = Some(answer.number().unwrap_or(0) as u16);
        }
        self.replies.push((request, answer.clone()));
        true
    }

    /// The drive stated its statusword; the code of a fault is asked for.
    pub(super) fn stated(&mut self, word: u16, is_fault: bool) {
        self.word = Some(word);
        if !is_fault {
            self.error_code = None;
        } else if self.is_commanded && self.error_code.is_none() {
            self.queue.push_back(Request::Read(ERROR_CODE));
        }
    }

    /// The link broke.
    pub(super) fn interrupted(&mut self) {
        self.queue.clear();
        self.replies.clear();
    }
}
