//! A plot over time.

use egui::{Rect, Ui};

use super::content::{self, Frame};
use super::{Drawing, Review, difference};
use socam_chart::chart::{Chart, Curve, Flag, Right, Shown, range_of};
use socam_workbench::arrangement::Plot;
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;

impl Review {
    /// Draws channels over time in a part of the window.
    pub(super) fn over_time(
        &mut self,
        ui: &mut Ui,
        drawing: &mut Drawing<'_>,
        signals: &[Signal],
        (rect, has_axis): (Rect, bool),
    ) {
        let chart = self.chart_over_time(ui, drawing, signals, (rect, has_axis));
        let before = (chart.y, chart.right.clone());
        let shown = drawing.show(ui, chart);
        self.linked.take(&shown);
        let name = self.plot_name(signals);
        match self.own_x.iter_mut().find(|(known, _)| *known == name) {
            Some((_, own)) if shown.x_moved => *own = shown.x,
            Some(_) if !shown.response.double_clicked() => {}
            _ => self.take_x(&shown),
        }
        if shown.y_moved && !shown.response.double_clicked() {
            let right = before.1.map(|right| (of_right(&name), right.moved(before.0, shown.y)));
            for (name, y) in std::iter::once((name, shown.y)).chain(right) {
                self.y.retain(|(known, _)| *known != name);
                self.y.push((name, y));
            }
        }
    }

    /// Takes what the user did with the time axis of a chart.
    pub(super) fn take_x(&mut self, shown: &Shown) {
        if shown.response.double_clicked() {
            self.fit();
            return;
        }
        if shown.response.clicked()
            && let (Some(cursors), Some(at)) = (&mut self.cursors, shown.pointer_x)
        {
            cursors[self.next % 2] = at;
            self.next += 1;
        }
        if shown.x_moved {
            self.x = Some(shown.x);
        }
    }

    /// Whether a plot has a time axis of its own.
    pub(super) fn is_unlinked(&self, signals: &[Signal]) -> bool {
        self.own_x_of(&self.plot_name(signals)).is_some()
    }

    /// The time axis of its own that the plot of this name has, s.
    fn own_x_of(&self, name: &str) -> Option<[f64; 2]> {
        self.own_x.iter().find(|(known, _)| known == name).map(|(_, x)| *x)
    }

    /// Gives a plot a time axis of its own, which begins as that of all others, or links it with them again.
    pub(super) fn toggle_link(&mut self, signals: &[Signal], x: [f64; 2]) {
        let name = self.plot_name(signals);
        if self.own_x_of(&name).is_some() {
            self.own_x.retain(|(known, _)| *known != name);
        } else {
            self.own_x.push((name, x));
        }
    }

    /// Name by which a plot's axes are kept: it is another one in another unit.
    fn plot_name(&self, signals: &[Signal]) -> String {
        let title = Plot::Time(signals.to_vec()).title();
        let unit = content::axis(signals, &self.units).unit;
        if signals.first().is_some_and(|first| first.unit != unit) {
            format!("{title}, {unit}")
        } else {
            title
        }
    }

    /// Curves, or differences to the reference, with gaps, events and cursors.
    fn chart_over_time(
        &self,
        ui: &Ui,
        drawing: &Drawing<'_>,
        signals: &[Signal],
        (rect, has_axis): (Rect, bool),
    ) -> Chart {
        let entries = drawing.entries;
        let plot = self.plot_name(signals);
        let x = self.own_x_of(&plot).unwrap_or(drawing.x);
        let (signals, left) = content::by_axis(signals);
        let sides = [&signals[..left], &signals[left..]];
        let signals = &signals[..];
        let title = content::title(signals, drawing.signals, &self.units);
        let mut chart = Chart::new(("review", &plot), title, rect.size());
        chart.when_empty = "no value here";
        (chart.stack, chart.leaves_room) = (Some(super::stack()), drawing.leaves_room(rect));
        chart.x = x;
        chart.x_unit = "s";
        chart.scales[0] = drawing.time_axis.scale;
        if has_axis {
            chart.x_label.clone_from(&drawing.time_axis.label);
        }
        let frame = Frame {
            x,
            pixels: rect.width() as usize,
            lit: self.lit,
            units: &self.units,
            is_shared: signals.len() > 1,
            first: 0,
        };
        let frames = [frame, Frame { first: left, ..frame }];
        let mut first = 0;
        match self.reference.filter(|reference| *reference < entries.len()) {
            Some(reference) => {
                let name = short(&entries[reference].recording.about.name);
                let (what, unit) = chart.title.rsplit_once(", ").unwrap_or((&chart.title, ""));
                chart.title = format!("{what} minus {name}, {unit}");
                for (side, frame) in sides.into_iter().zip(frames) {
                    first = chart.curves.len();
                    chart.curves.extend(difference::curves(ui, entries, reference, side, frame));
                }
                if chart.curves.is_empty() {
                    chart.when_empty = difference::WHY_NONE;
                }
            }
            None => {
                for (side, frame) in sides.into_iter().zip(frames) {
                    first = chart.curves.len();
                    chart.curves.extend(content::curves(ui, entries, side, frame));
                }
                content::missing(ui, entries, signals, self.lit, &mut chart);
                if let Some(at) = self.linked.at() {
                    let of_side = |(side, frame)| content::readings(entries, side, frame, at);
                    chart.readings = sides.into_iter().zip(frames).flat_map(of_side).collect();
                }
            }
        }
        chart.hover = self.linked.at();
        let fitted = |curves: &[Curve]| {
            let values = curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
            chart.fitted(range_of(values))
        };
        let set = |name: &str| self.y.iter().find(|(known, _)| known == name).map(|(_, y)| *y);
        let y = set(&plot).unwrap_or_else(|| fitted(&chart.curves[..first]));
        if left < signals.len() {
            let y = set(&of_right(&plot)).unwrap_or_else(|| fitted(&chart.curves[first..]));
            chart.right =
                Some(Right { label: content::label(sides[1], drawing.signals, &self.units), first, y });
        }
        chart.y = y;
        content::gaps(ui, entries, x, rect.width(), &mut chart);
        if !self.hides_events {
            chart.flags = content::marks(ui, entries, x);
        }
        chart.flag_words = has_axis;
        self.mark_cursors(ui, &mut chart);
        chart
    }

    /// Marks the cursors.
    pub(super) fn mark_cursors(&self, ui: &Ui, chart: &mut Chart) {
        let Some(cursors) = self.cursors else { return };
        let colour = ui.visuals().strong_text_color();
        let flag = |(x, text): (f64, &str)| Flag::new(x, text, colour);
        chart.flags.extend(cursors.into_iter().zip(["A", "B"]).map(flag));
        chart.flags.sort_by(|a, b| a.x.total_cmp(&b.x));
    }
}

/// Name by which the right axis of a plot is kept.
fn of_right(plot: &str) -> String {
    format!("{plot} (right)")
}
