//! The monitor: samples in, events out.

use std::{collections::VecDeque, sync::Arc};

use socam_model::Model;
use socam_recording::{Channel, Dataset};

use crate::{
    Alarm, Baseline, BlockSignals, Event, MonitorError, Overlay, OverlayChannel, Phase, Settings, Symptom,
    columns::{self, columns_of},
    cutter::{Block, Cutter},
    naming,
    sequential::{Largest, SequentialTest},
};

/// Monitors a bench by a model that runs beside it.
///
/// # Method
/// The samples are cut into blocks of [`Settings::block_s`]. The start state of the model is fitted to each block, and the model runs
/// freely over it from the measured inputs. Its residuals pass through the whitening filter of the baseline (the innovations form of
/// R. K. Mehra and J. Peschon, Automatica 7, 1971). Each block gives three kinds of statistics: mean and power of each channel's
/// innovations, and the score of each free parameter (the local approach of A. Benveniste, M. Basseville, G. Moustakides, IEEE Trans. AC
/// 32, 1987). Each statistic has a sequential test.
///
/// # Assumes
/// The baseline contains the motions that are monitored, and blocks of a healthy bench are alike but for noise and slow drift.
///
/// # Breaks when
/// A change shows in one block only (a single shock): no single block raises an alarm. A change that the start state of each block
/// absorbs (slower than a block, in a machine that nothing holds) is seen late or never.
#[derive(Debug)]
pub struct Monitor {
    model: Model,
    settings: Settings,
    /// Columns that the model reads, and their indices among the samples' values.
    channels: Vec<Channel>,
    indices: Vec<usize>,
    cutter: Cutter,
    /// Healthy blocks that are collected while there is no baseline.
    learned: Vec<Block>,
    active: Option<Active>,
    view: View,
}

/// A monitor with a baseline.
#[derive(Debug)]
struct Active {
    baseline: Baseline,
    tests: Vec<Option<SequentialTest>>,
    threshold: f64,
    /// Blocks of the window, judged or not, the oldest first.
    recent: VecDeque<Block>,
    standing: Option<Standing>,
}

/// An alarm that has not ended.
#[derive(Debug)]
struct Standing {
    alarm: Alarm,
    is_named: bool,
}

/// Data that is kept for views.
#[derive(Debug)]
struct View {
    channels: Arc<Vec<OverlayChannel>>,
    statistics: Arc<Vec<Symptom>>,
    blocks: VecDeque<Arc<BlockSignals>>,
    alarms: Vec<Alarm>,
    judged: usize,
    not_judged: usize,
}

impl Monitor {
    /// A monitor of samples with these channels. Without a baseline, the first [`Settings::learn_s`] of the samples are taken as healthy.
    ///
    /// # Errors
    /// When the model reads a channel that is not there, or a setting cannot be used.
    pub fn new(
        model: &Model,
        channels: &[Channel],
        baseline: Option<Baseline>,
        settings: Settings,
    ) -> Result<Self, MonitorError> {
        settings.check()?;
        columns::check_clocks(model)?;
        let (channels, indices) = columns_of(model, channels)?;
        let outputs = model.outputs().map(|o| OverlayChannel { name: o.name.clone(), unit: o.unit });
        let view = View {
            channels: Arc::new(outputs.collect()),
            statistics: Arc::default(),
            blocks: VecDeque::new(),
            alarms: Vec::new(),
            judged: 0,
            not_judged: 0,
        };
        let expected_s = baseline.as_ref().map(|baseline| baseline.meter.step_s);
        let block_s = baseline.as_ref().map_or(settings.block_s, |baseline| baseline.block_s);
        let cutter = Cutter::new(channels.len(), block_s, expected_s);
        let model = model.clone();
        let mut monitor =
            Self { model, settings, channels, indices, cutter, learned: Vec::new(), active: None, view };
        if let Some(baseline) = baseline {
            monitor.begin(baseline);
        }
        Ok(monitor)
    }

    fn begin(&mut self, baseline: Baseline) {
        self.view.statistics = Arc::new(baseline.meter.symptoms());
        self.active = Some(Active {
            tests: baseline.tests(),
            threshold: baseline.threshold(self.settings.false_alarms_per_hour),
            baseline,
            recent: VecDeque::new(),
            standing: None,
        });
    }

    /// Takes one sample: its time, s, and one value per channel, NaN where missing. A step in time of more than one and a half samples, or
    /// a step back, is a gap: the present block is dropped, and the next one begins after the gap with a start state of its own.
    ///
    /// # Errors
    /// When the model cannot be evaluated, or the rate differs from that of the baseline.
    pub fn push(&mut self, time_s: f64, values: &[f64]) -> Result<Vec<Event>, MonitorError> {
        let own = self.indices.iter().map(|index| values.get(*index).copied().unwrap_or(f64::NAN));
        match self.cutter.push(time_s, own)? {
            Some(block) => self.take(block),
            None => Ok(Vec::new()),
        }
    }

    /// Takes all samples of a recording with the channels of the monitor.
    ///
    /// # Errors
    /// The errors of [`Monitor::push`], and an error when the recording cannot be read.
    pub fn push_all(&mut self, recording: &Dataset) -> Result<Vec<Event>, MonitorError> {
        let (_, columns) = columns_of(&self.model, recording.channels())?;
        let mut events = Vec::new();
        columns::each_row(recording, &columns, |time_s, values| {
            if let Some(block) = self.cutter.push(time_s, values)? {
                events.extend(self.take(block)?);
            }
            Ok(())
        })?;
        Ok(events)
    }

    /// Ends the samples: names the causes of an alarm whose window is not full yet.
    ///
    /// # Errors
    /// The errors of [`Monitor::push`].
    pub fn finish(&mut self) -> Result<Vec<Event>, MonitorError> {
        let Some(active) = &mut self.active else { return Ok(Vec::new()) };
        let named = active.name(&self.settings, true)?;
        Ok(named.map(|alarm| self.view.renew(alarm)).into_iter().collect())
    }

    /// Takes a block.
    fn take(&mut self, block: Block) -> Result<Vec<Event>, MonitorError> {
        let Some(active) = &mut self.active else { return self.learn(block) };
        let measured = active.baseline.meter.measure(&block)?;
        let end_s = block.start_s + block.rows() as f64 * active.baseline.meter.step_s;
        let most = (self.settings.window_s / active.baseline.block_s).ceil() as usize;
        active.recent.push_back(block);
        // Blocks from before the alarm are kept, because the change may have begun earlier.
        while active.recent.len() > most {
            active.recent.pop_front();
        }
        let Some(mut measured) = measured else {
            self.view.not_judged += 1;
            return Ok(Vec::new());
        };
        if !active.baseline.covers(&measured) {
            self.view.not_judged += 1;
            self.view.show(Arc::new(measured.signals), most);
            return Ok(Vec::new());
        }
        self.view.judged += 1;
        let found = active.test(&measured.values);
        measured.signals.tests =
            found.iter().map(|one| one.map_or(0.0, |one| one.size / active.threshold)).collect();
        self.view.show(Arc::new(measured.signals), most);
        let mut events = Vec::new();
        match &mut active.standing {
            None => {
                let number = self.view.alarms.len() + 1;
                if let Some(alarm) = active.alarm(number, end_s, &found, &self.view) {
                    events.push(Event::Alarm(alarm.clone()));
                    self.view.keep(alarm.clone());
                    active.standing = Some(Standing { alarm, is_named: false });
                }
            }
            Some(standing) if active.tests.iter().flatten().all(SequentialTest::has_returned) => {
                events.push(Event::Returned { number: standing.alarm.number, time_s: end_s });
                active.standing = None;
                active.tests.iter_mut().flatten().for_each(SequentialTest::clear);
            }
            Some(_) => {}
        }
        let named = active.name(&self.settings, false)?;
        events.extend(named.map(|alarm| self.view.renew(alarm)));
        Ok(events)
    }

    /// Adds a healthy block; the baseline begins when there are enough.
    fn learn(&mut self, block: Block) -> Result<Vec<Event>, MonitorError> {
        self.learned.push(block);
        if (self.learned.len() as f64) * self.settings.block_s < self.settings.learn_s {
            return Ok(Vec::new());
        }
        let Some(step_s) = self.cutter.step_s() else { return Ok(Vec::new()) };
        let blocks = std::mem::take(&mut self.learned);
        let channels = self.channels.clone();
        let baseline = Baseline::of_blocks(&self.model, channels, step_s, &blocks, &self.settings)?;
        let summary = baseline.summary().clone();
        self.begin(baseline);
        Ok(vec![Event::Learned(summary)])
    }

    /// Number of blocks so far, judged or not.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.view.judged + self.view.not_judged
    }

    /// A snapshot for views.
    #[must_use]
    pub fn overlay(&self) -> Overlay {
        let phase = match &self.active {
            None => Phase::Learning {
                collected_s: self.learned.len() as f64 * self.settings.block_s,
                needed_s: self.settings.learn_s,
            },
            Some(active) if active.standing.is_some() => Phase::Alarmed,
            Some(_) => Phase::Watching,
        };
        Overlay {
            phase,
            channels: Arc::clone(&self.view.channels),
            statistics: Arc::clone(&self.view.statistics),
            blocks: self.view.blocks.iter().cloned().collect(),
            alarms: self.view.alarms.clone(),
            baseline: self.active.as_ref().map(|active| active.baseline.summary().clone()),
            judged: self.view.judged,
            not_judged: self.view.not_judged,
        }
    }
}

impl Active {
    /// Updates all tests by the statistics of a block.
    fn test(&mut self, values: &[f64]) -> Vec<Option<Largest>> {
        let each = self.tests.iter_mut().zip(values).map(|(test, value)| {
            let test = test.as_mut()?;
            test.push(*value);
            Some(test.largest())
        });
        each.collect()
    }

    /// The alarm of the test that exceeds its threshold most, if one does.
    fn alarm(&self, number: usize, time_s: f64, found: &[Option<Largest>], view: &View) -> Option<Alarm> {
        let sized = found.iter().enumerate().filter_map(|(k, one)| Some((k, (*one)?)));
        let (statistic, largest) = sized.clone().max_by(|a, b| a.1.size.total_cmp(&b.1.size))?;
        if largest.size <= self.threshold {
            return None;
        }
        let outputs = view.channels.len();
        let of_channels = sized.filter(|(k, _)| *k < 2 * outputs);
        let (changed, _) = of_channels.max_by(|a, b| a.1.size.total_cmp(&b.1.size))?;
        Some(Alarm {
            number,
            time_s,
            onset_s: time_s - largest.blocks as f64 * self.baseline.block_s,
            symptom: view.statistics[statistic].clone(),
            channel: view.channels[changed % outputs].name.clone(),
            size_sigma: largest.mean,
            naming: None,
        })
    }

    /// The standing alarm with the causes of its change, once its window is full or the samples have ended.
    fn name(&mut self, settings: &Settings, is_over: bool) -> Result<Option<Alarm>, MonitorError> {
        let Some(standing) = &mut self.standing else { return Ok(None) };
        if standing.is_named {
            return Ok(None);
        }
        let onset_s = standing.alarm.onset_s - 0.5 * self.baseline.block_s;
        let after: Vec<&Block> = self.recent.iter().filter(|block| block.start_s >= onset_s).collect();
        let is_full = (after.len() + 1) as f64 * self.baseline.block_s > settings.window_s
            || after.len() == self.recent.len();
        if after.is_empty() || !(is_full || is_over) {
            return Ok(None);
        }
        standing.is_named = true;
        standing.alarm.naming = naming::name(&self.baseline.meter, &after)?;
        Ok(Some(standing.alarm.clone()))
    }
}

impl View {
    fn show(&mut self, signals: Arc<BlockSignals>, most: usize) {
        self.blocks.push_back(signals);
        while self.blocks.len() > most {
            self.blocks.pop_front();
        }
    }

    fn keep(&mut self, alarm: Alarm) {
        if self.alarms.len() < Overlay::MOST_ALARMS {
            self.alarms.push(alarm);
        }
    }

    /// Replaces an alarm by one with the same number and its causes.
    fn renew(&mut self, alarm: Alarm) -> Event {
        if let Some(known) = self.alarms.iter_mut().find(|known| known.number == alarm.number) {
            *known = alarm.clone();
        }
        Event::Named(alarm)
    }
}
