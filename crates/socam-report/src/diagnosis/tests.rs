mod drawing;
mod reader;
mod sample;
mod signals;

use std::{fs, path::Path};

use socam_model::Model;

use super::*;
use reader::{made, report};
use socam_findings::{
    document::{Component, EffectParameter, RecordingUse, Rival, SearchEnd, Validation, Verdict},
    evidence::{ChannelEvidence, RecordingTraces, Trace},
};

const AALTO: &str = include_str!("../../../../tests/models/aalto.toml");
/// A page must open at once and fit in a mail.
const MOST_BYTES: usize = 1_500_000;
/// Set to a directory, it keeps the pages there for people to look at.
const KEEP: &str = "SOCAM_KEEP_REPORTS";
/// Set to anything, it rewrites the expected text after a wanted change.
const UPDATE: &str = "SOCAM_UPDATE_SNAPSHOTS";

fn speed_o_cam() -> Model {
    Model::builtin("speed-o-cam").unwrap()
}

#[test]
fn the_sample_reads_as_expected() {
    let diagnosis = sample::diagnosis();
    let evidence = signals::evidence(&diagnosis.recordings, 10_000);
    let text = report("sample", &diagnosis, &evidence, &speed_o_cam());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/diagnosis/tests/sample.txt");
    if std::env::var_os(UPDATE).is_some() {
        fs::write(&path, &text).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap();
    for (line, (actual, expected)) in text.lines().zip(expected.lines()).enumerate() {
        assert_eq!(actual, expected, "line {} of sample.txt; if this is wanted, set {UPDATE}=1", line + 1);
    }
    assert_eq!(text.lines().count(), expected.lines().count());
}

#[test]
fn files_are_whole() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("new/report");
    let diagnosis = sample::diagnosis();
    let model = speed_o_cam();
    write(&target, &diagnosis, &Evidence::default(), (&model, Some("corrected")), &made()).unwrap();
    let mut names: Vec<_> = fs::read_dir(&target).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["diagnosis.json", "index.html", "model.toml", "next.toml"]);
    assert_eq!(fs::read_to_string(target.join("model.toml")).unwrap(), "corrected");
    let json = fs::read_to_string(target.join("diagnosis.json")).unwrap();
    assert_eq!(json, serde_json::to_string_pretty(&diagnosis).unwrap() + "\n");
    // The page holds the hashes of the files beside it, the command and the date.
    let page = fs::read_to_string(target.join("index.html")).unwrap();
    for name in ["diagnosis.json", "model.toml", "next.toml"] {
        let hash = FileHash::of_file(name, &target.join(name)).unwrap();
        assert!(page.contains(&hash.sha256), "{name}");
    }
    let made = made();
    assert!(page.contains(&made.files[0].sha256) && page.contains(&made.date), "{page}");
    assert!(page.contains("socam-host diagnose 'my runs/steps-1.mcap' --report report"), "{page}");
}

#[test]
fn an_interrupted_search_has_no_model() {
    let dir = tempfile::tempdir().unwrap();
    let (diagnosis, model) = (sample::diagnosis(), speed_o_cam());
    let interrupted = Diagnosis { end: SearchEnd::Interrupted, ..diagnosis.clone() };
    // Nor has it those of the diagnosis whose folder it takes.
    for diagnosis in [&diagnosis, &interrupted] {
        write(dir.path(), diagnosis, &Evidence::default(), (&model, Some("corrected")), &made()).unwrap();
    }
    let mut names: Vec<_> = fs::read_dir(&dir).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["diagnosis.json", "index.html"]);
    let page = fs::read_to_string(dir.path().join("index.html")).unwrap();
    assert!(page.contains("not written, because the search was interrupted"), "{page}");
    assert!(!page.contains("model.toml") && !page.contains("next.toml"), "{page}");
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    fs::write(&file, "").unwrap();
    let target = file.join("report");
    let (diagnosis, model) = (sample::diagnosis(), speed_o_cam());
    let error = write(&target, &diagnosis, &Evidence::default(), (&model, None), &made()).unwrap_err();
    let sentence = error.to_string();
    assert!(sentence.contains(&target.display().to_string()) && !sentence.contains('\n'), "{sentence}");
}

#[test]
fn nothing_missing() {
    let mut sample = sample::diagnosis();
    for (_, fit) in &mut sample.fit.channels {
        (fit.rms_after, fit.holdout_rms_after) = (fit.rms_before, fit.holdout_rms_before);
    }
    let mut overlay = signals::overlay();
    overlay.before = std::mem::take(&mut overlay.after);
    overlay.residual_before = std::mem::take(&mut overlay.residual_after);
    let diagnosis = Diagnosis {
        verdict: Verdict::Adequate,
        overlay: Some(overlay),
        held_out: None,
        findings: Vec::new(),
        suggested_experiment: None,
        warnings: Vec::new(),
        ..sample
    };
    let mut evidence = signals::evidence(&diagnosis.recordings, 2000);
    for trace in evidence.recordings.iter_mut().flat_map(|recording| &mut recording.channels) {
        trace.before = std::mem::take(&mut trace.after);
    }
    for channel in &mut evidence.channels {
        channel.over_torque = None;
        channel.spectrum = None;
        for binned in channel.over_speed.iter_mut().chain(&mut channel.over_angle) {
            binned.before = std::mem::take(&mut binned.after);
        }
    }
    let text = report("adequate", &diagnosis, &evidence, &speed_o_cam());
    assert!(text.contains("Nothing is missing"), "{text}");
    assert!(!text.contains("What is missing") && !text.contains("Before and after"), "{text}");
    assert!(!text.contains("predicted before"), "{text}");
    assert!(text.contains("How well the model fits"), "{text}");
}

#[test]
fn rivals_that_tie_stand_in_the_headline() {
    let mut diagnosis = sample::diagnosis();
    diagnosis.findings.truncate(1);
    diagnosis.findings[0].rivals = vec![sample::rival("coulomb_friction", "load_bearing", 0.48)];
    diagnosis.answer = socam_findings::answer::answer(&diagnosis);
    let evidence = signals::evidence(&diagnosis.recordings, 500);
    let text = report("tied", &diagnosis, &evidence, &speed_o_cam());
    let title = "Physics is missing: friction, drag or a loss at cam_bearing or load_bearing, fitted as Coulomb friction at cam_bearing";
    assert!(text.contains(title) && text.contains("place of a rival"), "{text}");
}

#[test]
fn something_without_a_name() {
    let diagnosis = Diagnosis {
        verdict: Verdict::Unexplained,
        findings: vec![sample::unexplained()],
        validation: Validation::LeaveOneOut,
        held_out: None,
        ..sample::diagnosis()
    };
    let evidence = signals::evidence(&diagnosis.recordings, 500);
    let text = report("unexplained", &diagnosis, &evidence, &speed_o_cam());
    assert!(text.contains("Something is missing at load_bearing that no effect"), "{text}");
    assert!(text.contains("Missing torque (N m)") && text.contains("Speed (rad/s)"), "{text}");
    // What its curve does to the residuals is shown.
    assert!(text.contains("Before and after"), "{text}");
}

#[test]
fn a_name_beside_something_without_one() {
    let nameless = sample::unexplained();
    let expected = format!(", and something without a name at {}", nameless.location);
    let mut diagnosis = sample::diagnosis();
    diagnosis.findings.push(nameless);
    let evidence = signals::evidence(&diagnosis.recordings, 500);
    let text = report("beside", &diagnosis, &evidence, &speed_o_cam());
    assert!(text.contains(&expected), "{text}");
}

#[test]
fn many_recordings_and_long_names() {
    let mut diagnosis = sample::diagnosis();
    let long =
        "a_very_long_name_of_a_place_that_nobody_would_type_twice_and_averyveryverylongwordwithoutbreaks";
    diagnosis.recordings = sample::recordings(12);
    for recording in &mut diagnosis.recordings {
        recording.name = format!("/data/{long}/{}@1.5..8.25", recording.name);
    }
    diagnosis.findings[0].location = "sensor_lower_in_hub".into();
    diagnosis.findings[0].rivals[0].location = "spring_18".into();
    diagnosis.findings[1].location = "mesh_2".into();
    diagnosis.findings[0].rivals.push(Rival {
        effect: "missing_inertia".into(),
        location: long.into(),
        weight: 0.1,
    });
    let parameter =
        EffectParameter { name: long.into(), value: Some(1.0), unit: "N m".into(), ci95: [None; 2] };
    diagnosis.findings[1].components.push(Component { parameters: vec![parameter] });
    diagnosis.warnings = vec![long.into(), "<b>&\"quoted\"</b>".into()];
    let evidence = signals::evidence(&diagnosis.recordings, 10_000);
    let model = AALTO.replace("\"sensor_upper_out\"", &format!("\"{long}\""));
    report("aalto", &diagnosis, &evidence, &Model::parse(&model).unwrap());
}

#[test]
fn odd_numbers_leave_no_trace() {
    let mut diagnosis = sample::diagnosis();
    diagnosis.cpu_s = f64::NAN;
    diagnosis.false_alarm_rate = f64::INFINITY;
    for (_, fit) in &mut diagnosis.fit.channels {
        fit.noise_std = Some(0.0);
        fit.rms_after = Some(f64::NAN);
        fit.holdout_rms_before = None;
    }
    let finding = &mut diagnosis.findings[0];
    finding.evidence.p_value = Some(f64::NAN);
    finding.evidence.holdout_gain_percent = Some(f64::NEG_INFINITY);
    finding.region.speed_rad_s = Some([f64::NEG_INFINITY, f64::NAN]);
    finding.rivals[0].weight = f64::NAN;
    finding.parameters[0].value = Some(f64::NAN);
    diagnosis.parameters[2].before = Some(0.0);
    let evidence = signals::evidence(&diagnosis.recordings[..1], 1);
    report("odd-numbers", &diagnosis, &evidence, &speed_o_cam());
}

#[test]
fn hardly_any_data() {
    let one = |time_s: Vec<f64>, before: Vec<f64>| Trace {
        channel: "output_speed".into(),
        time_s,
        before,
        after: Vec::new(),
    };
    let traces =
        [one(vec![0.0], vec![0.3]), one(Vec::new(), Vec::new()), one(vec![0.0, 1.0], vec![f64::NAN; 2])];
    let recordings = traces.into_iter().enumerate().map(|(index, trace)| RecordingTraces {
        name: format!("run {index}"),
        held_out: index == 1,
        channels: vec![trace],
    });
    let channel =
        ChannelEvidence { name: "output_speed".into(), unit: "rad/s".into(), ..ChannelEvidence::default() };
    let evidence = Evidence { recordings: recordings.collect(), channels: vec![channel] };
    let mut diagnosis = sample::diagnosis();
    diagnosis.recordings =
        vec![RecordingUse { name: "run 0".into(), held_out: false, samples: 1, duration_s: 0.0 }];
    let text = report("hardly-any-data", &diagnosis, &evidence, &speed_o_cam());
    assert_eq!(text.matches("no data").count(), 2, "{text}");
}
