//! LabVIEW measurement files (`.lvm`), whose headers state names, units and times (NI, "Specification for the LabVIEW Measurement File").

use std::path::Path;

use super::cells::{Cell, cell, split};
use super::lines::Lines;
use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// Where the times stand.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Times {
    /// In no column: `X0` and `Delta_X` of each channel.
    None,
    /// In the first column, for all channels.
    One,
    /// In a column before each channel.
    Multi,
}

/// What the header of the file says.
#[derive(Debug, Clone, Copy)]
struct Form {
    separator: u8,
    decimal_comma: bool,
    times: Times,
}

/// What the header of a segment says of its channels.
#[derive(Debug, Clone, Default)]
struct Segment {
    units: Vec<String>,
    dimensions: Vec<String>,
    dates: Vec<String>,
    clocks: Vec<String>,
    first: Vec<f64>,
    steps: Vec<f64>,
    count: Option<usize>,
    names: Vec<String>,
    rows: usize,
}

/// A channel, over all segments.
#[derive(Debug, Clone, Default)]
struct Channel {
    name: String,
    unit: Option<String>,
    /// Times within the segment, s, and where its segment begins, ns since 1970.
    times: Vec<(f64, Option<i64>)>,
    values: Vec<f64>,
}

const END: &str = "***End_of_Header***";

/// Reads the channels of a file, each with its own clock; those with the same times share one.
pub(crate) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let mut lines = Lines::sniffed(path)?;
    let form = form(&mut lines)?;
    let mut source = Source::default();
    let mut channels: Vec<Channel> = Vec::new();
    let mut segment: Option<Segment> = None;
    while lines.next()? {
        let line = lines.bare();
        let cells = split(line, form.separator);
        let key = cells[0].trim();
        match &mut segment {
            _ if key.starts_with("***Start_Special") => skip_special(&mut lines)?,
            _ if cells.iter().all(|text| text.trim().is_empty()) => segment = None,
            None => segment = Some(header(&mut lines, form)?),
            Some(segment) if segment.names.is_empty() => segment.begin(&cells, form, &mut channels)?,
            Some(segment) if segment.rows < wanted.most_rows => {
                let from = channels.len() - segment.names.len();
                segment
                    .push(&cells, form, &mut channels[from..])
                    .map_err(|problem| lines.problem(problem))?;
            }
            Some(_) => {}
        }
    }
    if channels.iter().all(|channel| channel.values.is_empty()) {
        return Err(ImportError::file(
            path,
            "holds a header of LabVIEW and no values behind it; record again",
        ));
    }
    source.groups.extend(channels.into_iter().map(Channel::group));
    let mut source = source.with_shared_clocks().tidy();
    source.keep(wanted);
    Ok(source)
}

/// Reads the header of the file.
fn form(lines: &mut Lines<'_>) -> Result<Form> {
    let mut form = Form { separator: b'\t', decimal_comma: false, times: Times::One };
    while lines.next()? {
        let line = lines.bare();
        if line.starts_with(END) {
            return Ok(form);
        }
        let (key, value) = line.split_once(['\t', ',']).unwrap_or((line, ""));
        let value = value.trim_matches(['\t', ' ']);
        match key.trim() {
            "Separator" if value.starts_with("Comma") => form.separator = b',',
            "Decimal_Separator" => form.decimal_comma = value.starts_with(','),
            "X_Columns" if value.starts_with("No") => form.times = Times::None,
            "X_Columns" if value.starts_with("Multi") => form.times = Times::Multi,
            _ => {}
        }
    }
    Err(lines.problem(format!("ends before `{END}`; copy it again from its source")))
}

fn skip_special(lines: &mut Lines<'_>) -> Result<()> {
    while lines.next()? {
        if lines.text.starts_with("***End_Special") {
            break;
        }
    }
    Ok(())
}

/// Reads the header of a segment, whose first line was read.
fn header(lines: &mut Lines<'_>, form: Form) -> Result<Segment> {
    let mut segment = Segment::default();
    loop {
        let cells = split(lines.bare(), form.separator);
        // Every channel has a cell, or two of which the second is empty or of its times.
        let count = segment.count.unwrap_or(1);
        let step = if cells.len() > 2 * count { 2 } else { 1 };
        let own = || cells.iter().skip(1).step_by(step).map(|text| text.trim().to_owned());
        let numbers = || own().map(|text| number(&text, form).unwrap_or(f64::NAN)).collect();
        match cells[0].trim() {
            END => return Ok(segment),
            "Channels" => segment.count = own().next().and_then(|text| text.parse().ok()),
            "Y_Unit_Label" => segment.units = own().collect(),
            "X_Dimension" => segment.dimensions = own().collect(),
            "Date" => segment.dates = own().collect(),
            "Time" => segment.clocks = own().collect(),
            "X0" => segment.first = numbers(),
            "Delta_X" => segment.steps = numbers(),
            _ => {}
        }
        if !lines.next()? {
            return Err(lines.problem(format!("ends before `{END}`; copy it again from its source")));
        }
    }
}

fn number(text: &str, form: Form) -> Option<f64> {
    match cell(text, form.decimal_comma, None) {
        Cell::Number(number) => Some(number),
        _ => None,
    }
}

impl Segment {
    /// Takes the names of the channels. A segment with the channels of the last one continues them.
    fn begin(&mut self, cells: &[&str], form: Form, channels: &mut Vec<Channel>) -> Result<()> {
        let own = cells.iter().map(|text| text.trim().trim_matches('"').to_owned());
        let names: Vec<String> = match form.times {
            Times::Multi => {
                own.collect::<Vec<_>>().chunks(2).filter_map(|pair| pair.get(1).cloned()).collect()
            }
            _ => own.skip(1).collect(),
        };
        let count = self.count.unwrap_or(names.len());
        self.names = names.into_iter().filter(|name| name != "Comment").take(count).collect();
        if self.at(channels).is_none() {
            channels.extend(self.names.iter().enumerate().map(|(index, name)| Channel {
                name: name.clone(),
                unit: self.units.get(index).filter(|unit| !unit.is_empty()).cloned(),
                ..Channel::default()
            }));
        }
        Ok(())
    }

    /// Where the last channels are those of this segment.
    fn at(&self, channels: &[Channel]) -> Option<usize> {
        let from = channels.len().checked_sub(self.names.len())?;
        channels[from..].iter().map(|channel| &channel.name).eq(&self.names).then_some(from)
    }

    /// Takes a row.
    fn push(&mut self, cells: &[&str], form: Form, channels: &mut [Channel]) -> Result<(), String> {
        let row = self.rows as f64;
        self.rows += 1;
        for (index, channel) in channels.iter_mut().enumerate() {
            let (time_at, value_at) = match form.times {
                Times::None | Times::One => (0, index + 1),
                Times::Multi => (2 * index, 2 * index + 1),
            };
            if self.dimensions.get(index).is_some_and(|text| !text.is_empty() && text != "Time") {
                return Err(format!(
                    "`{}` is over {}, not over time; only recordings over time are read",
                    channel.name, self.dimensions[index]
                ));
            }
            let text = |at: usize| cells.get(at).map_or("", |text| text.trim());
            let value = number(text(value_at), form);
            if value.is_none()
                && !text(value_at).is_empty()
                && cell(text(value_at), form.decimal_comma, None) == Cell::Text
            {
                return Err(format!(
                    "`{}` of `{}` is no number; correct it, or delete the line",
                    text(value_at),
                    channel.name
                ));
            }
            let even = self.first.get(index).copied().unwrap_or(0.0)
                + row * self.steps.get(index).copied().unwrap_or(f64::NAN);
            let stated = if form.times == Times::None { None } else { number(text(time_at), form) };
            channel.times.push((stated.unwrap_or(even), self.begins_ns(index)));
            channel.values.push(value.unwrap_or(f64::NAN));
        }
        Ok(())
    }

    /// When the segment of a channel began, ns since 1970.
    fn begins_ns(&self, index: usize) -> Option<i64> {
        let (date, clock) = (self.dates.get(index)?, self.clocks.get(index)?);
        crate::dates::nanoseconds(&format!("{date} {clock}"), None)
    }
}

impl Channel {
    /// The channel and its clock. Times that begin anew in each segment count from the segment's beginning.
    fn group(self) -> Group {
        let continues = self.times.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let begins = self.times.first().and_then(|time| time.1);
        let absolute = |(time_s, segment): &(f64, Option<i64>)| {
            let from = if continues { begins } else { *segment }?;
            let held = time_s.is_finite().then_some((time_s * 1e9).round() as i64)?;
            Some(from + held)
        };
        let name = "X_Value";
        let clock = if begins.is_some() {
            Signal::of_integers(name, Some("ns".into()), self.times.iter().map(absolute))
        } else {
            Signal::new(name, Some("s".into()), self.times.iter().map(|time| time.0).collect())
        };
        let group = self.name.clone();
        Group {
            name: group,
            signals: vec![clock, Signal::new(self.name, self.unit, self.values)],
            time: Some(0),
            ..Group::default()
        }
    }
}
