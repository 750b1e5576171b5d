//! Options of tasks in the window, and the command that does the same.

use std::path::Path;

use crate::clicks::{click, has, until, window, with};
use crate::files::save_as;
use crate::fits::two_mass;
use crate::sample;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_chart::theme::Look;
use socam_dashboard::spectra::ChartType;
use socam_dashboard::{Dashboard, View};
use socam_job::options::from_words;
use socam_job::{Check, Grid, Response, Settings, Watch};
use socam_model::Model;
use socam_workbench::job::Handle;
use socam_workbench::recording::Recording;
use socam_workbench::save::save;

/// A window with the files of these recordings, and their paths.
fn opened(
    folder: &Path,
    recordings: &[Recording],
    model: &str,
    view: View,
) -> (Harness<'static, Dashboard>, Vec<String>) {
    let mut dashboard = Dashboard::default();
    dashboard.use_model(Model::builtin(model).unwrap());
    dashboard.layout.folder = folder.into();
    let file = |(number, recording): (usize, &Recording)| {
        let path = folder.join(format!("run-{number}.csv"));
        save(recording, &path, &Handle::default()).unwrap();
        path.display().to_string()
    };
    let runs: Vec<String> = recordings.iter().enumerate().map(file).collect();
    dashboard.open(runs.clone());
    let mut window = window(dashboard);
    until(&mut window, "files", |window| !window.state().is_busy());
    window.state_mut().layout.view = view;
    window.run_steps(3);
    (window, runs)
}

/// Types a value into the field of this name.
fn enter(window: &mut Harness<'static, Dashboard>, label: &str, text: &str) {
    let is_field = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() != egui::Role::Label;
    window.get_all_by_label(label).find(is_field).unwrap().focus();
    window.run_steps(2);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.get_all_by_label(label).find(is_field).unwrap().type_text(text);
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
}

/// The settings of the command in sight: the words behind this beginning.
fn settings<T: Settings>(window: &Harness<'static, Dashboard>, beginning: &str) -> T {
    let line = window.get_by_label_contains("socam-host ").accesskit_node().value().unwrap();
    let rest = line.strip_prefix(beginning).unwrap_or_else(|| panic!("{line}\n{beginning}"));
    let words: Vec<String> = rest.split_whitespace().map(str::to_owned).collect();
    from_words(&words).unwrap()
}

#[test]
fn a_watch_has_the_settings_and_the_alarms_of_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let recordings = [two_mass(1, 0.4), two_mass(2, 0.0), two_mass(3, 0.0)];
    let (mut window, runs) = opened(folder.path(), &recordings, "two-mass", View::Watch);
    enter(&mut window, "False alarms per hour", "0.2");
    enter(&mut window, "Length of a block", "100ms");
    ["healthy run-1.csv", "healthy run-2.csv"].iter().for_each(|name| click(&mut window, name));
    let [run, first, second] = &runs[..] else { panic!("{runs:?}") };
    let beginning = format!("socam-host watch {run} --baseline {first} --baseline {second}");
    let task: Watch = settings(&window, &beginning);
    assert_eq!((task.watching.false_alarms_per_hour, task.watching.block_s), (0.2, Some(0.1)));

    let model = task.model.load().unwrap();
    let open = |run: &String| Grid::Even(&model).open(run).unwrap();
    let baseline = task.watching.baseline(&model, &[open(first), open(second)]).unwrap();
    let (watched, _) = task.run(&model, baseline, &open(run)).unwrap();
    assert!(!watched.alarms.is_empty());
    // The tab has the same name.
    window.get_all_by_label("Watch").last().unwrap().click();
    window.run_steps(2);
    until(&mut window, "the watch", |window| !window.state().is_busy());
    window.run_steps(2);
    assert_eq!(window.state().views.watch.alarms(), watched.alarms);
    window.get_by_label_contains("thresholds for 0.2 false alarms per hour");

    // What is over is shown around its first alarm, in the frame too, and leads to a diagnosis of what came after it.
    window.get_by_label("around alarm 1");
    let alarms = socam_plot::words::counted(watched.alarms.len(), "alarm", "alarms");
    window.get_by_label(&format!("Watch: {alarms}"));
    window.get_by_label("Diagnose from here").scroll_to_me();
    window.run_steps(3);
    click(&mut window, "Diagnose from here");
    until(&mut window, "the part", |window| !window.state().is_busy());
    assert_eq!(window.state().layout.view, View::Diagnosis);
    let part = window.state().workspace.entries.last().unwrap().recording.about.name.clone();
    assert!(part.starts_with(&format!("{run}@")) && part.contains(".."), "{part}");
}

#[test]
fn a_check_has_the_settings_and_the_findings_of_its_command() {
    let folder = tempfile::tempdir().unwrap();
    // The output turns 3 % slower than the gears say.
    let whole = sample::run(0, 4000);
    let mut columns: Vec<Vec<f64>> = (0..5).map(|channel| whole.samples.values(channel, 0..4000)).collect();
    columns[2].iter_mut().for_each(|speed| *speed *= 0.97);
    let slow = sample::of("runs/slow.mcap", whole.samples.times(0..4000), columns);
    let (mut window, runs) = opened(folder.path(), &[slow], "speed-o-cam", View::Check);
    let beginning = format!("socam-host check {}", runs[0]);
    let mut counts = Vec::new();
    for (label, text) in [
        ("Tolerance of speed ratios", "5"),
        ("Tolerance of speed ratios", "2"),
        ("Input, without a model", "command"),
    ] {
        enter(&mut window, label, text);
        until(&mut window, "a check", |window| !window.state().is_busy());
        window.run_steps(3);
        let task: Check = settings(&window, &beginning);
        let data = Grid::View.open(&runs[0]).unwrap();
        let check = task.run(task.load().unwrap().as_ref(), &data).unwrap();
        for finding in &check.findings {
            window.get_by_label_contains(&format!(": {}", socam_chart::numbers::plain(&finding.sentence())));
        }
        counts.push(check.findings.len());
        assert_eq!(window.query_all_by_label_contains("instead: ").count(), check.findings.len());
    }
    assert!(counts[0] + 1 == counts[1] && counts[1] != counts[2], "{counts:?}");
}

#[test]
fn a_response_has_the_settings_and_the_lines_of_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let (mut window, runs) = opened(folder.path(), &[sample::run(0, 4000)], "speed-o-cam", View::Frequency);
    window.state_mut().views.frequency.kind = ChartType::Response;
    window.run_steps(3);
    enter(&mut window, "Band, Hz", "2..20");
    until(&mut window, "a response", |window| !window.state().is_busy());
    let task: Response = settings(&window, &format!("socam-host identify --method frf {}", runs[0]));
    let model = task.model.load().unwrap();
    let responses = task.run(&model, &[Grid::View.open(&runs[0]).unwrap()], &runs).unwrap();
    let [answer] = &responses.answers[..] else { panic!("one output is named") };

    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::E);
    window.run_steps(3);
    save_as(&mut window, "response.csv");
    let table = std::fs::read_to_string(folder.path().join("response.csv")).unwrap();
    let name = std::path::Path::new(&runs[0]).file_name().unwrap().to_string_lossy();
    let head = format!("coherence,{name},\"frequency, Hz\",");
    let points = table.lines().filter_map(|line| line.strip_prefix(&head)).map(str::to_owned);
    let lines = answer.response.lines.iter().map(|line| format!("{},{}", line.frequency_hz, line.coherence));
    assert_eq!(points.collect::<Vec<_>>(), lines.collect::<Vec<_>>());
    assert!(answer.response.lines.iter().all(|line| (2.0..=20.0).contains(&line.frequency_hz)));
}

#[test]
fn the_window_follows_the_look_of_the_system_until_one_is_chosen() {
    let mut window = window(Dashboard::default());
    let look = |window: &mut Harness<'static, Dashboard>, system: egui::Theme| {
        window.input_mut().system_theme = Some(system);
        window.run_steps(3);
        (window.state().layout.look, window.ctx.theme())
    };
    assert_eq!(look(&mut window, egui::Theme::Light), (Look::Light, egui::Theme::Light));
    assert_eq!(look(&mut window, egui::Theme::Dark), (Look::Dark, egui::Theme::Dark));
    window.key_press_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::L);
    window.run_steps(3);
    assert_eq!(look(&mut window, egui::Theme::Dark), (Look::Light, egui::Theme::Light));
}

#[test]
fn a_view_gets_a_window_of_its_own_with_the_emergency_stop_and_comes_back() {
    let mut window = with(View::Check, 1);
    click(&mut window, "View");
    click(&mut window, "This view in a window of its own");
    window.get_by_label("Check has a window of its own");
    assert_eq!(window.get_all_by_label("EMERGENCY STOP").count(), 2);
    // The main window shows another view beside it.
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Num2);
    window.run_steps(4);
    window.get_by_label("Back to the main window");
    window.get_by_label("Chart command, V");
    click(&mut window, "Back to the main window");
    assert_eq!(window.state().layout.view, View::Check);
    assert!(!has(&window, "Back to the main window") && !has(&window, "Check has a window of its own"));
}
