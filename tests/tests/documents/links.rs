//! Links of documents to files of the project, and to headings within documents.

use super::{files, name, root};

/// Targets of the links of a document, without those in blocks of code.
fn targets(text: &str) -> Vec<String> {
    let mut is_code = false;
    let mut found = Vec::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            found.extend(
                line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(to, _)| to.to_owned()),
            );
        }
    }
    found
}

/// The name under which a heading is linked.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().chars();
    let kept = kept.filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

#[test]
fn every_link_of_a_document_leads_to_something() {
    let documents: Vec<_> = files(&root())
        .into_iter()
        .filter(|path| path.extension().is_some_and(|ending| ending == "md"))
        .collect();
    assert!(documents.len() > 30, "{} documents were found", documents.len());
    let mut dead = Vec::new();
    for document in documents {
        let text = std::fs::read_to_string(&document).unwrap();
        for target in targets(&text) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            let (path, heading) = target.split_once('#').unwrap_or((&target, ""));
            let leads_to =
                if path.is_empty() { document.clone() } else { document.parent().unwrap().join(path) };
            let has_heading = heading.is_empty()
                || std::fs::read_to_string(&leads_to).is_ok_and(|text| {
                    text.lines().any(|line| line.starts_with('#') && anchor(line) == heading)
                });
            if !leads_to.exists() || !has_heading {
                dead.push(format!("{}: {target}", name(&document)));
            }
        }
    }
    assert!(dead.is_empty(), "links that lead nowhere:\n{}", dead.join("\n"));
}

#[test]
fn headings_are_linked_as_pages_of_git_do_it() {
    assert_eq!(anchor("## What a column is, by its `name`"), "what-a-column-is-by-its-name");
}
