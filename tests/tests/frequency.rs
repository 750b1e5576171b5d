//! Frequency responses, transfer functions and coefficient matching, as one uses them.

use serde_json::{Value, json};
use socam_tests::run;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    /// The virtual bench on a profile, by the error-controlled integrator.
    fn simulate(&self, name: &str, arguments: &[&str]) -> String {
        let path = self.path(name);
        let _ = run(["simulate", "-o", &path].iter().chain(arguments)).done();
        path
    }

    /// A recording of the virtual bench, and the JSON output of `identify --method frf` on it; the report is written to `response`.
    fn response(&self) -> (String, Value) {
        let recording = self.simulate("run.mcap", &["--profile", "multisine", "--duration", "16s"]);
        let report = self.path("response");
        let options = ["--method", "frf", "--output", "output_speed", "--report", &report, "--json"];
        let found = run(["identify", &recording].iter().chain(&options)).json();
        (recording, found)
    }
}

#[test]
fn the_response_of_the_virtual_bench_is_its_own() {
    let folder = Folder::new();
    let (_, found) = folder.response();
    assert_eq!(found["schema"], "socam.frequency-response/1");
    let output = &found["outputs"][0];
    assert_eq!(output["estimated_by"]["method"], "periodic");
    assert!((number(&output["estimated_by"]["period_s"]) - 2.0).abs() < 1e-9);
    let lines = output["lines"].as_array().unwrap();
    assert!(lines.len() > 90, "{}", lines.len());
    // Lines of high coherence are near the exact response, within their own intervals.
    for line in lines.iter().filter(|line| number(&line["coherence"]) > 0.98) {
        let (re, im) = (
            number(&line["re"]) - number(&line["model_re"]),
            number(&line["im"]) - number(&line["model_im"]),
        );
        assert!(re.hypot(im) < 2.5 * number(&line["radius95"]), "{line}");
    }
    for held in ["magnitude_held_percent", "phase_held_percent"] {
        assert!((88.0..=100.0).contains(&number(&output["beside_model"][held])), "{output:?}");
    }
    assert_eq!(output["distortion"]["even"]["significant"], false, "{}", output["distortion"]);
}

#[test]
#[cfg_attr(not(feature = "full"), ignore = "full tier")]
fn the_response_of_the_virtual_bench_leads_to_its_transfer_function() {
    let folder = Folder::new();
    let (recording, _) = folder.response();
    // A transfer function draws on all lines together: nearer to the exact one than any line need be.
    let etf = run(["identify", &recording, "--method", "etf", "--json"]).json();
    let beside = &etf["beside_model"];
    assert!(number(&beside["lines_of_good_coherence"]) > 80.0, "{beside}");
    assert!(number(&beside["worst_db"]) < 0.2 && number(&beside["worst_deg"]) < 1.5, "{beside}");

    // The response that was written is data for a transfer function, and that for coefficient matching.
    let csv = folder.path("response/response.csv");
    let folder_etf = folder.path("transfer");
    let etf = run([
        "identify",
        &csv,
        "--method",
        "etf",
        "--orders",
        "1/4",
        "--stable",
        "--report",
        &folder_etf,
        "--json",
    ])
    .json();
    assert_eq!((&etf["stable"], &etf["converged"]), (&json!(true), &json!(true)));
    assert!((number(&etf["final_value"]["value"]) - 0.125).abs() < 3e-3, "{}", etf["final_value"]);
    for name in ["transfer.json", "index.html", "output_speed-poles-zeros.svg"] {
        let text = std::fs::read_to_string(format!("{folder_etf}/{name}")).unwrap();
        assert!(text.len() > 500 && !text.contains("NaN"), "{name}");
    }
}

#[test]
#[cfg_attr(not(feature = "full"), ignore = "full tier")]
fn a_response_that_was_written_leads_to_the_same_transfer_function_as_its_recording() {
    let folder = Folder::new();
    let recording = folder.simulate("run.mcap", &["--profile", "chirp", "--duration", "20s"]);
    let report = folder.path("response");
    let _ = run(["identify", &recording, "--method", "frf", "--report", &report]).done();
    let csv = format!("{report}/response.csv");
    let [direct, written] =
        [&recording, &csv].map(|data| run(["identify", data, "--method", "etf", "--json"]).json());
    assert_eq!((&direct["lines"], &direct["orders"]), (&written["lines"], &written["orders"]));
    for of in [|found: &Value| number(&found["misfit"]), |found: &Value| number(&found["numerator_std"][0])] {
        assert!((of(&direct) / of(&written) - 1.0).abs() < 1e-6, "{} {}", of(&direct), of(&written));
    }

    // Without those columns lines are taken as independent, like those of other programs.
    let text = std::fs::read_to_string(&csv).unwrap();
    assert!(text.starts_with("output,") && text.contains(",freedom,width_hz,"), "{text:.200}");
    let bare = text.replacen(",freedom,width_hz,", ",other,another,", 1);
    std::fs::write(&csv, bare).unwrap();
    let bare = run(["identify", &csv, "--method", "etf", "--json"]).json();
    assert!(number(&bare["lines"]) > 1.3 * number(&direct["lines"]), "{} {}", bare["lines"], direct["lines"]);
}

#[test]
#[cfg_attr(not(feature = "full"), ignore = "full tier")]
fn an_exact_transfer_function_gives_the_determined_combinations_and_the_thesis_one_does_not() {
    let folder = Folder::new();
    // P and Q of these parameters, apart from the program: determinants of M s2 + C s + K at seven s, interpolated.
    let (k, c) = ([71.0, 54.4, 52_484.0, 110.0], [0.02, 0.03, 0.08, 0.05]);
    let start = ["--set", "k1=80", "--set", "c2=0.03", "--set", "c3=0.02", "--set", "k4=90"];
    let (numerator, denominator) = expanded(k, c);
    let path = folder.path("exact.json");
    let document =
        json!({"schema": "socam.transfer-function/1", "numerator": numerator, "denominator": denominator});
    std::fs::write(&path, document.to_string()).unwrap();
    let report = folder.path("match");
    let options = ["identify", &path, "--method", "coefficient-match", "--json", "--report", &report];
    let found = run(options.iter().chain(&start)).json();
    assert!(found["matched"][0]["gradient_check"].is_null());
    for name in ["match.json", "index.html", "magnitude.svg", "phase.svg"] {
        let text = std::fs::read_to_string(format!("{report}/{name}")).unwrap();
        assert!(text.len() > 500 && !text.contains("NaN"), "{name}");
    }
    let series = 1.0 / (1.0 / k[0] + 1.0 / k[1]);
    for matched in found["matched"].as_array().unwrap() {
        let value = |name: &str| {
            let all = matched["combinations"].as_array().unwrap();
            number(&all.iter().find(|entry| entry["name"] == name).unwrap()["value"])
        };
        for (name, truth) in [("k_series_12", series), ("k3", k[2]), ("k4", k[3]), ("c4", c[2]), ("c5", c[3])]
        {
            assert!((value(name) / truth - 1.0).abs() < 1e-6, "{name}: {} {truth}", value(name));
        }
    }
    assert_eq!(found["cannot_hold"], json!([]));

    let thesis = run(["identify", "thesis", "--method", "coefficient-match", "--json"]).json();
    let sentences = thesis["cannot_hold"].to_string();
    assert!(sentences.contains("numerator s^3 is -1.685"), "{sentences}");
}

/// Coefficients of P and Q by interpolation: the determinant at seven real points.
fn expanded(k: [f64; 4], c: [f64; 4]) -> (Vec<f64>, Vec<f64>) {
    let ([k1, k2, k3, k4], [c2, c3, c4, c5], n) = (k, c, 8.0);
    let (j, j4) = (1.287_502_2e-4 + 4.778_417_2e-3 / 64.0, 1.4752e-2);
    let q = |s: f64| {
        let rows = [
            [(c2 + c3) * s + k1 + k2, -c3 * s - k2, 0.0, 0.0],
            [-c3 * s - k2, j * s * s + c3 * s + k2 + k3 / 64.0, -k3 / n, 0.0],
            [0.0, -k3 / n, c4 * s + k3 + k4, -c4 * s - k4],
            [0.0, 0.0, -c4 * s - k4, j4 * s * s + (c4 + c5) * s + k4],
        ];
        n * n * determinant(rows)
    };
    let p = |s: f64| k3 * n * (k1 + c2 * s) * (k2 + c3 * s) * (k4 + c4 * s);
    (interpolated(p, 3), interpolated(q, 6))
}

fn determinant(mut rows: [[f64; 4]; 4]) -> f64 {
    let mut product = 1.0;
    for i in 0..4 {
        product *= rows[i][i];
        for below in i + 1..4 {
            let pivot = rows[i];
            let factor = rows[below][i] / pivot[i];
            rows[below].iter_mut().zip(pivot).for_each(|(own, above)| *own -= factor * above);
        }
    }
    product
}

/// Ascending coefficients of a polynomial through its values, by Newton's divided differences.
fn interpolated(of: impl Fn(f64) -> f64, degree: usize) -> Vec<f64> {
    // Points about as large as the poles, on both sides.
    let points: Vec<f64> = (0..=degree)
        .map(|i| 900.0 * (std::f64::consts::PI * (i as f64 + 0.5) / (degree + 1) as f64).cos())
        .collect();
    let mut differences: Vec<f64> = points.iter().map(|s| of(*s)).collect();
    for order in 1..=degree {
        for i in (order..=degree).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (points[i] - points[i - order]);
        }
    }
    let mut coefficients = vec![0.0; degree + 1];
    for i in (0..=degree).rev() {
        let shifted: Vec<f64> = (0..=degree)
            .map(|power| if power > 0 { coefficients[power - 1] } else { 0.0 } - points[i] * coefficients[power])
            .collect();
        coefficients = shifted;
        coefficients[0] += differences[i];
    }
    coefficients
}

#[test]
#[cfg_attr(not(feature = "full"), ignore = "full tier")]
fn the_thesis_is_computed_again() {
    let folder = Folder::new();
    let dir = folder.path("page");
    let report = run(["thesis", "--report", &dir, "--json"]).json();
    assert_eq!(report["schema"], "socam.thesis/1");
    let points = report["points"].as_array().unwrap();
    assert!((1..=17).all(|number| points.iter().any(|point| point["number"] == number)));
    let page = std::fs::read_to_string(format!("{dir}/index.html")).unwrap();
    assert!(page.contains("88.76 %") && page.contains("20.20 Hz"));
    let text = run(["thesis"]).done();
    assert!(text.contains("physics concealed"), "{text}");
}

#[test]
#[cfg_attr(not(feature = "full"), ignore = "full tier")]
fn an_option_that_a_method_would_not_use_is_refused() {
    let folder = Folder::new();
    let recording = folder.simulate("run.csv", &["--profile", "multisine", "--duration", "4s"]);
    let refused = run(["identify", &recording, "--method", "frf", "--write-model", "x.toml"]);
    assert!(refused.refusal(2).contains("--write-model"));
    let refused = run(["identify", &recording, "--method", "etf", "--orders", "7/6"]);
    assert!(refused.refusal(1).contains("7 over"));
}
