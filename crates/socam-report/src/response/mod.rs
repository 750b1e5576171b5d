//! Frequency responses and transfer functions: a page of sections, and its pictures.

mod pictures;
mod transfer;

use maud::{Render, html};

use crate::scaffold::{self, heading};
pub use pictures::{Curve, Drawn, Picture, pictures};
pub use transfer::{matched, transfer};

/// A section of a page.
#[derive(Debug)]
pub struct Section {
    /// Title.
    pub title: String,
    /// Paragraphs.
    pub sentences: Vec<String>,
    /// Plots.
    pub pictures: Vec<Picture>,
    /// Tables of text; the first row of each is its head.
    pub tables: Vec<Vec<Vec<String>>>,
}

/// A page of these sections. `about` stands below the title.
#[must_use]
pub fn page(title: &str, about: &str, sections: &[Section]) -> String {
    let main = html! {
        @for section in sections {
            section {
                h2 { (section.title) }
                @for sentence in &section.sentences { p { (sentence) } }
                div class="plots" {
                    @for picture in &section.pictures { figure { (picture.plot.plot().render()) } }
                }
                @for rows in &section.tables {
                    (scaffold::table(&html! {
                        @for (index, row) in rows.iter().enumerate() {
                            tr { @for cell in row { @if index == 0 { th { (cell) } } @else { td { (cell) } } } }
                        }
                    }))
                }
            }
        }
    };
    scaffold::page(title, "", &heading(title, &html! { (about) }), &main)
}
