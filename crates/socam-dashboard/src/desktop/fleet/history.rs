//! Charts of a fleet: parameters of a machine over the dates, and sizes of a finding.

use std::collections::BTreeMap;

use egui::{Ui, Vec2};
use socam_fleet::row::Row;
use socam_fleet::{Group, Spread, words};

use socam_chart::chart::{Chart, Curve, MarkerShape, Seen, Style, range_of};
use socam_chart::theme;

/// Positions of points on the horizontal axis, and the label of the axis.
struct Places {
    x: Vec<Option<f64>>,
    label: String,
}

/// Dates as days since the first; numbers where none has a date.
fn over(dates: &[Option<i64>], what: &str) -> Places {
    let Some(first) = dates.iter().flatten().min().copied() else {
        let x = (0..dates.len()).map(|number| Some(number as f64 + 1.0)).collect();
        return Places { x, label: format!("{what}, number") };
    };
    let x = dates.iter().map(|date| date.map(|date| words::days(first, date))).collect();
    Places { x, label: format!("time since {}, days", words::day(first)) }
}

/// A value with its 95 % interval.
struct Estimate {
    x: f64,
    value: f64,
    ends: Option<[f64; 2]>,
    determined: bool,
}

/// A parameter of a machine, and the median over all machines where there are others.
pub(super) fn parameter(
    ui: &mut Ui,
    (name, unit): (&str, &str),
    rows: &[Row],
    sisters: Option<&Spread>,
    (size, lit): (Vec2, bool),
    seen: &mut Vec<Seen>,
) {
    let dates: Vec<Option<i64>> = rows.iter().map(|row| row.date).collect();
    let places = over(&dates, "recording");
    let estimates: Vec<Estimate> = rows
        .iter()
        .zip(&places.x)
        .filter_map(|(row, x)| {
            let own = row.parameters.iter().find(|own| own.name == name)?;
            let ends = own.low.zip(own.high).map(|(low, high)| [low, high]);
            Some(Estimate { x: (*x)?, value: own.value?, ends, determined: own.determined })
        })
        .collect();
    let title = format!("{name}, {}", socam_plot::words::unit(unit));
    let mut chart = Chart::new(("fleet", name), title, size);
    chart.x_label = places.label;
    chart.when_empty = "no recording determines it";
    let colour = if lit { theme::alarm(ui) } else { theme::good(ui) };
    chart.curves = curves(&estimates, colour);
    let x = range_of(places.x.into_iter().flatten()).unwrap_or([0.0, 1.0]);
    chart.x = socam_chart::chart::with_room(x);
    if let Some(sisters) = sisters.filter(|sisters| sisters.median.is_finite()) {
        chart.curves.push(Curve {
            name: format!("median of {} machines", sisters.machines),
            colour: theme::weak(ui),
            parts: vec![chart.x.map(|x| [x, sisters.median]).to_vec()],
            style: Style::Dashed,
        });
    }
    let values = chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
    chart.y = chart.fitted(range_of(values));
    chart.show(ui, seen);
}

fn curves(estimates: &[Estimate], colour: egui::Color32) -> Vec<Curve> {
    let points = |determined: bool| -> Vec<Vec<[f64; 2]>> {
        let own = estimates.iter().filter(|own| own.determined == determined).map(|own| [own.x, own.value]);
        let points: Vec<[f64; 2]> = own.collect();
        if points.is_empty() { Vec::new() } else { vec![points] }
    };
    let intervals = estimates.iter().filter(|own| own.determined).filter_map(|own| {
        let ends = own.ends?;
        Some(ends.map(|end| [own.x, end]).to_vec())
    });
    let kinds = [
        ("value", points(true), Style::Markers(MarkerShape::Circle)),
        ("95 % interval", intervals.collect(), Style::Solid),
        ("not determined", points(false), Style::Markers(MarkerShape::Cross)),
    ];
    let each = kinds.into_iter().filter(|(_, parts, _)| !parts.is_empty());
    each.map(|(name, parts, style)| Curve { name: name.into(), colour, parts, style }).collect()
}

/// Sizes of a finding over the dates; over its machines where dates are missing.
pub(super) fn sizes(ui: &mut Ui, group: &Group, size: Vec2, seen: &mut Vec<Seen>) {
    let dates: Vec<Option<i64>> = group.members.iter().map(|member| member.date).collect();
    let mut places = over(&dates, "machine");
    if dates.contains(&None) {
        let mut order: BTreeMap<&str, f64> = BTreeMap::new();
        for member in &group.members {
            let next = order.len() as f64 + 1.0;
            order.entry(&member.machine).or_insert(next);
        }
        places.x = group.members.iter().map(|member| order.get(member.machine.as_str()).copied()).collect();
        places.label = "machine, number in the order of names".into();
    }
    let each = group.members.iter().zip(&places.x).filter_map(|(member, x)| {
        let ends = member.low.zip(member.high).map(|(low, high)| [low, high]);
        Some(Estimate { x: (*x)?, value: member.size?, ends, determined: true })
    });
    let mut estimates: Vec<Estimate> = each.collect();
    estimates.sort_by(|a, b| a.x.total_cmp(&b.x));
    let parameter = group.parameter.as_deref().unwrap_or("size");
    let title = format!(
        "{parameter} of {}, {}",
        super::listing::at(&group.effect, &group.place),
        socam_plot::words::unit(&group.unit)
    );
    let mut chart = Chart::new("fleet sizes", title, size);
    chart.x_label = places.label;
    chart.when_empty = "this finding has no size";
    chart.curves = curves(&estimates, theme::alarm(ui));
    let x = range_of(places.x.into_iter().flatten()).unwrap_or([0.0, 1.0]);
    chart.x = socam_chart::chart::with_room(x);
    let values = chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
    chart.y = chart.fitted(range_of(values));
    chart.show(ui, seen);
}
