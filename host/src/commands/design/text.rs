//! The proposal in words.

use std::path::Path;

use socam_design::Tried;
use socam_job::Designed;
use socam_recording::{ProfileFile, Waveform};

use crate::table;

fn waveform(profile: &ProfileFile) -> String {
    let n = table::number;
    match profile.waveform {
        Waveform::Multisine { offset, amplitude, from_hz, to_hz, .. } => {
            format!(
                "multisine of {} V about {} V, {} to {} Hz",
                n(amplitude),
                n(offset),
                n(from_hz),
                n(to_hz)
            )
        }
        Waveform::Chirp { offset, amplitude, from_hz, to_hz, .. } => {
            format!("chirp of {} V about {} V, {} to {} Hz", n(amplitude), n(offset), n(from_hz), n(to_hz))
        }
        Waveform::Prbs { offset, amplitude, bit_s, .. } => {
            format!("random steps of {} V about {} V, {} s or longer", n(amplitude), n(offset), n(bit_s))
        }
        Waveform::Staircase { first, step, dwell_s, .. } => {
            format!("reversals from {} V to {} V every {} s", n(first), n(first + step), n(dwell_s))
        }
        _ => "another waveform".into(),
    }
}

pub(super) fn text(done: &Designed, written: Option<&Path>) -> String {
    let Designed { design, profile, tells_apart, reference } = done;
    let said = |tried: &Tried| match tried.distance {
        Some(distance) => format!("{} noise units apart", table::number(distance)),
        None => format!("widest interval +-{} %", table::number(100.0 * tried.score)),
    };
    let mut text = String::new();
    if let Some([a, b]) = tells_apart {
        text.push_str(&format!("To tell {a} from {b}\n"));
    }
    text.push_str(&format!("Record a {}: {}\n", waveform(&design.best.profile), said(&design.best)));
    if let Some(reference) = reference {
        let head = ["", "proposed", "five steps"].map(String::from).to_vec();
        let cell = |width: Option<f64>| {
            width.map_or_else(|| "not determined".into(), |w| format!("+-{:.3} %", 100.0 * w))
        };
        let rows = design.best.widths.iter().map(|width| {
            let other =
                reference.iter().find(|other| other.name == width.name).and_then(|other| other.relative);
            vec![width.name.clone(), cell(width.relative), cell(other)]
        });
        let rows: Vec<_> = std::iter::once(head).chain(rows).collect();
        text.push_str(&format!("\n95 % intervals to expect\n{}", table::align(&rows, &[false, true, true])));
    }
    text.push_str(&format!("\nOf {} profiles, the best of each kind\n", design.tried));
    let rows: Vec<_> =
        design.others.iter().map(|tried| vec![waveform(&tried.profile), said(tried)]).collect();
    text.push_str(&table::align(&rows, &[false, false]));
    match written {
        Some(path) => {
            text.push_str(&format!("\nsocam-host record --profile {} records it.\n", path.display()))
        }
        None => text.push_str(&format!("\n{profile}")),
    }
    text
}
