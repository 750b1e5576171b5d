mod drawing;
mod sample;

use std::{fs, path::Path};

use socam_model::Model;

use super::*;
use crate::{
    document::{Component, EffectParameter, RecordingUse, Rival, Validation, Verdict},
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

/// Writes a report, checks what must hold of every page, and returns its text as a reader sees it, a line per element.
fn report(name: &str, diagnosis: &Diagnosis, evidence: &Evidence, model: &Model) -> String {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), diagnosis, evidence, model, None).unwrap();
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
    let xml = close_metas(&xml);
    let document = roxmltree::Document::parse(&xml).unwrap_or_else(|e| panic!("{name}: {e}"));
    for node in document.descendants().filter(|node| node.is_element()) {
        for attribute in node.attributes().filter(|attribute| attribute.name() != "aria-label") {
            assert_numbers(name, attribute.value());
        }
    }
    let body = document.descendants().find(|node| node.has_tag_name("body")).unwrap();
    let text: String = body.descendants().filter_map(|node| text_of(&node)).collect();
    assert!(!text.contains("NaN") && !text.contains("inf "), "{name}: {text}");
    text
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

#[test]
fn the_sample_reads_as_expected() {
    let diagnosis = sample::diagnosis();
    let evidence = sample::evidence(&diagnosis.recordings, 10_000);
    let text = report("sample", &diagnosis, &evidence, &speed_o_cam());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/report/tests/sample.txt");
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
    write(&target, &diagnosis, &Evidence::default(), &speed_o_cam(), Some("corrected")).unwrap();
    let mut names: Vec<_> = fs::read_dir(&target).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["diagnosis.json", "index.html", "model.toml", "next.toml"]);
    assert_eq!(fs::read_to_string(target.join("model.toml")).unwrap(), "corrected");
    let json = fs::read_to_string(target.join("diagnosis.json")).unwrap();
    assert_eq!(json, serde_json::to_string_pretty(&diagnosis).unwrap() + "\n");
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    fs::write(&file, "").unwrap();
    let target = file.join("report");
    let error = write(&target, &sample::diagnosis(), &Evidence::default(), &speed_o_cam(), None).unwrap_err();
    let sentence = error.to_string();
    assert!(sentence.contains(&target.display().to_string()) && !sentence.contains('\n'), "{sentence}");
}

#[test]
fn nothing_missing() {
    let mut sample = sample::diagnosis();
    for (_, fit) in &mut sample.fit.channels {
        (fit.rms_after, fit.holdout_rms_after) = (fit.rms_before, fit.holdout_rms_before);
    }
    let diagnosis = Diagnosis {
        verdict: Verdict::Adequate,
        findings: Vec::new(),
        suggested_experiment: None,
        warnings: Vec::new(),
        ..sample
    };
    let mut evidence = sample::evidence(&diagnosis.recordings, 2000);
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
    assert!(text.contains("How well the model fits"), "{text}");
}

#[test]
fn something_without_a_name() {
    let diagnosis = Diagnosis {
        verdict: Verdict::Unexplained,
        findings: vec![sample::unexplained()],
        validation: Validation::LeaveOneOut,
        ..sample::diagnosis()
    };
    let evidence = sample::evidence(&diagnosis.recordings, 500);
    let text = report("unexplained", &diagnosis, &evidence, &speed_o_cam());
    assert!(text.contains("Missing torque (N m)") && text.contains("Speed (rad/s)"), "{text}");
    // What its curve does to the residuals is shown.
    assert!(text.contains("Before and after"), "{text}");
}

#[test]
fn a_name_beside_something_without_one() {
    let nameless = sample::unexplained();
    let expected = format!("and at {} something that has no name.", nameless.location);
    let mut diagnosis = sample::diagnosis();
    diagnosis.findings.push(nameless);
    let evidence = sample::evidence(&diagnosis.recordings, 500);
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
    let evidence = sample::evidence(&diagnosis.recordings, 10_000);
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
    let evidence = sample::evidence(&diagnosis.recordings[..1], 1);
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
