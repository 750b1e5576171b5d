//! What an analyst does in the view over time: formulas, units, histograms, tables of values, alignment.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_dashboard::{Dashboard, Layout, View};

use crate::clicks::{click, copied, has, press, until, window, with};
use crate::sample;

type Window = Harness<'static, Dashboard>;

fn choose_formula(window: &mut Window) {
    press(window, Key::D);
    click(window, "operation");
    click(window, "formula");
}

#[test]
fn a_formula_is_written_with_completed_names_and_its_mistakes_are_said() {
    let mut window = with(View::Time, 1);
    choose_formula(&mut window);
    // The dialog begins with the first channel; here it is replaced.
    let field = window.get_all_by_label("formula").last().unwrap();
    field.focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    window.get_all_by_label("formula").last().unwrap().type_text("torque_in + motor");
    window.run_steps(3);
    window.get_by_label_contains("no channel that is shown is called motor");
    assert!(!has(&window, "Insert torque_out"), "only names that begin as the last word");
    click(&mut window, "Insert motor_speed");
    window.get_by_label_contains("character 11: + joins \"N m\" and \"rad/s\"");
    window.get_all_by_label("formula").last().unwrap().focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    let text = "torque_out*output_speed/(torque_in*motor_speed)";
    window.get_all_by_label("formula").last().unwrap().type_text(text);
    window.run_steps(3);
    window.get_by_label("name").focus();
    window.run_steps(2);
    window.get_by_label("name").type_text("efficiency");
    window.run_steps(3);
    window.get_by_label("efficiency, 1");
    click(&mut window, "Add channel");
    until(&mut window, "the formula", |window| has(window, "Chart efficiency, 1"));
    // It is part of the layout.
    let layout: Layout =
        serde_json::from_str(&serde_json::to_string(&window.state().layout).unwrap()).unwrap();
    assert_eq!(layout.plots.derived[0].formula.as_deref(), Some(text));
    // The list removes it.
    click(&mut window, "Remove efficiency");
    assert!(!has(&window, "Chart efficiency, 1"));
}

#[test]
fn speeds_are_shown_in_revolutions_per_minute_and_stay_in_si() {
    let mut window = with(View::Time, 1);
    click(&mut window, "Units");
    click(&mut window, "Show rad/s in rpm");
    assert!(has(&window, "Chart motor_speed, rpm") && has(&window, "Chart output_speed, rpm"));
    assert!(has(&window, "motor_speed, rpm") && has(&window, "Chart torque_in, N m"));
    press(&mut window, Key::T);
    let table = copied(&mut window, "Copy table");
    let line = table.lines().find(|line| line.contains("motor_speed")).unwrap();
    let cells: Vec<&str> = line.split('\t').collect();
    let greatest: f64 = cells[8].parse().unwrap();
    let run = sample::run(0, 4000).samples;
    let [_, most] = run.extremes(1, 0..4000).unwrap();
    assert!(cells[2] == "rpm" && cells[3] == "4000", "{line}");
    assert!((greatest - most * 60.0 / std::f64::consts::TAU).abs() < 1e-2, "{line}");
    // One channel goes its own way, the setting is remembered, and undo takes it back.
    click(&mut window, "More about output_speed");
    click(&mut window, "Unit");
    click(&mut window, "Show output_speed in deg/s");
    assert!(has(&window, "Chart output_speed, deg/s") && has(&window, "Chart motor_speed, rpm"));
    let layout: Layout =
        serde_json::from_str(&serde_json::to_string(&window.state().layout).unwrap()).unwrap();
    assert_eq!(layout.plots.units.all["rad/s"], "rpm");
    window.run_steps(40);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(3);
    assert!(!has(&window, "Chart output_speed, deg/s"));
}

#[test]
fn a_histogram_says_mean_and_deviation_and_a_table_has_the_values() {
    let mut window = with(View::Time, 2);
    for channel in ["output_speed, rad/s", "torque_in, N m", "torque_out, N m"] {
        click(&mut window, channel);
    }
    press(&mut window, Key::H);
    until(&mut window, "the counts", |window| !window.state().is_busy());
    window.run_steps(2);
    assert!(has(&window, "Chart share of the samples of command, %"));
    let run = sample::run(0, 4000).samples;
    let mean = run.values(0, 0..4000).iter().sum::<f64>() / 4000.0;
    window.get_by_label_contains(&format!("multisine-0.mcap: mean {:.4}", mean.abs()));
    press(&mut window, Key::V);
    window.state_mut().views.time.x = Some([1.0, 1.0035]);
    window.run_steps(3);
    window.get_by_label("4 rows in sight");
    let table = copied(&mut window, "Copy rows");
    let lines: Vec<Vec<&str>> = table.lines().map(|line| line.split('\t').collect()).collect();
    assert_eq!(lines[0][..3], ["time, s", "command, V", "motor_speed, rad/s"]);
    assert_eq!((lines.len(), lines[1][0], lines[4][0]), (5, "1.000000", "1.003000"));
    let value: f64 = lines[3][2].parse().unwrap();
    assert!((value - run.values(1, 1002..1003)[0]).abs() < 1e-3);
}

/// A recording whose speed sweeps, so that no part of it is like another one.
fn sweep(name: &str, delay_s: f64) -> socam_workbench::recording::Recording {
    let time_s: Vec<f64> = (0..4000).map(|row| f64::from(row) * 1e-3).collect();
    let value = |t: &f64| (3.0 * (t + delay_s) + 2.0 * (t + delay_s).powi(2)).sin();
    let values: Vec<f64> = time_s.iter().map(value).collect();
    sample::of(name, time_s, vec![values])
}

#[test]
fn a_recording_is_laid_over_another_and_a_periodic_one_is_refused() {
    let mut dashboard = Dashboard::default();
    dashboard.add_recording(sweep("one.csv", 0.0));
    dashboard.add_recording(sweep("two.csv", 0.25));
    let mut window = window(dashboard);
    click(&mut window, "More about two.csv");
    click(&mut window, "Align");
    until(&mut window, "the shift", |window| !window.state().is_busy());
    window.run_steps(2);
    let shift_s = window.state().workspace.entries[1].shift_s;
    assert!((shift_s - 0.25).abs() < 1e-4, "{shift_s}");
    window.get_by_label_contains("two.csv is shifted by +0.25");
    window.get_by_label_contains("command then correlates with that of one.csv at 1.0000");
    window.run_steps(40);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(3);
    assert_eq!(window.state().workspace.entries[1].shift_s, 0.0, "undo takes it back");
    window.state_mut().add_recording(sample::of(
        "sine.csv",
        (0..4000).map(|row| f64::from(row) * 1e-3).collect(),
        vec![(0..4000).map(|row| (0.05 * f64::from(row)).sin()).collect()],
    ));
    window.run_steps(2);
    click(&mut window, "More about sine.csv");
    click(&mut window, "Align");
    until(&mut window, "the answer", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label_contains("sine.csv is not laid over one.csv: of command, ");
}

/// Two sines: the shifts by a period are offered, one of them is chosen in the menu, and undo takes it back.
#[test]
fn a_signal_that_repeats_itself_offers_the_shifts_that_fit() {
    let sine = |name: &str, late_s: f64| {
        let times = || (0..4000).map(|row| f64::from(row) * 1e-3);
        sample::of(name, times().collect(), vec![times().map(|t| (20.0 * (t - late_s)).sin()).collect()])
    };
    let mut dashboard = Dashboard::default();
    dashboard.layout.view = View::Time;
    dashboard.add_recording(sine("one.csv", 0.0));
    dashboard.add_recording(sine("two.csv", 0.05));
    let mut window = window(dashboard);
    click(&mut window, "More about two.csv");
    click(&mut window, "Align");
    until(&mut window, "the shifts", |window| !window.state().is_busy());
    window.run_steps(2);
    assert_eq!(window.state().workspace.entries[1].shift_s, 0.0, "nothing is chosen yet");
    window
        .get_by_label_contains("of two.csv repeats itself, so that several shifts lay it over one.csv alike");
    click(&mut window, "More about two.csv");
    let period_s = std::f64::consts::TAU / 20.0;
    let labels: Vec<String> = window
        .get_all_by_label_contains("Shift two.csv by ")
        .filter_map(|node| node.accesskit_node().label())
        .collect();
    assert_eq!(labels.len(), 6, "{labels:?}");
    click(&mut window, &labels[1]);
    let shift_s = window.state().workspace.entries[1].shift_s;
    assert!((shift_s - (period_s - 0.05)).abs() < 1e-4, "{shift_s} {labels:?}");
    window.run_steps(40);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(3);
    assert_eq!(window.state().workspace.entries[1].shift_s, 0.0, "undo takes it back");
}

#[test]
fn a_session_is_saved_and_shows_everything_again() {
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("runs");
    std::fs::create_dir(&runs).unwrap();
    for name in ["one.csv", "two.csv"] {
        let rows = (0..500).map(|row| format!("{},{},{}\n", f64::from(row) * 1e-3, row % 7, row % 5));
        let text = format!("time_s,command_V,motor_speed_rad_s\n{}", rows.collect::<String>());
        std::fs::write(runs.join(name), text).unwrap();
    }
    std::fs::write(folder.path().join("fit.json"), sample::IDENTIFICATION).unwrap();
    let mut dashboard = Dashboard::default();
    dashboard.layout.folder = folder.path().into();
    let mut window = window(dashboard);
    let paths = ["runs/one.csv", "runs/two.csv", "fit.json"];
    window.state_mut().open(paths.map(|path| folder.path().join(path).display().to_string()));
    until(&mut window, "the files", |window| !window.state().is_busy());
    window.state_mut().layout.view = View::Time;
    window.state_mut().add_recording(sample::run(0, 100));
    window.state_mut().workspace.entries[1].shift_s = 0.25;
    window.state_mut().workspace.entries[0].shown = false;
    window.state_mut().views.time.x = Some([0.1, 0.4]);
    window.run_steps(3);
    click(&mut window, "Units");
    click(&mut window, "Show rad/s in rpm");
    // A note by keys, at the middle of what is seen of the recording that is shown.
    window.key_press(egui::Key::N);
    window.run_steps(3);
    window.event(egui::Event::Text("it squeaks".into()));
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    let noted = &window.state().workspace.entries[1].notes;
    assert!(noted.len() == 1 && noted[0].text == "it squeaks");
    click(&mut window, "File");
    click(&mut window, "Save session...");
    click(&mut window, "Save");
    // What is in no file is said.
    window.get_by_label_contains("is written without what is in no file: multisine-0.mcap");
    let path = folder.path().join("bench.session.json");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("\"runs/one.csv\"") && text.contains("\"fit.json\""), "{text}");
    let kept = window.state().views.time.arrangement();
    // In another window, the folder at another place and a file gone.
    let moved = tempfile::tempdir().unwrap();
    std::fs::rename(folder.path(), moved.path().join("lab")).unwrap();
    let mut window = crate::clicks::window(Dashboard::default());
    window.state_mut().open([moved.path().join("lab/bench.session.json").display().to_string()]);
    until(&mut window, "the session", |window| !window.state().is_busy());
    window.run_steps(2);
    let state = window.state();
    let shown: Vec<_> = state.workspace.entries.iter().map(|entry| (entry.shown, entry.shift_s)).collect();
    assert_eq!(shown, [(false, 0.0), (true, 0.25)]);
    assert_eq!(state.workspace.entries[1].notes[0].text, "it squeaks");
    assert_eq!((state.views.time.x, state.layout.view), (Some([0.1, 0.4]), View::Time));
    assert_eq!(state.views.time.arrangement().units, kept.units);
    assert!(state.views.identify.page.shown.is_some() && state.problems().count() == 0);
    std::fs::remove_file(moved.path().join("lab/runs/two.csv")).unwrap();
    window.state_mut().open([moved.path().join("lab/bench.session.json").display().to_string()]);
    until(&mut window, "the session", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label_contains("the session names 1 file that is not there: ");
    assert_eq!(window.state().workspace.entries.len(), 1);
}

#[test]
fn the_window_of_spectra_is_chosen_and_part_of_the_layout() {
    let mut window = with(View::Frequency, 1);
    until(&mut window, "the spectra", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label_contains("s, 14 windows averaged, mean removed");
    for (list, choice) in
        [("Window", "flat top"), ("length", "256 samples"), ("detrend", "trend"), ("overlap", "75 %")]
    {
        click(&mut window, list);
        click(&mut window, choice);
    }
    until(&mut window, "the spectra", |window| !window.state().is_busy());
    window.run_steps(2);
    // 4000 samples have 59 windows of 256 that are 64 apart.
    window.get_by_label_contains("s, 59 windows averaged, straight line removed");
    // A range in sight has fewer.
    window.state_mut().views.time.x = Some([1.0, 1.5115]);
    window.state_mut().workspace.in_sight = Some([1.0, 1.5115]);
    window.run_steps(2);
    click(&mut window, "Range in sight");
    until(&mut window, "the spectra", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label_contains("s, 5 windows averaged");
    let layout: Layout =
        serde_json::from_str(&serde_json::to_string(&window.state().layout).unwrap()).unwrap();
    let spectra = layout.plots.spectra;
    assert_eq!((spectra.length, spectra.overlap_percent, spectra.in_sight), (Some(256), 75, true));
    // A spectrogram has the same window.
    window.state_mut().layout.view = View::Time;
    window.run_steps(2);
    press(&mut window, Key::G);
    until(&mut window, "the picture", |window| !window.state().is_busy());
    click(&mut window, "Window of the spectrogram");
    click(&mut window, "Window Blackman");
    assert_eq!(window.state().layout.plots.spectra.window.name(), "Blackman");
}

#[test]
fn times_of_day_stand_below_the_plots_where_a_recording_states_them() {
    let mut window = with(View::Time, 1);
    assert!(!has(&window, "Time of day"));
    let epoch = socam_recording::Epoch::Date(1_777_644_200_000_000_000);
    window.state_mut().workspace.entries[0].recording.about.epoch = Some(epoch);
    window.run_steps(2);
    click(&mut window, "Time of day");
    assert!(window.state().layout.plots.clock_time);
}
