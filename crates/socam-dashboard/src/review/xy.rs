//! One channel over another, coloured by time.

use std::ops::Range;
use std::sync::Arc;

use egui::{Rect, Ui, UiBuilder};

use super::content::having;
use super::{Drawing, Review};
use crate::progress::wake;
use socam_chart::chart::{Backdrop, Chart, range_of};
use socam_chart::colours::Colours;
use socam_chart::xy::{Cloud, Thinner};
use socam_samples::Samples;
use socam_workbench::arrangement::Plot;
use socam_workbench::computed::Computed;
use socam_workbench::job::Handle;
use socam_workbench::signal::Signal;

/// Height of the row in which the channels are chosen, points.
const HEAD: f32 = 26.0;
/// Rows that are read at a time.
const BLOCK: usize = 1 << 16;
/// Greatest number of rows of a picture.
const MOST_ROWS: usize = 20_000_000;

/// Inputs on which the dots depend: the samples, channels, delays, rows, ranges of the axes, size.
#[derive(Clone, PartialEq)]
struct Key {
    of: Vec<Of>,
    ranges: [[f64; 2]; 2],
    cells: [usize; 2],
}

/// A recording's part in the picture.
#[derive(Clone)]
struct Of {
    y: (Arc<Samples>, usize),
    x: (Arc<Samples>, usize),
    /// Factors from SI to the units of the axes, horizontal and vertical.
    per_si: [f64; 2],
    shift_s: f64,
    rows: Range<usize>,
}

impl PartialEq for Of {
    fn eq(&self, other: &Self) -> bool {
        let same =
            |a: &(Arc<Samples>, usize), b: &(Arc<Samples>, usize)| Arc::ptr_eq(&a.0, &b.0) && a.1 == b.1;
        same(&self.y, &other.y)
            && same(&self.x, &other.x)
            && (self.shift_s, self.per_si) == (other.shift_s, other.per_si)
            && self.rows == other.rows
    }
}

/// State of a tile.
#[derive(Debug, Default)]
pub(super) struct Xy {
    dots: Computed<Key, Vec<[f64; 3]>>,
    /// Ranges that the user set, horizontal and vertical.
    ranges: Option<[[f64; 2]; 2]>,
}

impl Xy {
    pub(super) fn poll(&mut self) {
        self.dots.poll();
    }

    pub(super) fn is_busy(&self) -> bool {
        self.dots.is_busy()
    }
}

impl Review {
    pub(super) fn xy(
        &mut self,
        ui: &mut Ui,
        drawing: &mut Drawing<'_>,
        (y, x): (&mut Signal, &mut Signal),
        (rect, tile): (Rect, u64),
    ) {
        let mut head = ui.new_child(UiBuilder::new().max_rect(rect.with_max_y(rect.top() + HEAD)));
        head.horizontal(|ui| {
            super::choose_signal(ui, (tile, "y"), "vertical axis", y, drawing.signals);
            ui.label("over");
            super::choose_signal(ui, (tile, "x"), "horizontal axis", x, drawing.signals);
        });
        let mut state = self.xy.remove(&tile).unwrap_or_default();
        let mut part = ui.new_child(UiBuilder::new().max_rect(rect.with_min_y(rect.top() + HEAD)));
        let plot = Plot::Xy { y: y.clone(), x: x.clone() };
        let mut chart = Chart::new(
            ("xy", tile),
            format!("{}, {}", plot.title(), self.units.of(y).unit),
            part.max_rect().size(),
        );
        chart.x_label = self.units.label(x);
        let of = self.of(drawing, y, x);
        [chart.x, chart.y] = state.ranges.unwrap_or_else(|| ranges(&chart, &of));
        chart.when_empty = "no recording that is shown has both channels here";
        let key = Key {
            ranges: [chart.x, chart.y],
            cells: [rect.width() as usize / 2, rect.height() as usize / 2],
            of,
        };
        let work = key.clone();
        match state.dots.get(&wake(ui.ctx()), &key, move |handle| dots(&work, handle)) {
            Some((_, Ok(dots))) if !dots.is_empty() => {
                let colours = Colours::of_dots(ui, drawing.x, "time, s");
                chart.backdrop = Some(Backdrop::Cloud(Cloud { dots: dots.clone(), colours }));
            }
            Some((_, Err(_))) => chart.when_empty = "more than 20 million samples are shown: zoom in",
            _ => {}
        }
        let shown = drawing.show(&mut part, chart);
        if shown.response.double_clicked() {
            state.ranges = None;
        } else if shown.x_moved || shown.y_moved {
            state.ranges = Some([shown.x, shown.y]);
        }
        self.xy.insert(tile, state);
    }

    /// The recordings that have both channels; only the highlighted one, if there is one.
    fn of(&self, drawing: &Drawing<'_>, y: &Signal, x: &Signal) -> Vec<Of> {
        let mut all = Vec::new();
        for (entry, samples, channel) in having(drawing.entries, y, None) {
            let Some((x_samples, x_channel)) = entry.find(x) else { continue };
            if self.lit.is_some_and(|lit| lit != entry.number) {
                continue;
            }
            let rows = samples.row_at(drawing.x[0] - entry.shift_s)
                ..samples.row_at((drawing.x[1] - entry.shift_s).next_up());
            all.push(Of {
                y: (samples.clone(), channel),
                x: (x_samples.clone(), x_channel),
                per_si: [x, y].map(|signal| self.units.of(signal).per_si),
                shift_s: entry.shift_s,
                rows,
            });
        }
        all
    }
}

/// Ranges of the axes that show all dots.
fn ranges(chart: &Chart, of: &[Of]) -> [[f64; 2]; 2] {
    let extremes = |of: &Of, (samples, channel): &(Arc<Samples>, usize), per_si: f64| {
        samples.extremes(*channel, of.rows.clone()).map(|both| both.map(|value| per_si * value))
    };
    let x = range_of(of.iter().filter_map(|own| extremes(own, &own.x, own.per_si[0])).flatten());
    let y = range_of(of.iter().filter_map(|own| extremes(own, &own.y, own.per_si[1])).flatten());
    [x.map_or([0.0, 1.0], socam_chart::chart::with_room), chart.fitted(y)]
}

fn dots(key: &Key, handle: &Handle) -> Result<Vec<[f64; 3]>, String> {
    let total: usize = key.of.iter().map(|of| of.rows.len()).sum();
    if total > MOST_ROWS {
        return Err(format!("{total} samples"));
    }
    let mut thinner = Thinner::new(key.ranges, key.cells);
    for of in &key.of {
        let mut from = of.rows.start;
        while from < of.rows.end {
            handle.reached(0.0)?;
            let block = from..(from + BLOCK).min(of.rows.end);
            from = block.end;
            let times = of.y.0.times(block.clone());
            let (x, y) = (of.x.0.values(of.x.1, block.clone()), of.y.0.values(of.y.1, block));
            for ((time, x), y) in times.into_iter().zip(x).zip(y) {
                thinner.push([of.per_si[0] * x, of.per_si[1] * y, time + of.shift_s]);
            }
        }
    }
    Ok(thinner.dots())
}
