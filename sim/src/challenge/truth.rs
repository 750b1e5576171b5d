//! From a case to the bench that is recorded.

use socam_model::{Model, Parameter, effects};

use super::{Case, Hidden, laws};
use crate::truth::{Concealed, Override, flawed_channel};
use crate::{Setup, SimError, Truth, calibration_for, flaw::Flaw};

impl Case {
    /// The bench as it really is.
    pub(crate) fn setup(&self) -> Result<Setup, SimError> {
        let truth = self.truth()?;
        let mut calibration = calibration_for(&self.base()?);
        for channel in &mut calibration.channels {
            // A flawed or coarse sensor may well read the same for a while; that is no reason to stop.
            (channel.stuck_s, channel.missing_below) = (None, None);
        }
        let mut setup = Setup { noise_std: self.noise_std.clone(), ..Setup::new(truth, calibration, 0) };
        setup.drive.droop = self.droop;
        setup.empty_bits = setup.calibration.input.bits.saturating_sub(self.bits);
        Ok(setup)
    }

    fn truth(&self) -> Result<Truth, SimError> {
        let base = self.base()?;
        let mut flaws = Vec::new();
        for hidden in self.hidden.iter().map(concealed).chain(self.ripples(&base)) {
            if Flaw::is_one(&hidden.effect) {
                flaws.push((flawed_channel(&base, &hidden)?, Flaw::read(&hidden)?));
            }
        }
        let mut model = self.with_hidden(&base)?;
        self.add_small_masses(&base, &mut model);
        let own = [("mesh.contact_stiffness", self.flank_stiffness)];
        let changes = self.parameters.iter().map(|(name, value)| (name.as_str(), *value)).chain(own);
        for (name, value) in changes {
            if let Some(index) = model.parameter(name) {
                model.parameters[index].value = value;
            }
        }
        let truth = Truth { values: model.values(), model, flaws };
        truth.equations()?;
        Ok(truth)
    }

    /// The model with the physics that is hidden in this case, by the truth's own laws; sensors' faults are not in it.
    ///
    /// # Errors
    /// When an effect cannot act where it is hidden.
    pub fn with_hidden(&self, model: &Model) -> Result<Model, SimError> {
        let plant = |hidden: &&Hidden| !Flaw::is_one(&hidden.effect);
        let (named, own): (Vec<_>, Vec<_>) =
            self.hidden.iter().filter(plant).partition(|hidden| law_of(hidden).is_none());
        // What a model file can say comes first: it begins with the file's text again.
        let mut model = model.clone();
        for hidden in named {
            let values: Vec<(&str, f64)> =
                hidden.parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
            model = model.with_effect(&hidden.effect, &hidden.place, &values)?;
        }
        for hidden in own {
            let Some((effect, all)) = law_of(hidden) else { continue };
            for values in all {
                model = model.with_law(effect, &hidden.place, &values)?;
            }
        }
        Ok(model)
    }

    /// What the model takes to have no inertia has some, the same wherever the slow side would feel it. (At `torque_sensor_in`
    /// as many kg m² as there gain some hundreds in chi-square: a diagnosis would be right to call that missing inertia.)
    fn add_small_masses(&self, base: &Model, model: &mut Model) {
        let Some(slow) = base.nodes.last().map(|node| node.name.clone()) else { return };
        let bare: Vec<usize> =
            (0..model.nodes.len()).filter(|index| model.nodes[*index].inertia.is_none()).collect();
        for index in bare {
            let name = &model.nodes[index].name;
            let ratio = model.rigid_ratio(name, &slow).unwrap_or(1.0);
            model.parameters.push(Parameter {
                name: format!("small mass of {name}"),
                value: self.small_mass / (ratio * ratio),
                unit: "kg m2".into(),
                file_unit: "kg m2".into(),
                file_factor: 1.0,
                bounds: (0.0, f64::INFINITY),
                fixed: true,
                source: "challenge".into(),
                prior: None,
            });
            model.nodes[index].inertia = Some(model.parameters.len() - 1);
        }
    }

    /// Ripple of every tachometer, twice per turn.
    fn ripples<'a>(&'a self, base: &'a Model) -> impl Iterator<Item = Concealed> + 'a {
        let speeds = base.channels.iter().filter(|channel| channel.name.ends_with("_speed"));
        let noisy =
            speeds.filter_map(|channel| self.noise_std.iter().find(|(name, _)| *name == channel.name));
        let ripple = |(place, std): &(String, f64)| Concealed {
            effect: "sensor_ripple".into(),
            place: place.clone(),
            parameters: [("amplitude", self.tachometer_ripple * std), ("order", 2.0)]
                .map(|(name, value)| Override { name: name.into(), value })
                .to_vec(),
        };
        noisy.filter(|(_, std)| self.tachometer_ripple * std > 0.0).map(ripple)
    }
}

fn concealed(hidden: &Hidden) -> Concealed {
    let parameters = hidden.parameters.iter();
    Concealed {
        effect: hidden.effect.clone(),
        place: hidden.place.clone(),
        parameters: parameters.map(|(name, value)| Override { name: name.clone(), value: *value }).collect(),
    }
}

/// The truth's own law for an effect with its parameters, one set for each time that it is to act; `None` where the catalogue's
/// is the only way to write it.
fn law_of(hidden: &Hidden) -> Option<(&'static effects::Effect, Vec<Vec<f64>>)> {
    let p: Vec<f64> = hidden.parameters.iter().map(|(_, value)| *value).collect();
    Some(match hidden.effect.as_str() {
        "coulomb_friction" => (&laws::BRISTLES, vec![vec![p[0], p[0], 1.0, BRISTLE_DEFLECTION]]),
        "stribeck_friction" => (&laws::BRISTLES, vec![vec![p[0], p[1], p[2], BRISTLE_DEFLECTION]]),
        "quadratic_drag" => (&laws::DRAG, vec![vec![p[0], LAMINAR_SPEED]]),
        "direction_dependence" => (&laws::DIRECTION, vec![p]),
        "mesh_loss" => (&laws::LOSS, vec![p]),
        "backlash" => (&laws::CONTACT, vec![vec![p[0], 5e5, 0.5]]),
        "stiffness_hardening" => (&laws::HARDENING, vec![vec![p[0], 0.01 * p[0] * p[0]]]),
        "hysteresis" => (&laws::SLIDER, laws::sliders(p[0], p[1]).map(|pair| pair.to_vec()).collect()),
        "coupling_slip" => (&laws::SLIP, vec![p]),
        "eddy_current_brake" => (&laws::outside::EDDY_CURRENT_BRAKE, vec![p]),
        "late_pad" => (&laws::outside::LATE_PAD, vec![p]),
        "angle_play" => (&laws::outside::ANGLE_PLAY, vec![p]),
        "angle_drag" => (&laws::outside::ANGLE_DRAG, vec![p]),
        "loosening" => (&laws::outside::LOOSENING, vec![p]),
        "gain_drift" => (&laws::outside::GAIN_DRIFT, vec![p]),
        "wearing_in" => (&laws::outside::WEARING_IN, vec![p]),
        _ => return None,
    })
}

/// Bristles bend by so much before they slip, rad.
const BRISTLE_DEFLECTION: f64 = 1e-3;

/// Below this drag is laminar, rad/s.
const LAMINAR_SPEED: f64 = 0.3;
