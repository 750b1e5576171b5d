//! `thesis`: every number of the thesis that this project began with, computed again.

use std::fmt::Write as _;
use std::path::PathBuf;

use socam_thesis::{Report, Verdict};

use super::Outcome;
use crate::{output, table};

/// Verify every number of the thesis
///
/// Computes the numbers of X. Song, The Parameter Identification of a Novel Speed Reducer, McGill University, 2002, from its own data, and
/// reports which printed numbers hold, why the others do not, and what physics the tables conceal.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host thesis
  socam-host thesis --report thesis-page")]
pub(crate) struct Args {
    /// Write the page (index.html) and the numbers (thesis.json) into this folder
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Replace the page of --report, if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    output::check_page(args.report.as_deref(), args.force)?;
    let report = socam_thesis::examine().map_err(anyhow::Error::msg)?;
    if let Some(dir) = &args.report {
        let json = format!("{}\n", serde_json::to_string_pretty(&report)?);
        let page = socam_report::thesis::page(&report);
        output::write_folder(dir, &[("thesis.json".into(), json), ("index.html".into(), page)])?;
    }
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&text(&report))?;
    }
    Ok(Outcome::Done)
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    for of in &report.tables {
        let _ = writeln!(text, "{}: {}", of.place, of.title);
        let mut rows = vec![["", "printed", "ours", "", ""].map(str::to_owned).to_vec()];
        rows.extend(of.rows.iter().map(|row| {
            vec![
                row.what.clone(),
                row.thesis.clone(),
                row.ours.map_or_else(|| "-".into(), table::number),
                row.unit.to_owned(),
                if row.holds { "holds".into() } else { format!("does not: {}", row.calculation) },
            ]
        }));
        text.push_str(&table::align(&rows, &[false, true, true, false, false]));
        text.push('\n');
    }
    for point in &report.points {
        let verdict = match point.verdict {
            Verdict::Holds => "holds",
            Verdict::Refuted => "refuted",
            Verdict::Concealed => "physics concealed",
        };
        let _ = writeln!(text, "{}. {} ({verdict})", point.number, point.title);
        for line in &point.calculation {
            let _ = writeln!(text, "     {line}");
        }
        let _ = writeln!(text, "   {}\n", point.conclusion);
    }
    let (holds, all) = report.counts();
    let _ = writeln!(text, "{all} printed numbers computed again: {holds} hold, {} do not.", all - holds);
    text
}
