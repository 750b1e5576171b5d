//! The lists of commands against the program's.

use socam_tests::run;

use super::read;

/// The commands that the program lists.
fn commands() -> Vec<String> {
    let help = run(["--help"]).done();
    let list = help.split_once("Commands:\n").unwrap().1.split("\n\n").next().unwrap();
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    names.map(str::to_owned).collect()
}

#[test]
fn the_tour_has_every_command() {
    let commands = commands();
    assert!(commands.len() > 20, "{commands:?}");
    let tour = read("docs/tour.md");
    let missing: Vec<&String> =
        commands.iter().filter(|command| !tour.contains(&format!("socam-host {command}"))).collect();
    assert!(
        missing.is_empty(),
        "docs/tour.md has no line `socam-host COMMAND` of these; add an example: {missing:?}"
    );
}

#[test]
fn documents_name_no_command_that_does_not_exist() {
    let commands = commands();
    let mut unknown = Vec::new();
    for document in super::files(&super::root()) {
        if document.extension().is_none_or(|ending| ending != "md") {
            continue;
        }
        let text = std::fs::read_to_string(&document).unwrap();
        for line in text.lines().map(str::trim_start) {
            let Some(rest) = line.strip_prefix("socam-host ") else { continue };
            let command = rest.split_whitespace().next().unwrap_or_default();
            let is_word = !command.is_empty() && command.chars().all(|c| c.is_ascii_lowercase() || c == '-');
            if is_word && !command.starts_with('-') && !commands.iter().any(|known| known == command) {
                unknown.push(format!("{}: {line}", super::name(&document)));
            }
        }
    }
    assert!(unknown.is_empty(), "lines of commands that the program does not have:\n{}", unknown.join("\n"));
}
