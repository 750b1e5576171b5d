//! Pages of plots, and the files of a report.

use std::path::Path;

use anyhow::Context;
pub(super) use socam_response::pictures::{Curve, Drawn, Picture};

use crate::output;

/// A section of a page.
pub(super) struct Section {
    pub(super) title: String,
    pub(super) sentences: Vec<String>,
    pub(super) pictures: Vec<Picture>,
    /// Tables of text; the first row is the header.
    pub(super) tables: Vec<Vec<Vec<String>>>,
}

/// A self-contained page.
pub(super) fn page(title: &str, about: &str, sections: &[Section]) -> String {
    use maud::{Render, html};
    let body = html! {
        h1 { (title) }
        p class="over" { (about) }
        main {
            @for section in sections {
                section {
                    h2 { (section.title) }
                    @for sentence in &section.sentences { p { (sentence) } }
                    div class="plots" {
                        @for picture in &section.pictures { figure { (picture.plot.plot().render()) } }
                    }
                    @for rows in &section.tables {
                        div class="scroll" { table {
                            @for (index, row) in rows.iter().enumerate() {
                                tr { @for cell in row { @if index == 0 { th { (cell) } } @else { td { (cell) } } } }
                            }
                        } }
                    }
                }
            }
        }
    };
    socam_plot::document(title, "", &body).into_string()
}

/// Writes files into a folder, each atomically.
pub(super) fn write_all(dir: &Path, files: &[(String, String)]) -> anyhow::Result<()> {
    std::fs::create_dir_all(dir).with_context(|| format!("cannot make the folder `{}`", dir.display()))?;
    for (name, text) in files {
        output::write_whole(&dir.join(name), text)?;
    }
    Ok(())
}
