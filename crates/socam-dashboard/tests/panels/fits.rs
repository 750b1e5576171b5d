//! Identification and diagnosis in the window: set up, run, cancelled, saved, and refused.

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use crate::clicks::{click, has, until, window};
use crate::files::save_as;
use crate::sample;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_dashboard::{Dashboard, View};
use socam_diagnose::{DiagnoseError, HeldOut, Options, diagnose};
use socam_identify::{IdentifyError, Intersample, Observer, Predictor, Progress, ProgressMonitor, Start};
use socam_model::Model;
use socam_recording::{Channel, Unit};
use socam_workbench::document::{Document, parse};
use socam_workbench::job::Handle;
use socam_workbench::recording::Recording;
use socam_workbench::setup::Role;

/// Stiffness of the shaft of [`two_mass`], N m/rad; another than that of the model's file.
const STIFFNESS: f64 = 160.0;

/// A run of the model `two-mass` for 2 s at 500 Hz, with another stiffness, dry friction at the load, and noise.
pub(crate) fn two_mass(number: u32, friction_nm: f64) -> Recording {
    let base = Model::builtin("two-mass").unwrap();
    let truth = match friction_nm {
        0.0 => base,
        torque => base.with_effect("coulomb_friction", "load_bearing", &[("torque", torque)]).unwrap(),
    };
    let mut values = truth.values();
    values[truth.parameter("stiffness").unwrap()] = STIFFNESS;
    let mut noise = sample::Noise(u64::from(number) + 17);
    let slow = 0.6 + 0.3 * f64::from(number);
    let time_s: Vec<f64> = (0..1000).map(|row| f64::from(row) * 2e-3).collect();
    let torque: Vec<f64> = time_s.iter().map(|t| 1.5 * (TAU * slow * t).sin() + 2.0 * noise.next()).collect();
    let predictor = Predictor::new(&truth, &values, 2e-3).unwrap();
    let simulated = predictor.run(&[&torque], &[Intersample::Linear], Start::Equilibrium).unwrap();
    let noisy = |signal: &Vec<f64>| signal.iter().map(|value| value + 0.2 * noise.next()).collect();
    let outputs: Vec<Vec<f64>> = simulated.outputs.iter().map(noisy).collect();
    let units = [("motor_torque", Unit::Nm), ("motor_speed", Unit::RadPerS), ("load_speed", Unit::RadPerS)];
    let channels = units.map(|(name, unit)| Channel::new(name, unit)).to_vec();
    sample::with_channels(
        &format!("runs/two-mass-{number}.csv"),
        channels,
        time_s,
        [vec![torque], outputs].concat(),
    )
}

fn two_masses(view: View, friction_nm: f64) -> Dashboard {
    let mut dashboard = Dashboard::default();
    dashboard.use_model(Model::builtin("two-mass").unwrap());
    (1..=3).for_each(|number| dashboard.add_recording(two_mass(number, friction_nm)));
    dashboard.layout.view = view;
    dashboard
}

fn is_disabled(window: &Harness<'static, Dashboard>, label: &str) -> bool {
    window.get_by_label(label).accesskit_node().is_disabled()
}

#[test]
fn an_identification_is_set_up_run_used_and_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mut dashboard = two_masses(View::Identify, 0.0);
    dashboard.layout.folder = folder.path().into();
    let mut window = window(dashboard);
    click(&mut window, "two-mass-2.csv: hold out");
    click(&mut window, "two-mass-3.csv: unused");
    click(&mut window, "Identify parameters");
    until(&mut window, "a fit", |window| !window.state().is_busy());
    window.run_steps(3);
    let shown = window.state().views.identify.page.shown.clone().unwrap();
    assert_eq!(shown.recordings, ["runs/two-mass-1.csv"]);
    assert_eq!(shown.validation[0].recording, "runs/two-mass-2.csv");
    let stiffness = shown.parameters.iter().find(|parameter| parameter.name == "stiffness").unwrap();
    let [Some(low), Some(high)] = stiffness.ci95 else { panic!("{stiffness:?}") };
    assert!(low < STIFFNESS && STIFFNESS < high && high < 1.05 * low, "{low} {high}");
    window.get_by_label("Held out, not fitted: runs/two-mass-2.csv");
    window.get_by_label("Chart load_speed: measured and predicted, rad/s");
    click(&mut window, "residuals");
    window.get_by_label("Chart load_speed: measured minus predicted, rad/s");
    // The data have white noise, and the model is the true one.
    click(&mut window, "whiteness");
    window.get_by_label_contains("Chart autocorrelation of load_speed: ");
    click(&mut window, "by input");
    let related = "nothing that this input causes is seen to be lacking";
    let said = window.get_all_by_label_contains("Chart residual of load_speed with motor_torque: ");
    assert!(said.filter_map(|node| node.accesskit_node().label()).all(|said| said.ends_with(related)));
    click(&mut window, "Sort by value");

    click(&mut window, "Use as model");
    let model = window.state().workspace.model();
    let used = model.parameters[model.parameter("stiffness").unwrap()].value;
    assert_eq!(Some(used), stiffness.value);
    for (button, name) in [("Save as JSON...", "fit.json"), ("Save model file...", "bench.toml")] {
        click(&mut window, button);
        save_as(&mut window, name);
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(matches!(parse("fit.json", &read("fit.json")).unwrap(), Document::Identification(_)));
    assert!(read("bench.toml").contains("identified (output-error) from runs/two-mass-1.csv"));
}

/// What is in sight becomes what is fitted, and the command names it.
#[test]
fn the_range_in_sight_is_fitted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    let data = two_mass(1, 0.0).dataset().unwrap();
    socam_recording::export_csv(&data, &path).unwrap();
    let run = path.display().to_string();
    let read = |run: &str| socam_recording::Dataset::open(run).map_err(|error| error.to_string());
    let mut dashboard = Dashboard::default();
    dashboard.use_model(Model::builtin("two-mass").unwrap());
    dashboard.add_recording(Recording::open(&run, read, &Handle::default()).unwrap());
    dashboard.layout.view = View::Time;
    let mut window = window(dashboard);
    assert!(!has(&window, "Fit this range"), "everything is in sight");
    window.state_mut().views.time.x = Some([0.4, 1.2]);
    window.run_steps(2);
    click(&mut window, "Fit this range");
    assert_eq!(window.state().layout.view, View::Identify);
    window.get_by_label("0.4 s to 1.2 s of each recording");
    window.get_by_label_contains("run.csv@0.4..1.2 --model two-mass");
    click(&mut window, "Identify parameters");
    until(&mut window, "a fit", |window| !window.state().is_busy());
    window.run_steps(3);
    let shown = window.state().views.identify.page.shown.clone().unwrap();
    assert_eq!(shown.recordings, [format!("{run}@0.4..1.2")]);
    // The verdict is about the recording that is open.
    window.get_by_label("Step Identify: the model explains them");
    // Of the other view, too; a range without samples is refused in a sentence.
    click(&mut window, "Diagnosis");
    window.get_by_label("0.4 s to 1.2 s of each recording");
    window.state_mut().workspace.setup.range_s = Some([5.0, 6.0]);
    window.run_steps(2);
    window.get_by_label_contains("run.csv has no samples between 5 s and 6 s");
    assert!(is_disabled(&window, "Diagnose"));
    click(&mut window, "Whole recordings");
    assert!(!is_disabled(&window, "Diagnose"));
}

#[test]
fn a_diagnosis_is_run_beside_the_data_and_its_report_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mut dashboard = two_masses(View::Diagnosis, 0.4);
    dashboard.layout.folder = folder.path().into();
    let mut window = window(dashboard);
    click(&mut window, "two-mass-3.csv: hold out");
    click(&mut window, "Diagnose");
    until(&mut window, "a diagnosis", |window| !window.state().is_busy());
    window.run_steps(3);
    window.get_by_label_contains("1. Coulomb friction at");
    click(&mut window, "Save report...");
    save_as(&mut window, "report");
    for name in ["index.html", "diagnosis.json", "model.toml"] {
        assert!(folder.path().join("report").join(name).is_file(), "{name}");
    }
    click(&mut window, "Save report...");
    save_as(&mut window, "report");
    assert!(window.state().problems().any(|text| text.contains("exists already")));
    click(&mut window, "Use as model");
    assert_eq!(window.state().workspace.model().effects.len(), 1);
}

#[test]
fn a_fit_is_cancelled_and_leaves_nothing() {
    for (view, button) in [(View::Identify, "Identify parameters"), (View::Diagnosis, "Diagnose")] {
        let mut window = window(two_masses(view, 0.4));
        click(&mut window, button);
        assert!(window.state().is_busy());
        click(&mut window, "Cancel");
        assert!(!window.state().is_busy());
        window.run_steps(2);
        assert!(!is_disabled(&window, button));
        assert_eq!(window.state().problems().count(), 0);
    }
}

/// The thread ends too: after the cancellation no step is begun.
#[test]
fn a_cancelled_diagnosis_ends_at_the_next_evaluation() {
    #[derive(Default)]
    struct Cancels {
        is_cancelled: AtomicBool,
        later: AtomicUsize,
        parts: Mutex<Vec<f64>>,
    }
    impl Observer for Cancels {
        fn progress(&self, _: &Progress) {
            self.later.fetch_add(usize::from(self.is_cancelled()), Ordering::Relaxed);
        }
        fn stop(&self) -> bool {
            false
        }
        fn is_cancelled(&self) -> bool {
            self.is_cancelled.load(Ordering::Relaxed)
        }
        fn part(&self, name: &str, done: f64) {
            self.parts.lock().unwrap().push(done);
            self.is_cancelled.store(name.starts_with("fits of the candidates"), Ordering::Relaxed);
        }
    }
    let cancels = Arc::new(Cancels::default());
    let data: Vec<_> = (1..=2).map(|number| two_mass(number, 0.4).dataset().unwrap()).collect();
    let options = Options { progress: ProgressMonitor::by(cancels.clone()), ..Options::default() };
    let answer = diagnose(&Model::builtin("two-mass").unwrap(), &data, HeldOut::none(), &options);
    assert!(matches!(answer, Err(DiagnoseError::Identify(IdentifyError::Cancelled))));
    assert_eq!(cancels.later.load(Ordering::Relaxed), 0);
    let parts = cancels.parts.lock().unwrap();
    assert!(parts.len() == 4 && parts.windows(2).all(|pair| pair[0] < pair[1]), "{parts:?}");
}

#[test]
fn what_cannot_be_started_says_why() {
    let mut window = window(Dashboard::default());
    window.state_mut().layout.view = View::Identify;
    window.run_steps(2);
    assert!(is_disabled(&window, "Identify parameters"));
    window.get_by_label("No recording is open: press Ctrl+O.");

    window.state_mut().add_recording(sample::run(0, 500));
    window.run_steps(2);
    assert!(!is_disabled(&window, "Identify parameters"));
    click(&mut window, "multisine-0.mcap: hold out");
    window.get_by_label("No recording is fitted: choose `fit` for at least one.");
    click(&mut window, "multisine-0.mcap: fit");

    click(&mut window, "Model");
    click(&mut window, "two-mass, built in");
    window.get_by_label(
        "multisine-0.mcap lacks motor_torque_Nm, load_speed_rad_s, which the model two-mass reads: choose another model or another recording.",
    );
    assert!(is_disabled(&window, "Identify parameters"));

    // A model that is known is judged by the recordings.
    let model = window.state().workspace.model().clone();
    window.state_mut().workspace.setup.use_as("runs/multisine-0.mcap", Role::Unused);
    window.state_mut().add_recording(two_mass(1, 0.0));
    for parameter in &model.parameters {
        window.state_mut().workspace.setup.set_parameter(&parameter.name, parameter.value, true);
    }
    window.run_steps(2);
    assert!(!is_disabled(&window, "Identify parameters"));
}

/// A recording with constant outputs has nothing to fit; the window says so and continues.
#[test]
fn a_fit_that_fails_says_why() {
    let mut dashboard = Dashboard::default();
    let time_s = (0..3).map(|row| f64::from(row) * 1e-3).collect();
    dashboard.add_recording(sample::of("runs/short.mcap", time_s, vec![vec![1.0; 3]; 5]));
    dashboard.layout.view = View::Identify;
    let mut window = window(dashboard);
    click(&mut window, "Identify parameters");
    until(&mut window, "a refusal", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label_contains("its longest segment without gaps has 3 samples");
    assert!(!is_disabled(&window, "Identify parameters"));
}
