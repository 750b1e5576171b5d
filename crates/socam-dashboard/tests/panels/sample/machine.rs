//! A machine that is drawn, described, and moved by a recording.

use socam_chart::theme::Look;
use socam_dashboard::machine::Colouring;
use socam_dashboard::{Dashboard, View};
use socam_identify::{Intersample, Predictor, Start};
use socam_model::Model;
use socam_recording::{Channel, Unit};
use socam_workbench::document::{Document, parse};
use socam_workbench::new_model::NewModel;
use socam_workbench::recording::Recording;

use super::{DIAGNOSIS, dashboard, run, with_channels};

/// Simulates a model with the inputs of a recording.
pub(crate) fn simulated(model: &Model, recording: &Recording) -> Result<Recording, String> {
    let rows = 0..recording.samples.rows();
    let column = |name: &str| {
        let channel = recording.channel(name).ok_or_else(|| format!("the recording lacks {name}"))?;
        Ok(recording.samples.values(channel, rows.clone()))
    };
    let inputs = model.inputs().map(|input| column(&input.name)).collect::<Result<Vec<_>, String>>()?;
    let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
    let between = vec![Intersample::Linear; inputs.len()];
    let step_s = recording.about.sample_time_s;
    let predictor = Predictor::new(model, &model.values(), step_s).map_err(|error| error.to_string())?;
    let done = predictor.run(&inputs, &between, Start::Equilibrium).map_err(|error| error.to_string())?;
    let unit = |unit: &str| match unit {
        "rad/s" => Unit::RadPerS,
        "m/s" => Unit::MPerS,
        "m" => Unit::M,
        "N" => Unit::N,
        _ => Unit::Nm,
    };
    let channels =
        model.outputs().map(|channel| Channel::new(channel.name.as_str(), unit(channel.unit))).collect();
    let name = format!("{} simulated by {}", recording.about.name, model.name);
    Ok(with_channels(&name, channels, recording.samples.times(rows.clone()), done.outputs))
}

/// A carriage that goes to and fro.
fn sliding() -> Recording {
    let time_s: Vec<f64> = (0..4000).map(|row| f64::from(row) * 1e-3).collect();
    let position = time_s.iter().map(|t| 0.11 * (1.6 * t).sin() + 0.02 * (9.0 * t).sin()).collect();
    let force = time_s.iter().map(|t| 12.0 * (1.6 * t).cos()).collect();
    let channels = vec![Channel::new("force", Unit::N), Channel::new("position", Unit::M)];
    with_channels("runs/axis.csv", channels, time_s, vec![force, position])
}

pub(super) fn showing(look: Look, name: &str) -> Dashboard {
    let mut shown = dashboard(look, View::Machine);
    shown.simulate_by(simulated);
    match name {
        "machine" => {
            (0..2).for_each(|number| shown.add_recording(run(number, 8000)));
            if let Ok(Document::Diagnosis(diagnosis, Some(model))) = parse("diagnosis.json", DIAGNOSIS) {
                shown.views.diagnosis.show(*diagnosis, None, *model);
            }
            let machine = &mut shown.views.machine;
            (machine.player.time_s, machine.player.colouring) = (3.21, Colouring::Torque);
            machine.selected = Some("coupling_1".into());
        }
        "machine-new" => {
            let mut form = NewModel::default();
            form.words.chain = "motor 0.9kgcm2 | coupling jaw | gear 5 | lod disc 4kg 200mm".into();
            form.update();
            shown.views.machine.describe(form);
        }
        "machine-columns" => {
            shown.use_model(Model::builtin("two-mass").unwrap());
            shown.add_recording(run(0, 4000));
            shown.views.machine.selected = Some("load_speed".into());
        }
        "machine-sliding" => {
            shown.use_model(Model::builtin("emps").unwrap());
            shown.add_recording(sliding());
            shown.views.machine.player.time_s = 0.8;
        }
        _ => {}
    }
    shown
}
