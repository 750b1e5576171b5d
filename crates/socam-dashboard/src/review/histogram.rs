//! The tile of a histogram: how often values of a channel occur in the range in sight, per recording.

use std::ops::Range;
use std::sync::Arc;

use egui::{Rect, RichText, Ui, UiBuilder};

use super::content::having;
use super::rows::text_of;
use super::{Drawing, Review};
use crate::progress::wake;
use socam_chart::chart::{Chart, Curve, range_of, with_room};
use socam_chart::swatch::swatch;
use socam_chart::theme;
use socam_samples::{Samples, stats};
use socam_workbench::computed::Computed;
use socam_workbench::display_units::ShownIn;
use socam_workbench::histogram::Histogram;
use socam_workbench::job::Handle;
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;

/// Height of the row in which the channel is chosen, and of each line of numbers, points.
const HEAD: f32 = 26.0;
const LINE: f32 = 17.0;
/// Recordings of which mean and standard deviation are said; the table of statistics has all.
const SAID: usize = 3;
/// Number of bins: those of more look torn, those of fewer hide two peaks.
const BINS: usize = 60;

/// Inputs on which the counts depend.
#[derive(Clone)]
struct Key {
    of: Vec<(Arc<Samples>, usize, Range<usize>)>,
    /// Least and greatest value of all recordings, SI.
    range: [f64; 2],
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        self.range == other.range
            && self.of.len() == other.of.len()
            && self
                .of
                .iter()
                .zip(&other.of)
                .all(|(a, b)| Arc::ptr_eq(&a.0, &b.0) && (a.1, &a.2) == (b.1, &b.2))
    }
}

/// State of a tile.
#[derive(Debug, Default)]
pub(super) struct Counted {
    counts: Computed<Key, Vec<Histogram>>,
    /// Ranges that the user set, horizontal and vertical.
    ranges: Option<[[f64; 2]; 2]>,
}

impl Counted {
    pub(super) fn poll(&mut self) {
        self.counts.poll();
    }

    pub(super) fn is_busy(&self) -> bool {
        self.counts.is_busy()
    }
}

impl Review {
    pub(super) fn histogram(
        &mut self,
        ui: &mut Ui,
        drawing: &mut Drawing<'_>,
        signal: &mut Signal,
        (rect, tile): (Rect, u64),
    ) {
        let shown_in = self.units.of(signal);
        let having = having(drawing.entries, signal, self.lit);
        let said = having.len().min(SAID) + usize::from(having.len() > SAID);
        let top = rect.top() + HEAD + LINE * said as f32;
        let mut head = ui.new_child(UiBuilder::new().max_rect(rect.with_max_y(top)));
        head.spacing_mut().item_spacing.y = 0.0;
        head.horizontal(|ui| {
            super::choose_signal(ui, (tile, "histogram"), "histogram of", signal, drawing.signals);
        });
        let mut key = Key { of: Vec::new(), range: [0.0; 2] };
        for (number, (entry, samples, channel)) in having.iter().enumerate() {
            let seconds = drawing.x.map(|x| x - entry.shift_s);
            let rows = samples.row_at(seconds[0])..samples.row_at(seconds[1].next_up());
            if number < SAID {
                let name = short(&entry.recording.about.name);
                said_of(&mut head, (entry.number, name), (samples, *channel), seconds, &shown_in);
            }
            key.of.push(((*samples).clone(), *channel, rows));
        }
        if having.len() > SAID {
            let text = format!("and {} more: see the table of statistics (T)", having.len() - SAID);
            head.label(RichText::new(text).small().color(theme::weak(ui)));
        }
        let extremes =
            key.of.iter().filter_map(|(samples, channel, rows)| samples.extremes(*channel, rows.clone()));
        key.range = range_of(extremes.flatten()).unwrap_or([0.0, 1.0]);
        let mut state = self.histograms.remove(&tile).unwrap_or_default();
        let mut part = ui.new_child(UiBuilder::new().max_rect(rect.with_min_y(top)));
        let title = format!("share of the samples of {}, %", signal.name);
        let mut chart = Chart::new(("histogram", tile), title, part.max_rect().size());
        chart.x_label = self.units.label(signal);
        chart.when_empty = "no value here";
        let work = key.clone();
        match state.counts.get(&wake(ui.ctx()), &key, move |handle| count(&work, handle)) {
            Some((of, Ok(counts))) if of.of.len() == having.len() => {
                for (histogram, (entry, ..)) in counts.iter().zip(&having) {
                    chart.curves.push(Curve {
                        name: entry.recording.about.name.clone(),
                        colour: super::content::colour(ui, entry, self.lit, having.len()),
                        parts: vec![histogram.outline(shown_in.per_si)],
                        style: theme::style(entry.number),
                    });
                }
            }
            Some((_, Err(_))) => chart.when_empty = "more than 50 million samples are in sight: zoom in",
            _ => {}
        }
        let highest =
            chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
        let fitted = chart.fitted(range_of(highest.chain([0.0])).filter(|range| range[1] > 0.0));
        let across = with_room(key.range.map(|value| value * shown_in.per_si));
        [chart.x, chart.y] = state.ranges.unwrap_or([across, [0.0, fitted[1]]]);
        let shown = drawing.show(&mut part, chart);
        if shown.response.double_clicked() {
            state.ranges = None;
        } else if shown.x_moved || shown.y_moved {
            state.ranges = Some([shown.x, shown.y]);
        }
        self.histograms.insert(tile, state);
    }
}

/// Mean, standard deviation and number of the values of one recording.
fn said_of(
    ui: &mut Ui,
    (number, name): (usize, &str),
    (samples, channel): (&Samples, usize),
    range: [f64; 2],
    ShownIn { unit, per_si }: &ShownIn,
) {
    ui.horizontal(|ui| {
        ui.set_height(LINE);
        swatch(ui, number, name);
        let said = match stats(samples, channel, range) {
            Some(stats) => format!(
                "{name}: mean {} {unit}, std {} {unit}, {} samples",
                beside(per_si * stats.mean, per_si * stats.std),
                text_of(Some(per_si * stats.std)),
                stats.count
            ),
            None => format!("{name}: no value here"),
        };
        ui.add(egui::Label::new(RichText::new(said).small()).truncate());
    });
}

/// A mean with as many decimals as its deviation has: those beyond are rounding.
fn beside(mean: f64, std: f64) -> String {
    let decimals = 5.0 - std.log10().floor();
    if std > 0.0 && (0.0..=9.0).contains(&decimals) {
        let text = format!("{mean:.*}", decimals as usize);
        return if text.trim_matches(['-', '0', '.']).is_empty() { text.replace('-', "") } else { text };
    }
    text_of(Some(mean))
}

fn count(key: &Key, handle: &Handle) -> Result<Vec<Histogram>, String> {
    let of = |(samples, channel, rows): &(Arc<Samples>, usize, Range<usize>)| {
        Histogram::new((samples, *channel), rows.clone(), (key.range, BINS), handle)
    };
    key.of.iter().map(of).collect()
}
