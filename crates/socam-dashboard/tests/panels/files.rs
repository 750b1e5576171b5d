//! Files: opened, saved, exported, dropped; and the clipboard.

use crate::clicks::{click, until, window, with};
use crate::sample;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_dashboard::{Dashboard, View};

/// Types a name into the dialog that is open, and saves.
pub(crate) fn save_as(window: &mut Harness<'static, Dashboard>, name: &str) {
    window.get_by_label("Name").focus();
    window.run_steps(1);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.get_by_label("Name").type_text(name);
    window.run_steps(2);
    click(window, "Save");
}

#[test]
fn files_open_by_dialog_and_what_is_foreign_says_so_in_place() {
    let folder = tempfile::tempdir().unwrap();
    let csv: String = (0..500).map(|row| format!("{},{}\n", f64::from(row) * 1e-3, row % 7)).collect();
    std::fs::write(folder.path().join("good.csv"), format!("t_s,motor_speed_rad_s\n{csv}")).unwrap();
    std::fs::write(folder.path().join("foreign.json"), "{\"hello\": 1}").unwrap();
    std::fs::write(folder.path().join("broken.mcap"), "not a log at all").unwrap();
    std::fs::write(folder.path().join("picture.toml"), b"\x89PNG\r\n\xff").unwrap();
    let mut dashboard = Dashboard::default();
    dashboard.layout.folder = folder.path().into();
    let mut window = window(dashboard);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::O);
    window.run_steps(3);
    for name in ["good.csv", "foreign.json", "broken.mcap", "picture.toml"] {
        click(&mut window, name);
    }
    click(&mut window, "Open selected");
    until(&mut window, "files", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label("good.csv");
    window.get_by_label("Chart motor_speed, rad/s");
    let problems: Vec<String> = window.state().problems().map(str::to_owned).collect();
    assert!(problems.len() == 3, "{problems:?}");
    assert!(problems.iter().any(|text| text.contains("picture.toml is no text")), "{problems:?}");
    assert!(
        problems.iter().any(|text| text.contains("foreign.json") && text.contains("schema")),
        "{problems:?}"
    );
    assert!(problems.iter().any(|text| text.contains("broken.mcap")), "{problems:?}");
    window.get_all_by_label("Dismiss").next().unwrap().click();
    window.run_steps(2);
    assert_eq!(window.state().problems().count(), 2);
}

#[test]
fn what_is_seen_is_exported() {
    let folder = tempfile::tempdir().unwrap();
    let mut dashboard = Dashboard::default();
    dashboard.add_recording(sample::run(0, 4000));
    dashboard.layout.folder = folder.path().into();
    let mut window = window(dashboard);
    for name in ["view.png", "view.svg", "view.csv", "view.txt", "view.csv"] {
        window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::E);
        window.run_steps(3);
        save_as(&mut window, name);
        until(&mut window, "the file", |window| !window.state().is_busy());
        window.run_steps(1);
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("view.png").starts_with(b"\x89PNG") && read("view.png").len() > 20_000);
    let svg = String::from_utf8(read("view.svg")).unwrap();
    assert!(svg.contains(">motor_speed (rad/s)</text>") && svg.ends_with("</svg>\n"));
    let csv = String::from_utf8(read("view.csv")).unwrap();
    assert!(
        csv.lines().count() == 4001 && csv.starts_with("time_s,command_V,motor_speed_rad_s,"),
        "{}",
        &csv[..300]
    );
    assert!(window.state().problems().any(|text| text.contains("view.txt")));
    assert!(window.state().problems().any(|text| text.contains("view.csv exists already")));
}

#[test]
fn a_recording_is_saved_and_opens_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut dashboard = Dashboard::default();
    dashboard.add_recording(sample::run(0, 4000));
    dashboard.layout.folder = folder.path().into();
    let mut window = window(dashboard);
    for name in ["copy.csv", "copy.m"] {
        click(&mut window, "File");
        click(&mut window, "Save recording as .csv or .m...");
        save_as(&mut window, name);
        until(&mut window, "a file", |window| !window.state().is_busy());
        let data = socam_recording::Dataset::open(&folder.path().join(name).display().to_string()).unwrap();
        assert_eq!((data.rows(), data.channels().len()), (4000, 5), "{name}");
    }
    assert_eq!(window.state().problems().count(), 0);
}

#[test]
fn what_takes_long_can_be_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.csv");
    let rows: String = (0..400_000).map(|row| format!("{row},{}\n", row % 7)).collect();
    std::fs::write(&path, format!("t_s,motor_speed_rad_s\n{rows}")).unwrap();
    let mut window = window(Dashboard::default());
    window.state_mut().open([path.display().to_string()]);
    window.run_steps(2);
    click(&mut window, "Cancel");
    assert!(!window.state().is_busy());
    window.get_by_label("No recording is open");
    assert_eq!(window.state().problems().count(), 0);
}

#[test]
fn the_input_signal_is_cut_copied_and_pasted_by_menu_and_by_key() {
    let mut window = with(View::Time, 0);
    let before = window.state().workspace.signal.settings.clone();
    click(&mut window, "Input Signal");
    click(&mut window, "constant");
    let constant = window.state().workspace.signal.text();
    let copied = |window: &Harness<'static, Dashboard>| {
        window.output().platform_output.commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    };
    window.event(egui::Event::Cut);
    window.run_steps(1);
    assert_eq!(copied(&window), Some(constant.clone()));
    assert_eq!(window.state().workspace.signal.settings, before);

    // The test starts from another view, where a menu leads to the signal.
    click(&mut window, "Time");
    click(&mut window, "Edit");
    click(&mut window, "Paste input signal");
    window.event(egui::Event::Paste(constant.clone()));
    window.run_steps(2);
    assert_eq!(window.state().workspace.signal.text(), constant);
    window.event(egui::Event::Copy);
    window.run_steps(1);
    assert_eq!(copied(&window), Some(constant.clone()));
    window.event(egui::Event::Paste("a shopping list".into()));
    window.run_steps(2);
    assert!(window.state().problems().any(|text| text.contains("no input signal")));
    assert_eq!(window.state().workspace.signal.text(), constant);
}

#[test]
fn files_are_dropped_into_the_window() {
    #[derive(Debug)]
    struct Dropped(std::path::PathBuf);
    impl egui::DroppedFile for Dropped {
        fn path(&self) -> &std::path::Path {
            &self.0
        }
        fn bytes(&self) -> Result<Vec<u8>, String> {
            Err("it is opened by its path".into())
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let drop = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
        std::sync::Arc::new(Dropped(folder.path().join(name))) as egui::DroppedFileHandle
    };
    let mut window = window(Dashboard::default());
    let csv = "t_s,motor_speed_rad_s\n0,1\n0.001,2\n0.002,4\n";
    window.input_mut().dropped_files = vec![drop("dropped.csv", csv), drop("foreign.png", "\u{89}PNG")];
    window.run_steps(1);
    until(&mut window, "files", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label("dropped.csv");
    let problems: Vec<&str> = window.state().problems().collect();
    assert!(problems.len() == 1 && problems[0].contains("foreign.png"), "{problems:?}");
}

#[test]
fn recent_files_are_offered_and_those_that_are_gone_are_grey() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let csv = "t_s,motor_speed_rad_s\n0,1\n0.001,2\n0.002,4\n";
    ["a.csv", "b.csv"].iter().for_each(|name| std::fs::write(path(name), csv).unwrap());
    let mut window = window(Dashboard::default());
    window.state_mut().open([path("a.csv"), path("b.csv@0..0.001"), path("absent.csv")]);
    until(&mut window, "files", |window| !window.state().is_busy());
    assert_eq!(window.state().layout.recent, [path("b.csv@0..0.001"), path("a.csv")]);
    std::fs::remove_file(path("a.csv")).unwrap();
    click(&mut window, "File");
    click(&mut window, "Open recent");
    let is_grey = |name: &str| window.get_all_by_label(name).any(|node| node.accesskit_node().is_disabled());
    assert!(is_grey("a.csv") && !is_grey("b.csv@0..0.001"));
    window.get_by_role_and_label(egui::Role::Button, "b.csv@0..0.001").click();
    window.run_steps(3);
    until(&mut window, "a file", |window| !window.state().is_busy());
    assert_eq!(window.state().workspace.entries.len(), 3);
}

/// From a table without units to channels with units, by clicks; the file stays as it is.
#[test]
fn a_table_without_units_is_drawn_and_then_given_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.csv");
    let rows: String = (0..200).map(|row| format!("{},{}\n", 0.01 * f64::from(row), row % 7)).collect();
    std::fs::write(&path, format!("time,Motor Speed\n{rows}")).unwrap();
    let mut window = window(Dashboard::default());
    window.get_by_label("Try the virtual bench");
    window.state_mut().open([path.display().to_string()]);
    until(&mut window, "a table", |window| !window.state().is_busy());
    window.run_steps(3);
    assert_eq!(window.state().problems().count(), 0);
    let unit = |window: &Harness<'static, Dashboard>| {
        window.state().workspace.entries[0].recording.about.channels[0].unit.symbol()
    };
    assert_eq!(unit(&window), "1");
    window.get_by_label_contains("drawn as plain numbers");
    click(&mut window, "Set units...");
    click(&mut window, "Take rpm for Motor Speed");
    click(&mut window, "Open with these");
    until(&mut window, "the table again", |window| !window.state().is_busy());
    window.run_steps(3);
    assert_eq!(window.state().workspace.entries.len(), 1);
    assert_eq!(unit(&window), "rad/s");
    assert!(folder.path().join("lab.csv.map.toml").is_file());
}
