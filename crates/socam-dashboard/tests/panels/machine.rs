//! The machine: its elements, a new model from words, values that are changed, the motion of a recording, an animation, and the rail.

use crate::clicks::{click, until, window};
use crate::files::save_as;
use crate::fits::two_mass;
use crate::sample::{self, machine::simulated};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_dashboard::machine::Colouring;
use socam_dashboard::{Dashboard, View};
use socam_model::Model;

type Window = Harness<'static, Dashboard>;

fn machine(model: &str, runs: u32) -> Window {
    let mut dashboard = Dashboard::default();
    dashboard.use_model(Model::builtin(model).unwrap());
    dashboard.simulate_by(simulated);
    (1..=runs).for_each(|number| dashboard.add_recording(two_mass(number, 0.0)));
    dashboard.layout.view = View::Machine;
    window(dashboard)
}

/// Types into a field in place of what stands there.
fn write(window: &mut Window, label: &str, text: &str) {
    let is_field = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() != egui::Role::Label;
    window.get_all_by_label(label).find(is_field).unwrap().focus();
    window.run_steps(2);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.get_all_by_label(label).find(is_field).unwrap().type_text(text);
    window.run_steps(3);
}

fn value(window: &Window, name: &str) -> (f64, bool) {
    let model = window.state().workspace.model();
    let parameter = &model.parameters[model.parameter(name).unwrap()];
    (parameter.value, parameter.fixed)
}

#[test]
fn an_element_shows_what_it_has_and_its_values_are_changed_and_taken_back() {
    let mut window = machine("two-mass", 0);
    window.get_by_label("A recording that is open and shown moves the machine.");
    click(&mut window, "shaft: spring with damper");
    window.get_by_label("Value of stiffness");
    assert!(window.query_by_label("Value of load_inertia").is_none());
    write(&mut window, "Value of stiffness", "175");
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    assert_eq!(value(&window, "stiffness"), (175.0, false));
    assert!(window.state().workspace.model().text.contains("stiffness = { value = 175"));
    click(&mut window, "Fixed: stiffness");
    assert_eq!(value(&window, "stiffness"), (175.0, true));
    click(&mut window, "Undo the change");
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.run_steps(3);
    assert_eq!(value(&window, "stiffness"), (150.0, false));
    click(&mut window, "Redo the change");
    assert_eq!(value(&window, "stiffness"), (175.0, false));

    // A value outside its bounds is refused with the sentence of the model file.
    write(&mut window, "Value of stiffness", "-3");
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    assert_eq!(value(&window, "stiffness"), (175.0, false));
    window.get_by_label_contains("leave the spring out");
    click(&mut window, "motor_speed: speed, predicted by the model");
    window.get_by_label_contains("column motor_speed_rad_s, predicted by the model");
    click(&mut window, "All parameters");
    window.get_by_label("Value of load_inertia");
}

#[test]
fn a_new_model_is_described_used_and_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = machine("two-mass", 0);
    window.state_mut().layout.folder = folder.path().into();
    click(&mut window, "New model...");
    window.get_by_label("gear: gear, 5 : 1");
    write(&mut window, "Parts", "motor 1kgcm2 | copling jaw | load 2kgm2");
    window.get_by_label_contains("copling jaw: a part begins with one of");
    assert!(window.get_by_label("Use").accesskit_node().is_disabled());
    write(&mut window, "Parts", "motor 1kgcm2 | coupling jaw | load 2kgm2");
    window.get_by_label("coupling: spring with damper");
    write(&mut window, "Measured", "speed@lod");
    window.get_by_label_contains("speed@lod: ");
    write(&mut window, "Measured", "speed@load");
    write(&mut window, "Name of the model", "axis");
    click(&mut window, "Save...");
    save_as(&mut window, "axis.toml");
    let text = std::fs::read_to_string(folder.path().join("axis.toml")).unwrap();
    assert_eq!(Model::parse(&text).unwrap().name, "axis");
    click(&mut window, "Use");
    window.run_steps(2);
    assert_eq!(window.state().workspace.model().name, "axis");
    window.get_by_label("coupling: spring with damper");
}

#[test]
fn a_recording_moves_the_machine_beside_its_prediction() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = machine("two-mass", 1);
    window.state_mut().layout.folder = folder.path().into();
    until(&mut window, "the motion", |window| !window.state().is_busy());
    window.run_steps(2);
    until(&mut window, "the prediction", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label_contains("Hollow needles: predicted");
    window.state_mut().views.machine.player.time_s = 1.0;
    window.state_mut().views.machine.player.colouring = Colouring::Torque;
    window.run_steps(2);
    click(&mut window, "shaft: spring with damper");
    let said = window
        .get_all_by_label_contains("torque predicted ")
        .filter_map(|node| node.accesskit_node().value());
    assert!(said.into_iter().any(|said| said.ends_with(" N m")));

    click(&mut window, "Play");
    window.run_steps(5);
    let later = window.state().views.machine.player.time_s;
    assert!(later > 1.0 && later < 1.5, "{later}");
    click(&mut window, "Pause");
    click(&mut window, "To the start");
    assert_eq!(window.state().views.machine.player.time_s, 0.0);

    window.key_press_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::G);
    until(&mut window, "the animation", |window| {
        window.query_by_label("Save the animation (.png)").is_some()
    });
    save_as(&mut window, "machine.png");
    let bytes = std::fs::read(folder.path().join("machine.png")).unwrap();
    let reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
    assert_eq!(reader.info().animation_control.unwrap().num_frames, 45);
}

#[test]
fn what_cannot_move_says_why() {
    let mut window = machine("emps", 1);
    until(&mut window, "a refusal", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label_contains("has none of the speeds and angles that the model emps reads");
}

#[test]
fn the_rail_has_the_verdict_of_each_step() {
    let mut window = machine("two-mass", 1);
    for step in ["Check", "Identify", "Diagnose", "Record next"] {
        window.get_by_label(&format!("Step {step}: not done"));
    }
    click(&mut window, "Step Check: not done");
    assert_eq!(window.state().layout.view, View::Check);
    until(&mut window, "a check", |window| {
        window.query_by_label("Step Check: not done").is_none() && !window.state().is_busy()
    });
    window.run_steps(2);
    let checked = window.get_by_label_contains("Step Check: ").accesskit_node().label().unwrap();
    assert!(checked.contains("fit"), "{checked}");
    let diagnosis = socam_workbench::document::parse("diagnosis.json", sample::DIAGNOSIS).unwrap();
    window.state_mut().show(diagnosis);
    window.run_steps(3);
    window.get_by_label_contains("Step Diagnose: Physics is missing");
    assert!(window.state().workspace.rail.diagnosis.is_some());

    // The last step leads to what it says, below findings that fill a low window.
    window.set_size(egui::vec2(1280.0, 420.0));
    window.run_steps(3);
    let next = |window: &Window| window.get_by_label("What to record next").rect();
    assert!(next(&window).top() > 420.0, "{}", next(&window));
    window.get_by_label_contains("Step Record next: ").click();
    window.run_steps(5);
    assert!(next(&window).bottom() < 420.0, "{}", next(&window));
}

#[test]
fn a_new_model_says_which_columns_the_recording_lacks() {
    let mut window = machine("two-mass", 1);
    click(&mut window, "New model...");
    write(&mut window, "Parts", "motor 1kgcm2 | coupling jaw | load 2kgm2");
    write(&mut window, "Drives", "torque@motor:motor_torque_Nm");
    write(&mut window, "Measured", "speed@load:shaft_rad_s");
    window.get_by_label_contains("two-mass-1.csv has no shaft_rad_s: write the column of it");
    write(&mut window, "Measured", "speed@load:load_speed_rad_s");
    assert!(window.query_by_label_contains("two-mass-1.csv has no").is_none());
    click(&mut window, "Use");
    window.run_steps(2);
    let values: Vec<String> =
        window.get_all_by_label("Model").filter_map(|node| node.accesskit_node().value()).collect();
    assert!(values.iter().any(|own| own == "machine, described here"), "{values:?}");
}

fn column(window: &Window, channel: &str) -> String {
    let mut channels = window.state().workspace.model().channels.iter();
    channels.find(|own| own.name == channel).unwrap().column.clone()
}

#[test]
fn columns_are_wired_to_sensors_by_dragging_and_by_a_list() {
    let mut window = machine("two-mass", 1);
    click(&mut window, "Columns of two-mass-1.csv");
    window.get_by_label("read by load_speed");
    let sensor = "motor_speed: speed, predicted by the model";
    let place = |window: &Window, label: &str| window.get_by_label(label).rect().center();
    let drag_to = |window: &mut Window, column: &str| {
        let [from, to] = [column, sensor].map(|label| place(window, label));
        crate::time::drag(window, from, to);
    };
    drag_to(&mut window, "load_speed_rad_s");
    assert_eq!(column(&window, "motor_speed"), "load_speed_rad_s");
    assert!(window.state().workspace.model().text.contains("column = \"load_speed_rad_s\""));
    window.get_by_label("read by motor_speed, load_speed");
    click(&mut window, "Undo the change");
    assert_eq!(column(&window, "motor_speed"), "motor_speed_rad_s");
    // A torque is no speed: the sentence of the model file says so, and nothing changes.
    drag_to(&mut window, "motor_torque_Nm");
    assert_eq!(column(&window, "motor_speed"), "motor_speed_rad_s");
    assert!(window.get_all_by_label_contains("in N m, but a speed is in rad/s").count() > 0);
    // By the keyboard: the sensor is selected, and its list opened.
    window.get_by_label(sensor).focus();
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    window.get_by_label("Column of motor_speed").focus();
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    let choice = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == egui::Role::Button;
    window.get_all_by_label("load_speed_rad_s").find(choice).unwrap().focus();
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
    assert_eq!(column(&window, "motor_speed"), "load_speed_rad_s");
}
