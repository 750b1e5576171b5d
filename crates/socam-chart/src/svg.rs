//! The charts of a view as an SVG file, from what the view knows of them: curves, axes with units, flags, gaps.
//!
//! The plots are those of the reports ([`socam_plot::views`]), in colours for paper.

mod encode;

use std::fmt::Write;

use egui::Color32;
use socam_plot::{Axis, Flag, Image, Mark, Plot, Series, View};

use super::chart::{Backdrop, MarkerShape, Scale, Seen, Style};
use super::colours::Colours;
use super::raster;
use crate::theme;

/// Pixel columns of a plot: two for each unit of its view box.
const COLUMNS: usize = 1500;
/// Markers along a marked line.
const MARKERS: f64 = 7.0;
/// Steps of the colours of dots.
const SHADES: usize = 24;

/// The charts of a dark or light window below each other.
///
/// # Errors
/// When the view has no charts; one sentence.
pub fn svg(seen: &[Seen], is_dark: bool) -> Result<String, String> {
    if seen.is_empty() {
        return Err("this view has no charts; export it as .png".into());
    }
    let mut style = Classes { is_dark, rules: String::new() };
    let drawings: Vec<Drawing> = seen.iter().map(|chart| Drawing::new(chart, &mut style)).collect();
    let views: Result<Vec<View<'_>>, String> = drawings
        .iter()
        .enumerate()
        .map(|(number, drawing)| drawing.view(x_axis(&seen[number..]), &seen[number], &mut style))
        .collect();
    let title = seen.iter().map(|chart| chart.title.as_str()).collect::<Vec<_>>().join("; ");
    let views = views?;
    Ok(socam_plot::views(&title, &views, &style.rules))
}

/// The horizontal axis of the first chart: that of the next labelled one, where a stack has its label below.
fn x_axis(seen: &[Seen]) -> Axis {
    let same = seen.iter().take_while(|chart| chart.ranges[0] == seen[0].ranges[0]);
    let label = same.map(|chart| chart.x_label.as_str()).find(|label| !label.is_empty());
    axis(label.unwrap_or_default(), seen[0].scales[0])
}

/// The axis of a label: its unit stands behind its last comma.
fn axis(label: &str, scale: Scale) -> Axis {
    let (quantity, unit) = label.rsplit_once(", ").unwrap_or((label, ""));
    if scale == Scale::Log { Axis::logarithmic(quantity, unit) } else { Axis::new(quantity, unit) }
}

/// Rules of the style sheet, one for each colour.
struct Classes {
    is_dark: bool,
    rules: String,
}

impl Classes {
    /// The class of a colour: strokes and dots, areas, and flags.
    fn of(&mut self, colour: Color32) -> String {
        let (hex, opacity) = theme::on_paper(colour, self.is_dark);
        let class = format!("c{hex}-{:.0}", 100.0 * opacity);
        if !self.rules.contains(&format!(".{class} ")) {
            // Writing to a string cannot fail.
            let _ = write!(
                self.rules,
                " .plot .{class} {{ stroke: #{hex}; stroke-opacity: {opacity:.2}; }}\
                 .plot .dot.{class}, .plot .band.{class}, .plot .shade.{class} {{ fill: #{hex}; fill-opacity: {opacity:.2}; stroke: none; }}\
                 .plot .mark.{class} text {{ fill: #{hex}; stroke: none; }}"
            );
        }
        class
    }
}

/// Series of one chart, as columns.
struct Drawing {
    series: Vec<Owned>,
}

struct Owned {
    label: String,
    class: String,
    mark: Mark,
    x: Vec<f64>,
    y: Vec<f64>,
    spread: Vec<f64>,
}

impl Owned {
    /// Parts of a line are kept apart by missing values.
    fn new(label: &str, class: String, mark: Mark, parts: &[Vec<[f64; 2]>]) -> Self {
        let points = || parts.iter().flat_map(|part| part.iter().copied().chain([[f64::NAN; 2]]));
        let (x, y) = (points().map(|point| point[0]).collect(), points().map(|point| point[1]).collect());
        Self { label: label.into(), class, mark, x, y, spread: Vec::new() }
    }
}

impl Drawing {
    fn new(chart: &Seen, style: &mut Classes) -> Self {
        let mut series = Vec::new();
        if let Some(Backdrop::Cloud(cloud)) = &chart.backdrop {
            series.extend(dots(&cloud.dots, &cloud.colours, style));
        }
        for (band, colour) in &chart.bands {
            let middles: Vec<[f64; 2]> =
                band.iter().map(|[x, low, high]| [*x, f64::midpoint(*low, *high)]).collect();
            let spread = band.iter().map(|[_, low, high]| 0.5 * (high - low)).collect();
            let band = Owned::new("", style.of(*colour), Mark::Band, &[middles]);
            series.push(Owned { spread, ..band });
        }
        for curve in &chart.curves {
            let class = style.of(curve.colour);
            let cross = |shape| if shape == MarkerShape::Cross { Mark::Crosses } else { Mark::Points };
            let new = |label: &str, class: &str, mark| Owned::new(label, class.into(), mark, &curve.parts);
            let name = curve.name.as_str();
            match curve.style {
                Style::Solid => series.push(new(name, &class, Mark::Line)),
                Style::Dashed => series.push(new(name, &format!("{class} dashed"), Mark::Line)),
                Style::Wide => series.push(new(name, &format!("{class} wide"), Mark::Line)),
                Style::Broad => series.push(new(name, &format!("{class} broad"), Mark::Line)),
                Style::Thin => series.push(new(name, &format!("{class} thin"), Mark::Line)),
                Style::Dotted => {
                    series.extend([new(name, &class, Mark::Line), new("", &class, Mark::Points)])
                }
                Style::Markers(shape) => series.push(new(name, &class, cross(shape))),
                Style::Marked(shape) => {
                    let some = marked(&curve.parts, chart);
                    let marks = Owned::new("", class.clone(), cross(shape), &[some]);
                    series.extend([new(name, &class, Mark::Line), marks]);
                }
            }
        }
        Self { series }
    }

    fn view<'a>(&'a self, x: Axis, chart: &'a Seen, style: &mut Classes) -> Result<View<'a>, String> {
        let series = self.series.iter().map(|own| Series {
            label: &own.label,
            class: &own.class,
            mark: own.mark,
            x: &own.x,
            y: &own.y,
            spread: &own.spread,
        });
        let y = axis(&chart.title, chart.scales[1]);
        let plot = Plot { title: chart.title.clone(), x, y, series: series.collect(), columns: COLUMNS };
        let (image, bar) = match &chart.backdrop {
            Some(Backdrop::Heat(heat)) => {
                let href = encode::data_url(&raster::png_with_holes(heat.image())?);
                let cells = heat.cells();
                (Some(Image { href, x: cells.x, y: cells.y }), Some(heat.colours()))
            }
            Some(Backdrop::Cloud(cloud)) => (None, Some(&cloud.colours)),
            None => (None, None),
        };
        Ok(View {
            plot,
            ranges: chart.ranges,
            shaded: chart.shaded.iter().map(|(range, colour)| (*range, style.of(*colour))).collect(),
            flags: chart
                .flags
                .iter()
                .map(|flag| Flag { x: flag.x, text: &flag.text, class: style.of(flag.colour) })
                .collect(),
            image,
            bar: bar.map(|colours| (axis(&colours.label, Scale::Linear), colours.range)),
        })
    }
}

/// Dots as lines of length zero with round ends, grouped by their shade.
fn dots(dots: &[[f64; 3]], colours: &Colours, style: &mut Classes) -> Vec<Owned> {
    // Exports show the full range of colours.
    let colours = Colours::of_fields(colours.range, "");
    let shade = |value: f64| ((colours.share(value) * SHADES as f64) as usize).min(SHADES - 1);
    let group = |number: usize| {
        let parts: Vec<Vec<[f64; 2]>> =
            dots.iter().filter(|dot| shade(dot[2]) == number).map(|dot| vec![[dot[0], dot[1]]]).collect();
        let colour = colours.at((number as f64 + 0.5) / SHADES as f64);
        (!parts.is_empty())
            .then(|| Owned::new("", format!("speckle {}", style.of(colour)), Mark::Line, &parts))
    };
    (0..SHADES).filter_map(group).collect()
}

/// Points of a line at large distances.
fn marked(parts: &[Vec<[f64; 2]>], chart: &Seen) -> Vec<[f64; 2]> {
    let [from, to] = chart.ranges[0];
    let log = chart.scales[0] == Scale::Log;
    let place = |x: f64| {
        let share = if log { (x / from).ln() / (to / from).ln() } else { (x - from) / (to - from) };
        (share * MARKERS).floor()
    };
    let mut last = f64::NAN;
    let mut chosen = Vec::new();
    for point in parts.iter().flatten().filter(|point| point[1].is_finite()) {
        if place(point[0]) != last {
            last = place(point[0]);
            chosen.push(*point);
        }
    }
    chosen
}

#[cfg(test)]
mod tests;
