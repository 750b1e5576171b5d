//! A fleet: its lists, one of its machines, and the way to a recording and back.

use std::sync::Arc;

use crate::clicks::{click, until, window};
use crate::sample::fleet;
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use parquet::arrow::ArrowWriter;
use socam_dashboard::{Dashboard, View};

fn opened(path: &std::path::Path) -> Harness<'static, Dashboard> {
    let mut window = window(Dashboard::default());
    window.state_mut().open([path.display().to_string()]);
    until(&mut window, "a table", |window| !window.state().is_busy());
    window.run_steps(2);
    window
}

fn type_into(window: &mut Harness<'static, Dashboard>, label: &str, text: &str) {
    let is_field = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == egui::Role::TextInput;
    window.get_all_by_label(label).find(is_field).unwrap().focus();
    window.run_steps(1);
    window.get_all_by_label(label).find(is_field).unwrap().type_text(text);
    window.run_steps(2);
}

/// Machines of the list from top to bottom.
fn listed(window: &Harness<'static, Dashboard>) -> Vec<String> {
    let all = window.get_all_by_label_contains("Machine ");
    let mut found: Vec<(f32, String)> = all
        .filter_map(|node| {
            let label = node.accesskit_node().label()?;
            Some((node.rect().top(), label.strip_prefix("Machine ")?.to_owned()))
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, name)| name).collect()
}

#[test]
fn machines_are_searched_sorted_and_filtered() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = opened(&fleet::written(folder.path(), fleet::rows()));
    assert_eq!(window.state().layout.view, View::Fleet);
    assert_eq!(window.state().problems().count(), 0);
    // Machines that stand out are listed first, in the order of their p-values.
    assert_eq!(listed(&window)[0], fleet::machine(fleet::RUBS));
    click(&mut window, "Sort by machine");
    assert_eq!(listed(&window)[0], "Plant 2, hall B, line 14, cell 3, spindle drive left, rev. C");
    click(&mut window, "Sort by machine");
    assert_eq!(listed(&window)[0], "SN023");
    click(&mut window, "Only those that stand out (5)");
    let notable = listed(&window);
    assert!(notable.len() == 5 && notable.contains(&fleet::machine(fleet::WEARS)), "{notable:?}");
    type_into(&mut window, "Search machines", "sn01");
    window.run_steps(3);
    assert_eq!(listed(&window), ["SN017", "SN011"]);
    window.get_by_label("2 of 24 machines");
}

#[test]
fn a_finding_leaves_its_machines_and_another_rate_lists_others() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = opened(&fleet::written(folder.path(), fleet::rows()));
    click(&mut window, "Finding Coulomb friction at load_bearing");
    assert_eq!(listed(&window).len(), 2);
    window.get_by_label("Chart torque of Coulomb friction at load_bearing, N m");
    click(&mut window, "Show all machines");
    assert!(listed(&window).len() > 10);
    click(&mut window, "Changes: 1 of 90");
    click(&mut window, "Differences: 2 of 90");
    click(&mut window, "Without a verdict: 2");
    window.get_by_label("byte 7: the log ends within a record");
}

#[test]
fn a_recording_of_a_machine_is_opened_and_the_fleet_is_still_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = fleet::rows();
    rows.retain(|row| row.machine_name() == fleet::machine(fleet::WEARS));
    let path = fleet::written(folder.path(), rows.clone());
    // In a folder of the table's folder; one of the six recordings is elsewhere.
    let csv: String = (0..500).map(|row| format!("{},{}\n", f64::from(row) * 1e-3, row % 7)).collect();
    let put = |root: &str, name: &str| {
        let file = folder.path().join(root).join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, format!("t_s,motor_speed_rad_s\n{csv}")).unwrap();
    };
    rows[1..].iter().for_each(|row| put("machines", &row.recording));
    put("other/disk", &rows[0].recording);
    let mut window = opened(&path);
    click(&mut window, "Machine SN011");
    until(&mut window, "a machine", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label("Chart shaft.stiffness, N m/rad");
    click(&mut window, &format!("Open {}", rows[1].recording));
    until(&mut window, "a recording", |window| !window.state().is_busy());
    window.run_steps(2);
    assert_eq!(window.state().layout.view, View::Time);
    assert_eq!(window.state().workspace.model().name, "two-mass");
    window.get_by_label("Chart motor_speed, rad/s");

    click(&mut window, "Fleet");
    assert_eq!(window.state().views.fleet.selected(), Some("SN011"));
    click(&mut window, "Open all recordings");
    until(&mut window, "recordings", |window| !window.state().is_busy());
    assert_eq!(window.state().workspace.entries.len(), 5);
    click(&mut window, "Fleet");
    type_into(
        &mut window,
        "Folder of the recordings",
        &folder.path().join("other/disk").display().to_string(),
    );
    click(&mut window, "Look there");
    until(&mut window, "a recording", |window| !window.state().is_busy());
    assert_eq!(window.state().workspace.entries.len(), 6);
    click(&mut window, "Fleet");
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    assert_eq!(window.state().views.fleet.selected(), None);
    assert_eq!(window.state().problems().count(), 0);
}

#[test]
fn a_table_that_is_damaged_or_of_another_version_says_so_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let path = fleet::written(folder.path(), fleet::rows());
    let whole = std::fs::read(&path).unwrap();
    let newer: Vec<u8> = {
        // The key stands in the footer, twice: for Parquet and for Arrow.
        let (old, new) = (b"socam.fleet/1", b"socam.fleet/9");
        let mut bytes = whole.clone();
        for at in 0..bytes.len() - old.len() {
            if &bytes[at..at + old.len()] == old {
                bytes[at..at + old.len()].copy_from_slice(new);
            }
        }
        bytes
    };
    let mut damaged = whole.clone();
    damaged[200..400].fill(0xa5);
    for (bytes, expected) in [
        (newer, "socam.fleet/9"),
        (damaged, "no table of a fleet"),
        (whole[..whole.len() / 2].to_vec(), "fleet.parquet"),
    ] {
        std::fs::write(&path, bytes).unwrap();
        let window = opened(&path);
        let problems: Vec<&str> = window.state().problems().collect();
        assert!(problems.len() == 1 && problems[0].contains(expected), "{expected}: {problems:?}");
        assert!(!problems[0].contains('\n'), "{problems:?}");
    }
}

#[test]
fn a_table_of_another_program_is_opened_as_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fleet.parquet");
    let column = |scale: f64| {
        let values = (0..500).map(|row| scale * f64::from(row));
        Arc::new(Float64Array::from_iter_values(values)) as ArrayRef
    };
    let batch = RecordBatch::try_from_iter([("t_s", column(1e-3)), ("motor_speed_rad_s", column(0.1))]);
    let batch = batch.unwrap();
    let file = std::fs::File::create(&path).unwrap();
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    let window = opened(&path);
    assert_eq!(window.state().problems().collect::<Vec<_>>(), Vec::<&str>::new());
    assert_eq!((window.state().workspace.entries.len(), window.state().layout.view), (1, View::Time));
    window.get_by_label("Chart motor_speed, rad/s");
}
