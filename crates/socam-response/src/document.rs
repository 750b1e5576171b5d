//! The JSON document of frequency responses.

use serde_json::{Value, json};
use socam_frequency::{
    Complex,
    response::{Line, Method, Parity},
};

use crate::answer::Answer;

/// Version of the document's form.
pub const SCHEMA: &str = "socam.frequency-response/1";

/// The document of the responses of `model`, from these recordings.
#[must_use]
pub fn document(model: &str, recordings: &[String], answers: &[Answer<'_>]) -> Value {
    let finite = |value: f64| value.is_finite().then_some(value);
    let line = |(line, exact): (&Line, &Complex<f64>)| {
        let phase = line.response.arg().to_degrees();
        json!({
            "frequency_hz": line.frequency_hz, "re": line.response.re, "im": line.response.im,
            "magnitude": line.response.norm(), "magnitude_ci95": line.magnitude_ci95(),
            "phase_deg": phase, "phase_ci95_deg": [phase - line.phase_half_width_deg(), phase + line.phase_half_width_deg()],
            "std": finite(line.variance.sqrt()), "radius95": finite(line.radius()), "coherence": line.coherence,
            "freedom": line.freedom, "width_hz": line.width_hz,
            "model_re": exact.re, "model_im": exact.im,
        })
    };
    let outputs = answers.iter().map(|answer| {
        json!({
            "output": answer.pair.output.name, "unit": answer.pair.output.unit,
            "input": answer.pair.input.name, "input_unit": answer.pair.input.unit,
            "estimated_by": match answer.response.method {
                Method::Periodic { period_s, periods } => json!({"method": "periodic", "period_s": period_s, "periods": periods}),
                Method::Local => json!({"method": "local_polynomial"}),
            },
            "beside_model": answer.beside_model().json(),
            "distortion": answer.response.distortion.as_ref().map(|d| json!({
                "even": d.even.map(parity_json), "odd": d.odd.map(parity_json),
            })),
            "lines": answer.response.lines.iter().zip(&answer.model).map(line).collect::<Vec<_>>(),
        })
    });
    json!({
        "schema": SCHEMA, "method": "frf", "model": model, "recordings": recordings,
        "outputs": outputs.collect::<Vec<_>>(),
    })
}

fn parity_json(parity: Parity) -> Value {
    json!({
        "lines": parity.lines, "level_db": parity.level_db, "noise_db": parity.noise_db,
        "over_noise": parity.over_noise, "p_value": parity.p_value, "significant": parity.significant,
    })
}
