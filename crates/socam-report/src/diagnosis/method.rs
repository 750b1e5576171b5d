//! How a report was made: recordings, cross-validation, false-alarm rate, command, date, and hashes of files.

use maud::{Markup, html};
use socam_findings::{Diagnosis, document::Validation};

use super::{tables, words};
use crate::{FileHash, Provenance, scaffold::hashes};

/// The section. `written` are the hashes of the files beside the page.
pub(super) fn method(diagnosis: &Diagnosis, provenance: &Provenance, written: &[FileHash]) -> Markup {
    let selection = match diagnosis.selection {
        Some(Validation::Blocks) => {
            "Models were compared on blocks of the training recordings, each left out in turn."
        }
        _ => "Models were compared on the training recordings, each left out in turn.",
    };
    let proof = match (&diagnosis.held_out, diagnosis.validation) {
        (Some(held_out), _) => held_out.sentence.as_str(),
        (None, Validation::Holdout) => {
            "Held-out recordings were read only after the last choice, and never fitted; until then only their checksums were compared."
        }
        (None, _) => "No recording was held out, so that nothing here is confirmed beyond that.",
    };
    html! {
        (tables::recordings(diagnosis))
        p { (selection) " " (proof) }
        p {
            "False-alarm rate: on " (words::rough(100.0 * diagnosis.false_alarm_rate))
            " % of benches with nothing missing, something would be found."
        }
        dl {
            @if !provenance.command.is_empty() { dt { "Command" } dd { code { (provenance.command) } } }
            @if !provenance.date.is_empty() { dt { "Date" } dd { (provenance.date) } }
            dt { "Program" }
            dd { "socam " (diagnosis.version) ", " (words::rough(diagnosis.cpu_s)) " s of processor time" }
            dt { "Numbers" }
            dd { code { "diagnosis.json" } " (" (diagnosis.schema) ")" }
            dt { @if tables::is_corrected(diagnosis) { "Corrected model" } @else { "Model" } }
            dd {
                @if diagnosis.is_interrupted() { "not written, because the search was interrupted" }
                @else { code { "model.toml" } }
            }
        }
        (hashes("File that was read", &provenance.files))
        (hashes("File beside this page", written))
    }
}
