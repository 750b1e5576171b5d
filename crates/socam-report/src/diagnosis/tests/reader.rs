//! A page as a reader sees it, and what must hold of every page.

use std::{fs, path::Path};

use socam_findings::{Diagnosis, Evidence};
use socam_model::Model;

use super::{KEEP, MOST_BYTES, drawing};
use crate::{FileHash, Provenance, diagnosis::write};

/// Writes a report, checks what must hold of every page, and returns its text as a reader sees it, a line per element.
pub(super) fn report(name: &str, diagnosis: &Diagnosis, evidence: &Evidence, model: &Model) -> String {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), diagnosis, evidence, (model, None), &made()).unwrap();
    let page = fs::read_to_string(dir.path().join("index.html")).unwrap();
    if let Some(keep) = std::env::var_os(KEEP) {
        fs::create_dir_all(&keep).unwrap();
        fs::write(Path::new(&keep).join(format!("{name}.html")), &page).unwrap();
    }
    assert!(page.len() < MOST_BYTES, "{name}: {} bytes", page.len());
    assert!(!page.contains("<script") && !page.contains("http"), "{name} is self-contained");

    // The few tags that HTML leaves open, closed for an XML parser.
    let (head, body) = page.split_once("</head>").unwrap();
    let xml = format!(
        "{}</head>{body}",
        head.replace("<!DOCTYPE html>", "").replace(";\">", ";\"/>").replace("<meta ", "<meta_ ")
    );
    let xml = close_metas(&xml).replace("<details open>", "<details open=\"\">");
    let document = roxmltree::Document::parse(&xml).unwrap_or_else(|e| panic!("{name}: {e}"));
    for node in document.descendants().filter(|node| node.is_element()) {
        for attribute in node.attributes().filter(|attribute| attribute.name() != "aria-label") {
            assert_numbers(name, attribute.value());
        }
    }
    document
        .descendants()
        .filter(|node| node.has_tag_name("svg"))
        .for_each(|svg| drawing::assert_texts_apart(name, &svg));
    assert_contents(name, &document);
    let body = document.descendants().find(|node| node.has_tag_name("body")).unwrap();
    let text: String = body.descendants().filter_map(|node| text_of(&node)).collect();
    assert!(!text.contains("NaN") && !text.contains("inf "), "{name}: {text}");
    text
}

/// What a page is made from, the same on every machine.
pub(super) fn made() -> Provenance {
    Provenance {
        command: "socam-host diagnose 'my runs/steps-1.mcap' --report report".into(),
        date: "2026-11-26 04:10 UTC".into(),
        files: vec![FileHash::of_content("steps-1.mcap", b"abc")],
    }
}

/// Every link leads to one place of the page, and the contents name every section.
fn assert_contents(name: &str, document: &roxmltree::Document<'_>) {
    let all = || document.descendants().filter(roxmltree::Node::is_element);
    let ids: Vec<&str> = all().filter_map(|node| node.attribute("id")).collect();
    let links: Vec<&str> =
        all().filter_map(|node| node.attribute("href")).filter_map(|link| link.strip_prefix('#')).collect();
    for link in &links {
        assert_eq!(ids.iter().filter(|id| *id == link).count(), 1, "{name}: #{link}");
    }
    let sections = all().filter(|node| node.attribute("class") == Some("folded"));
    let sections: Vec<&str> = sections.filter_map(|node| node.attribute("id")).collect();
    assert!(sections.len() > 2, "{name}: {sections:?}");
    assert!(sections.iter().all(|id| links.contains(id)), "{name}: {sections:?} are not all in {links:?}");
}

fn close_metas(html: &str) -> String {
    html.split("<meta_ ")
        .enumerate()
        .map(|(index, part)| match (index, part.split_once('>')) {
            (1.., Some((meta, rest))) => format!("<meta {}/>{rest}", meta.trim_end_matches('/')),
            _ => part.to_owned(),
        })
        .collect()
}

fn assert_numbers(name: &str, attribute: &str) {
    for word in ["NaN", "inf", "-0.0 "] {
        assert!(!attribute.contains(word), "{name}: {attribute}");
    }
}

/// The text of a paragraph, a cell, a label: the outermost element that holds text of its own.
fn text_of(node: &roxmltree::Node<'_, '_>) -> Option<String> {
    const LINES: [&str; 13] =
        ["p", "h1", "h2", "h3", "h4", "tr", "dt", "dd", "li", "figcaption", "text", "title", "b"];
    let outermost = LINES.contains(&node.tag_name().name())
        && !node.ancestors().skip(1).any(|above| LINES.contains(&above.tag_name().name()));
    // Ticks and legends are what `plot` is tested for.
    if !outermost || node.attribute("class") == Some("tick") {
        return None;
    }
    let of_cells = node.has_tag_name("tr");
    let separate = if of_cells { " | " } else { "" };
    let parts: Vec<String> = if of_cells {
        node.children().map(|cell| inner_text(&cell)).collect()
    } else {
        vec![inner_text(node)]
    };
    Some(format!("{}\n", parts.join(separate).trim_end()))
}

fn inner_text(node: &roxmltree::Node<'_, '_>) -> String {
    node.descendants().filter(|part| part.is_text()).filter_map(|part| part.text()).collect()
}
