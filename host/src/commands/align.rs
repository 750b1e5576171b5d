//! `align`: the clocks of two devices in one recording, by a motion that both saw.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::bail;
use serde::Serialize;
use socam_compare::alignment::{Alignment, Range, align};
use socam_recording::clocks::{at_rows, present, usual};
use socam_recording::{Channel, Dataset, Format, Loaded, Selection, import_mcap, read_attachments};

use super::Outcome;
use crate::output::{self, WrongArguments};

/// What a recording of several devices says of their channels; `record` writes it.
pub(crate) const DEVICE_CHANNELS: &str = "device_channels";

/// Lay the channels of one device in a recording over those of another one that saw the same motion
///
/// `record` maps the clocks of several devices to this computer's; what remains is the unknown delay of each link. Where both saw one motion,
/// such as encoders on both sides of a stiff coupling, this finds the shift between them with its 95 % interval, and writes a recording in which
/// all channels of the second device are shifted. A motion that is too small, or repeats itself, is refused with the shifts that fit.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host align run.mcap --by motor_position=load_position                    says the shift
  socam-host align run.mcap --by motor_position=load_position -o aligned.mcap    and writes the recording
  socam-host align run.mcap --by tcp_speed=udp_speed --near -0.31 --within 0.1   a motion of several periods")]
pub(crate) struct Args {
    /// Recording of several devices
    #[arg(value_name = "RUN")]
    run: String,
    /// Channels of one unit that saw the same motion: the one that stays, and one of the device that is shifted
    #[arg(long, value_name = "FIXED=SHIFTED")]
    by: String,
    /// Further channels to shift, where the recording does not say which ones are of one device
    #[arg(long = "with", value_name = "CHANNEL", value_delimiter = ',')]
    further: Vec<String>,
    /// Middle of the range in which the shift is looked for, s
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    near: f64,
    /// Half of that range, s
    #[arg(long, value_name = "SECONDS", default_value_t = 0.5)]
    within: f64,
    /// Recording to write (.mcap)
    #[arg(short, long, value_name = "OUT.mcap")]
    output: Option<PathBuf>,
    /// Replace an existing recording
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    recording: &'a str,
    fixed: &'a str,
    shifted: &'a str,
    #[serde(flatten)]
    alignment: Alignment,
    /// All channels that are shifted.
    channels: Vec<&'a str>,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let is_range = args.near.is_finite() && args.within.is_finite() && args.within > 0.0;
    if !is_range {
        let problem =
            "--near and --within are numbers of seconds, and --within is more than 0, as in --within 0.5";
        return Err(WrongArguments(problem.into()).into());
    }
    let selection = Selection::parse(&args.run)?;
    if let Some(target) = &args.output {
        output::check_target_of(target, &selection, args.force)?;
    }
    let data = output::open(&args.run)?;
    let (fixed, shifted) = named(&data, &args.by)?;
    let together = together(&data, fixed, shifted, &args.further)?;
    let loaded = data.load_all()?;
    let values = |channel: usize| loaded.columns[channel].values();
    let range = Range { near_s: args.near, within_s: args.within };
    let [fixed, shifted] = [fixed, shifted].map(|index| (&data.channels()[index].name, values(index)));
    let found = align(&loaded.time_s, fixed.1, shifted.1, range);
    let alignment = match found {
        Ok(alignment) => alignment,
        Err(reason) => bail!(
            "`{}`: {} is not laid over {}: {reason} (--near and --within say where the shift is looked for)",
            data.name(),
            shifted.0,
            fixed.0
        ),
    };
    let channels: Vec<&str> = together.iter().map(|index| data.channels()[*index].name.as_str()).collect();
    let said = sentence(&alignment, fixed.0, shifted.0, &channels);
    if args.json {
        output::print_json(&Document {
            schema: "socam.align/1",
            recording: &args.run,
            fixed: fixed.0,
            shifted: shifted.0,
            alignment,
            channels,
        })?;
    } else {
        output::print(&format!("{said}\n"))?;
    }
    if let Some(target) = &args.output {
        let moved = moved(&data, &loaded, &together, alignment.shift_s.value)?;
        let (mut metadata, mut attachments) = (BTreeMap::new(), Vec::new());
        if let Some(contents) = data.contents() {
            metadata.clone_from(&contents.metadata);
            if !contents.events.is_empty() {
                output::say(format_args!("{} events stay in {} alone", contents.events.len(), args.run));
            }
        }
        if data.format() == Format::Mcap {
            attachments = read_attachments(&selection.path)?;
        }
        // One that was shifted before keeps what was said of that.
        let before = metadata.remove("aligned").map_or_else(String::new, |before| format!("{before}; "));
        metadata.insert("aligned".into(), format!("{before}{said}; values are interpolated linearly"));
        metadata.insert("host".into(), env!("CARGO_PKG_VERSION").into());
        import_mcap(&moved, 0, metadata, attachments, target)?;
        output::say(format_args!("{} samples written to {}", moved.rows(), target.display()));
    }
    Ok(Outcome::on([&data]))
}

/// The channels of `--by`.
fn named(data: &Dataset, by: &str) -> anyhow::Result<(usize, usize)> {
    let Some((fixed, shifted)) = by.split_once('=') else {
        let problem =
            format!("`--by {by}` names one channel; expected two, as in --by motor_position=load_position");
        return Err(WrongArguments(problem).into());
    };
    let (fixed, shifted) = (data.channel_index(fixed.trim())?, data.channel_index(shifted.trim())?);
    let [one, other] = [fixed, shifted].map(|index| &data.channels()[index]);
    if fixed == shifted {
        return Err(WrongArguments(format!(
            "--by names {} twice; expected channels of two devices",
            one.name
        ))
        .into());
    }
    if one.unit != other.unit {
        let unit = |channel: &Channel| format!("{} is in {}", channel.name, channel.unit.symbol());
        let problem = format!("{} and {}; name two channels of one unit", unit(one), unit(other));
        return Err(WrongArguments(problem).into());
    }
    Ok((fixed, shifted))
}

/// The channels that are shifted together: those of the device of one of them.
fn together(data: &Dataset, fixed: usize, shifted: usize, further: &[String]) -> anyhow::Result<Vec<usize>> {
    let mut together = vec![shifted];
    let stated = data.contents().and_then(|contents| contents.metadata.get(DEVICE_CHANNELS));
    if let Some(stated) = stated {
        let of_device =
            |name: &str| stated.split("; ").find(|device| device.split(", ").any(|one| one == name));
        let [one, other] = [fixed, shifted].map(|index| of_device(&data.channels()[index].name));
        if one.is_some() && one == other {
            let problem =
                "both channels of --by are of one device, which has one clock; name channels of two devices";
            return Err(WrongArguments(problem.into()).into());
        }
        let own = other.into_iter().flat_map(|device| device.split(", "));
        together
            .extend(own.filter_map(|name| data.channels().iter().position(|channel| channel.name == name)));
    }
    for name in further {
        together.push(data.channel_index(name)?);
    }
    if together.contains(&fixed) {
        return Err(WrongArguments(format!(
            "{} is to stay; leave it out of --with",
            data.channels()[fixed].name
        ))
        .into());
    }
    together.sort_unstable();
    together.dedup();
    Ok(together)
}

/// The recording with channels shifted by a time, s.
fn moved(data: &Dataset, loaded: &Loaded, together: &[usize], shift_s: f64) -> anyhow::Result<Dataset> {
    let column = |(index, column): (usize, &socam_recording::Column)| {
        let values = column.values();
        if !together.contains(&index) {
            return values.to_vec();
        }
        shifted(&loaded.time_s, values, shift_s)
    };
    let columns = loaded.columns.iter().enumerate().map(column).collect();
    let made = Dataset::from_columns(data.name(), data.channels().to_vec(), loaded.time_s.clone(), columns)?;
    Ok(made.with_epoch(data.epoch()))
}

/// Values shifted by a time, s: between values of most rows they are interpolated; those of a slow device stand at the nearest row alone.
fn shifted(rows_s: &[f64], values: &[f64], shift_s: f64) -> Vec<f64> {
    let (mut times_s, values) = present(rows_s, values);
    times_s.iter_mut().for_each(|time_s| *time_s += shift_s);
    at_rows(rows_s, &times_s, &values, usual(rows_s, &times_s))
}

fn sentence(found: &Alignment, fixed: &str, shifted: &str, channels: &[&str]) -> String {
    let Alignment { shift_s, gain, correlation } = found;
    let [low, high] = shift_s.ci95.map(|end_s| 1e3 * end_s);
    let others: Vec<&str> = channels.iter().copied().filter(|name| *name != shifted).collect();
    let others =
        if others.is_empty() { String::new() } else { format!(", and with it {}", others.join(", ")) };
    format!(
        "{shifted} is shifted by {:+.3} ms (95 % interval {low:+.3} to {high:+.3}) to lie over {fixed}, which is {:.4} times as large (correlation {correlation:.4}){others}",
        1e3 * shift_s.value,
        gain.value
    )
}
