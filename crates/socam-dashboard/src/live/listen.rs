//! What the live view learns from the thread that talks to the board.

use std::sync::Arc;

use super::buffer::Buffer;
use super::run::Run;
use super::{Happening, Link, Live, News};

impl Live {
    /// Processes the news and samples that have arrived.
    pub fn listen(&mut self) {
        let Some(port) = &self.port else { return };
        let mut is_closed = false;
        // News first: they name the channels of the samples.
        let news: Vec<News> = port.news.try_iter().collect();
        self.fresh = port.samples.take().into_iter().map(Arc::new).collect();
        let mut ended = None;
        for one in news {
            match one {
                News::Connected { board, channels, limits } => {
                    if self.buffer.channels() != channels {
                        self.buffer = Buffer::new(channels);
                    }
                    self.limits = limits;
                    self.link = Link::Open { board };
                }
                News::Status(health) => self.health = Some(health),
                News::Began { path, planned_s } => self.run = Some(Run::new(path, planned_s)),
                News::Ended { path, text, well } => ended = Some((path, text, well)),
                News::Event(event) => self.take_event(event),
                News::Problem(sentence) => self.problem = Some(sentence),
                News::Disconnected(sentence) => {
                    self.problem = sentence.or(self.problem.take());
                    is_closed = true;
                }
            }
        }
        self.fresh.iter().for_each(|batch| self.buffer.take(batch));
        if let Some(run) = &mut self.run {
            run.follow(&self.buffer);
        }
        if let Some((path, text, well)) = ended {
            self.run.get_or_insert_with(|| Run::new(path, 0.0)).end = Some((text, well));
        }
        if is_closed {
            (self.link, self.health, self.port) = (Link::Closed, None, None);
        }
    }

    fn take_event(&mut self, event: Happening) {
        if event.kind == "start"
            && let Some(run) = &mut self.run
        {
            run.begin(event.time_s);
        }
        let from_s = self.buffer.start_s();
        self.events.retain(|event| event.time_s >= from_s);
        self.events.push(event);
    }
}
