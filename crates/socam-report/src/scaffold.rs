//! What pages share: the frame, tables, folded sections, sentences, and the table of files with their hashes.

use maud::{Markup, html};

use crate::FileHash;

/// A self-contained page with its own `style` beside that of all pages. `title` is the window's, `head` stands above the main part.
pub(crate) fn page(title: &str, style: &str, head: &Markup, main: &Markup) -> String {
    let body = html! { (head) main { (main) } };
    socam_plot::document(title, style, &body).into_string()
}

/// The head of a plain page: its title and a line below.
#[cfg(any(feature = "comparison", feature = "fleet", feature = "response", feature = "thesis"))]
pub(crate) fn heading(title: &str, over: &Markup) -> Markup {
    html! { h1 { (title) } p class="over" { (over) } }
}

/// The head of a column of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Head<'t> {
    /// A column of text.
    Text(&'t str),
    /// A column of numbers, aligned to the right.
    Number(&'t str),
}

/// The row of heads of a table.
pub(crate) fn heads(columns: &[Head<'_>]) -> Markup {
    html! {
        tr {
            @for column in columns {
                @match column {
                    Head::Text(name) => { th { (name) } }
                    Head::Number(name) => { th class="n" { (name) } }
                }
            }
        }
    }
}

/// A table of these rows, which scrolls where the screen is too narrow for it.
pub(crate) fn table(rows: &Markup) -> Markup {
    html! { div class="scroll" { table { (rows) } } }
}

/// A section under its title, which folds it; it is unfolded at first if `is_open`.
pub(crate) fn folded(id: &str, title: &str, is_open: bool, body: &Markup) -> Markup {
    html! {
        details open[is_open] {
            summary { h2 { (title) } }
            // A browser unfolds a section when a link leads to something within it.
            div id=(id) class="folded" { (body) }
        }
    }
}

/// A sentence as HTML: names in backticks become code.
pub(crate) fn prose(sentence: &str) -> Markup {
    html! {
        @for (index, part) in sentence.split('`').enumerate() {
            @if index % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

/// Files with their hashes; nothing without files.
pub(crate) fn hashes(head: &str, files: &[FileHash]) -> Markup {
    html! {
        @if !files.is_empty() {
            div class="scroll" {
                table class="hashes" {
                    thead { (heads(&[Head::Text(head), Head::Text("SHA-256")])) }
                    tbody { @for file in files { tr { td { code { (file.name) } } td { code { (file.sha256) } } } } }
                }
            }
        }
    }
}
