//! A made-up but plausible diagnosis of the default bench.

use socam_findings::document::*;

use super::signals::overlay;

pub(super) const CHANNELS: [(&str, &str, f64); 3] =
    [("output_speed", "rad/s", 0.01), ("torque_in", "N m", 0.004), ("torque_out", "N m", 0.02)];

fn value(name: &str, value: f64, half_width: f64, unit: &str) -> EffectParameter {
    let ci95 = [Some(value - half_width), Some(value + half_width)];
    EffectParameter { name: name.into(), value: Some(value), unit: unit.into(), ci95 }
}

pub(super) fn rival(effect: &str, location: &str, weight: f64) -> Rival {
    Rival { effect: effect.into(), location: location.into(), weight }
}

fn friction() -> Finding {
    Finding {
        effect: "coulomb_friction".into(),
        location: "cam_bearing".into(),
        parameters: vec![value("torque", 0.051_23, 0.0021, "N m")],
        components: Vec::new(),
        curve: None,
        region: Region {
            speed_rad_s: Some([-12.5, 12.5]),
            frequency_hz: Some([0.0, 8.0]),
            text: "Most of it where the cam shaft reverses, below 12 rad/s.".into(),
            ..Region::default()
        },
        evidence: FindingEvidence {
            p_value: Some(3.2e-41),
            chi2_gain: Some(8123.4),
            holdout_gain_percent: Some(91.2),
            misfit_percent: Some(78.0),
            ..FindingEvidence::default()
        },
        formulas: Vec::new(),
        richer: Vec::new(),
        drag: Vec::new(),
        rivals: vec![
            rival("stribeck_friction", "cam_bearing", 0.21),
            rival("mesh_loss", "mesh", 0.06),
            rival("sensor_offset", "torque_in", 0.004),
        ],
        sentence: "The bearing of the cam shaft rubs with 0.051 N m whichever way it turns, however slowly."
            .into(),
        equation: "T = -torque sign(w)".into(),
    }
}

fn kinematic_error() -> Finding {
    let order = |order, amplitude| {
        vec![
            value("order", order, 0.0, "1"),
            value("amplitude", amplitude, 2.1e-5, "rad"),
            value("phase", 1.23, 0.11, "rad"),
        ]
    };
    Finding {
        effect: "kinematic_error".into(),
        location: "mesh".into(),
        parameters: order(1.0, 4.12e-4),
        components: [order(1.0, 4.12e-4), order(0.125, 1.9e-4)].map(|parameters| Component { parameters }).into(),
        curve: None,
        region: Region { frequency_hz: Some([2.0, 16.0]), text: "At one cycle per turn of the cam shaft.".into(), ..Region::default() },
        evidence: FindingEvidence { p_value: Some(2.0e-9), chi2_gain: Some(312.0), holdout_gain_percent: Some(34.0), misfit_percent: None, ..FindingEvidence::default() },
        rivals: Vec::new(),
        richer: Vec::new(),
        drag: Vec::new(),
        formulas: Vec::new(),
        sentence: "The reducer does not roll true: its output runs ahead and behind by 0.41 mrad once per turn of the cam shaft.".into(),
        equation: "e = amplitude sin(order a + phase)".into(),
    }
}

pub(super) fn unexplained() -> Finding {
    let x: Vec<f64> = (0..25).map(|n| -60.0 + 5.0 * f64::from(n)).collect();
    let torque = |x: &f64| if *x == 0.0 { None } else { Some(-0.2 * x / (1.0 + (x / 25.0).powi(2)) / 25.0) };
    Finding {
        effect: UNEXPLAINED.into(),
        location: "load_bearing".into(),
        parameters: Vec::new(),
        components: Vec::new(),
        curve: Some(Curve {
            over: Over::Speed,
            unit: "rad/s".into(),
            torque: x.iter().map(torque).collect(),
            torque_std: x.iter().map(|x| Some(0.004 + 1e-4 * x.abs())).collect(),
            x,
            torque_unit: "N m".into(),
        }),
        region: Region { speed_rad_s: Some([-40.0, 40.0]), text: "Strongest near 25 rad/s.".into(), ..Region::default() },
        evidence: FindingEvidence { p_value: Some(1e-12), chi2_gain: Some(420.0), holdout_gain_percent: Some(55.0), misfit_percent: Some(61.0), ..FindingEvidence::default() },
        rivals: Vec::new(),
        richer: Vec::new(),
        drag: Vec::new(),
        formulas: Vec::new(),
        sentence: "Something brakes the load that grows with speed and then gives way; no effect of the catalogue does.".into(),
        equation: String::new(),
    }
}

fn parameter(name: &str, unit: &str, before: f64, after: f64, half_width: f64) -> ParameterChange {
    let around = |value: f64| [Some(value - half_width), Some(value + half_width)];
    ParameterChange {
        name: name.into(),
        unit: unit.into(),
        before: Some(before),
        after: Some(after),
        ci95: around(after),
        ci95_before: around(before),
        identifiable: true,
        fixed: false,
        determined_with: Vec::new(),
    }
}

fn parameters() -> Vec<ParameterChange> {
    let undetermined = |name: &str, with: &str| ParameterChange {
        before: None,
        after: None,
        ci95: [Some(31.2), None],
        ci95_before: [None; 2],
        identifiable: false,
        determined_with: vec![with.into()],
        ..parameter(name, "N m/rad", 0.0, 0.0, 0.0)
    };
    let fixed = |name: &str, unit: &str, value| ParameterChange {
        fixed: true,
        ci95: [None; 2],
        ci95_before: [None; 2],
        ..parameter(name, unit, value, value, 0.0)
    };
    vec![
        undetermined("k1", "k2"),
        undetermined("k2", "k1"),
        parameter("k3", "N m/rad", 48_123.0, 52_431.0, 1830.0),
        parameter("k4", "N m/rad", 110.2, 109.97, 0.31),
        parameter("c4", "N m s/rad", 0.123, 0.0812, 0.0031),
        parameter("c5", "N m s/rad", 0.0791, 0.0502, 0.0007),
        fixed("J2", "kg m2", 1.287_502_2e-4),
        fixed("J4", "kg m2", 1.4752e-2),
        fixed("N", "1", 8.0),
    ]
}

fn not_found() -> Vec<NotFound> {
    let entry = |effect: &str, location: &str, parameter: &str, smallest_detectable, unit: &str| NotFound {
        effect: effect.into(),
        location: location.into(),
        parameter: parameter.into(),
        smallest_detectable,
        unit: unit.into(),
    };
    vec![
        entry("coulomb_friction", "load_bearing", "torque", Some(0.0123), "N m"),
        entry("quadratic_drag", "cam_bearing", "coefficient", Some(3.1e-6), "N m s2/rad2"),
        entry("quadratic_drag", "load_bearing", "coefficient", Some(8.7e-5), "N m s2/rad2"),
        entry("backlash", "mesh", "gap", Some(4.2e-4), "rad"),
        entry("stiffness_hardening", "coupling_1", "cubic", None, "1/rad2"),
        entry("stiffness_hardening", "coupling_2", "cubic", None, "1/rad2"),
        entry("stiffness_hardening", "coupling_3", "cubic", Some(210.0), "1/rad2"),
        entry("sensor_gain", "output_speed", "gain", Some(0.0021), "1"),
        entry("sensor_gain", "torque_in", "gain", Some(0.013), "1"),
        entry("sensor_gain", "torque_out", "gain", Some(0.0077), "1"),
    ]
}

pub(super) fn diagnosis() -> Diagnosis {
    let fits = CHANNELS.iter().map(|(name, unit, noise)| {
        let fit = ChannelFit {
            noise_std: Some(*noise),
            rms_before: Some(3.123 * noise),
            rms_after: Some(1.008 * noise),
            holdout_rms_before: Some(3.31 * noise),
            holdout_rms_after: Some(1.041 * noise),
            unit: (*unit).into(),
        };
        ((*name).to_owned(), fit)
    });
    let mut diagnosis = Diagnosis {
        selection: Some(Validation::LeaveOneOut),
        held_out: Some(HeldOut {
            outcome: ProofOutcome::Holds,
            sentence: "The corrected model predicts the held-out recordings better than the base model, and no channel worse.".into(),
        }),
        schema: SCHEMA.into(),
        verdict: Verdict::MissingPhysics,
        finished: true,
        end: SearchEnd::Completed,
        unfinished: None,
        candidates: Vec::new(),
        false_alarm_rate: 0.01,
        validation: Validation::Holdout,
        findings: vec![friction(), kinematic_error()],
        answer: Vec::new(),
        ordinary: Vec::new(),
        fit: Fit { channels: fits.collect() },
        parameters: parameters(),
        combinations: vec![CombinationChange {
            name: "k_series_12".into(),
            expression: "k1 k2 / (k1 + k2)".into(),
            unit: "N m/rad".into(),
            before: Some(29.1),
            after: Some(30.82),
            ci95: [Some(30.61), Some(31.03)],
        }],
        not_found: not_found(),
        suggested_experiment: Some(SuggestedExperiment {
            profile: "reversals".into(),
            tells_apart: vec!["coulomb_friction@cam_bearing".into(), "stribeck_friction@cam_bearing".into()],
            sentence: "Record `reversals` for 10 s at twice the amplitude: sticking shows in how torque rises at each reversal.".into(),
        }),
        cpu_s: 3.27,
        warnings: vec!["torque_out is missing in `multisine-2.mcap` from 3.1 s to 3.4 s".into()],
        model: "speed-o-cam".into(),
        recordings: recordings(6),
        version: "0.1.0".into(),
        overlay: Some(overlay()),
    };
    diagnosis.answer = socam_findings::answer::answer(&diagnosis);
    diagnosis
}

pub(super) fn recordings(count: usize) -> Vec<RecordingUse> {
    let name =
        |index: usize| format!("{}-{}.mcap", ["steps", "multisine", "triangle"][index % 3], 1 + index / 3);
    let one = |index| RecordingUse {
        name: name(index),
        held_out: index >= count - count / 3,
        samples: 10_000,
        duration_s: 9.999,
    };
    (0..count).map(one).collect()
}
