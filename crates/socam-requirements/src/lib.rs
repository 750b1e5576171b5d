//! Requirements of a model on recordings for its identification, for the command `check` and for the dashboard, also in a browser.

use socam_model::{
    Channel, ChannelTransform, EffectUse, Mode, Model, Quantity, Role, Site, column_unit, effects::Condition,
};
use socam_recording::check::{
    AlongShaft, BothWays, CheckOptions, FixedRatio, FreeParameters, Resonance, Speed,
};

/// Damping ratio above which a mode has no resonance peak.
const NO_PEAK: f64 = 0.7;

/// A parameter counts as resonant if its influence on the resonance is at least this fraction of the strongest parameter's.
const INFLUENCE: f64 = 0.2;

/// Relative step of a parameter by which its influence is computed.
const STEP: f64 = 1e-4;

/// The requirements of a model; `ratio_tolerance` is the relative tolerance of the ratio of mean speeds.
#[must_use]
pub fn of_model(model: &Model, ratio_tolerance: f64) -> CheckOptions {
    let outputs = model.outputs().count();
    let parameters = model.parameters.iter().filter(|parameter| !parameter.fixed).count();
    CheckOptions {
        input: input(model).map(|channel| channel.column.clone()),
        units: units(model),
        channels: model.inputs().chain(model.outputs()).map(|channel| channel.column.clone()).collect(),
        ratios: ratios(model, ratio_tolerance),
        shafts: shafts(model),
        resonances: resonances(model),
        both_ways: both_ways(model).into_iter().collect(),
        free: Some(FreeParameters { parameters, outputs }),
    }
}

/// The channel that drives the model. A channel whose column holds its own quantity is preferred to one that is derived from a
/// column, such as the rate of an encoder's angle, whose excitation is checked as a rate.
fn input(model: &Model) -> Option<&Channel> {
    let mut inputs = model.inputs().filter(|channel| !channel.quantity.is_clock());
    model.inputs().find(|channel| is_recorded(channel)).or_else(|| inputs.next())
}

/// Units of channels whose column name has no unit and which the model does not scale.
fn units(model: &Model) -> Vec<(String, String)> {
    let read = model.channels.iter().filter(|channel| !channel.quantity.is_clock() && is_recorded(channel));
    let unscaled = read.filter(|channel| column_unit(&channel.column).is_none() && channel.scale == 1.0);
    unscaled.map(|channel| (channel.column.clone(), channel.unit.to_owned())).collect()
}

/// Whether the column holds the quantity of the channel, so that statistics of the column apply to it.
fn is_recorded(channel: &Channel) -> bool {
    channel.transform == ChannelTransform::Value
}

/// Speed ratios of all speeds to the first one, if rigid parts and springs connect them.
fn ratios(model: &Model, tolerance: f64) -> Vec<FixedRatio> {
    let recorded = model.inputs().chain(model.outputs()).filter(|channel| is_recorded(channel));
    let mut speeds = recorded.filter(|channel| channel.quantity == Quantity::Speed);
    let Some(first) = speeds.next() else {
        return Vec::new();
    };
    let speed = |channel: &Channel| Speed {
        channel: channel.column.clone(),
        scale: channel.scale,
        offset: channel.offset,
    };
    let tied = speeds.filter_map(|other| {
        let ratio = model.rigid_ratio(&first.at, &other.at)?;
        let (fast, slow, ratio) =
            if ratio.abs() >= 1.0 { (first, other, ratio) } else { (other, first, 1.0 / ratio) };
        Some(FixedRatio { fast: speed(fast), slow: speed(slow), ratio, tolerance })
    });
    tied.collect()
}

/// Speeds beside the angles and torques of their own node.
fn shafts(model: &Model) -> Vec<AlongShaft> {
    let all = || model.inputs().chain(model.outputs()).filter(|channel| is_recorded(channel));
    let of = |channel: &Channel| Speed {
        channel: channel.column.clone(),
        scale: channel.scale,
        offset: channel.offset,
    };
    let torques = model.inputs().filter(|input| input.quantity == Quantity::Torque).count();
    let pair = |speed: &Channel, other: &Channel| match other.quantity {
        Quantity::Angle => Some(AlongShaft::Angle { speed: of(speed), angle: of(other) }),
        Quantity::Torque if other.role == Role::Input && torques == 1 => {
            Some(AlongShaft::Torque { speed: of(speed), torque: of(other) })
        }
        _ => None,
    };
    let speeds = all().filter(|channel| channel.quantity == Quantity::Speed);
    speeds
        .flat_map(|speed| {
            let beside = all().filter(|other| other.at == speed.at && other.column != speed.column);
            beside.filter_map(|other| pair(speed, other)).collect::<Vec<_>>()
        })
        .collect()
}

/// Without a reversal, dry friction and a constant load cannot be distinguished.
fn both_ways(model: &Model) -> Option<BothWays> {
    let free = |used: &EffectUse| {
        let parameter = used.parameters.iter().map(|index| &model.parameters[*index]).find(|p| !p.fixed)?;
        let Site::Node(node) = used.at else { return None };
        Some((&model.nodes[node].name, parameter.name.clone()))
    };
    let alike = |used: &EffectUse, other: &EffectUse| {
        let mut known = used.effect.equivalents.iter();
        known.any(|own| own.effect == other.effect.id && own.holds == Condition::OneDirection)
    };
    let all = || model.effects.iter();
    let mut pairs = all().flat_map(|used| all().map(move |other| (used, other)));
    let pair =
        pairs.find_map(|(used, other)| Some((free(used)?, free(other)?)).filter(|_| alike(used, other)));
    let ((place, friction), (_, load)) = pair?;
    let mut motions = model
        .channels
        .iter()
        .filter(|c| is_recorded(c) && matches!(c.quantity, Quantity::Speed | Quantity::Angle));
    let channel = motions.find(|channel| model.rigid_ratio(&channel.at, place).is_some())?;
    Some(BothWays { channel: channel.column.clone(), parameters: vec![friction, load] })
}

/// Frequency relative to the fastest mode below which a mode is a free rotation, not 0 Hz because of rounding.
const FREE_ROTATION: f64 = 1e-6;

/// The model's resonances at its file's values that depend on a free parameter, lowest first.
fn resonances(model: &Model) -> Vec<Resonance> {
    let modes_at = |values: &[f64]| model.equations(values).map(|equations| equations.modes());
    let values = model.values();
    let Ok(modes) = modes_at(&values) else {
        return Vec::new();
    };
    let free = (0..values.len()).filter(|index| !model.parameters[*index].fixed && values[*index] != 0.0);
    let shifted: Vec<(usize, Vec<Mode>)> = free
        .filter_map(|index| {
            let mut values = values.clone();
            values[index] *= 1.0 + STEP;
            Some((index, modes_at(&values).ok()?))
        })
        .collect();
    let fastest = modes.iter().map(|mode| mode.natural_frequency_hz).fold(0.0, f64::max);
    let swings = |mode: &&Mode| mode.natural_frequency_hz > FREE_ROTATION * fastest;
    let peaks = modes.iter().filter(swings).filter(|mode| mode.damping_ratio < NO_PEAK);
    peaks
        .map(|mode| Resonance {
            frequency_hz: mode.natural_frequency_hz,
            parameters: deciding(model, mode, &shifted),
        })
        .filter(|resonance| !resonance.parameters.is_empty())
        .collect()
}

/// Names of the parameters that influence a mode's frequency or damping, strongest first.
fn deciding(model: &Model, mode: &Mode, shifted: &[(usize, Vec<Mode>)]) -> Vec<String> {
    let distance = |other: &Mode| (other.pole - mode.pole).norm();
    let influences: Vec<(usize, [f64; 2])> = shifted
        .iter()
        .filter_map(|(index, modes)| {
            let moved = modes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            let relative = |after: f64, before: f64| (after / before - 1.0).abs() / STEP;
            let frequency = relative(moved.natural_frequency_hz, mode.natural_frequency_hz);
            Some((*index, [frequency, relative(moved.damping_ratio, mode.damping_ratio)]))
        })
        .collect();
    let strongest =
        [0, 1].map(|kind| influences.iter().map(|(_, i)| i[kind]).fold(f64::MIN_POSITIVE, f64::max));
    let mut shares: Vec<(usize, f64)> = influences
        .iter()
        .map(|(index, influence)| (*index, (influence[0] / strongest[0]).max(influence[1] / strongest[1])))
        .filter(|(_, share)| *share >= INFLUENCE)
        .collect();
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    shares.into_iter().map(|(index, _)| model.parameters[index].name.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_model_names_its_input_ratio_and_resonances() {
        let options = of_model(&Model::builtin("speed-o-cam").unwrap(), 0.01);
        assert_eq!(options.input.as_deref(), Some("motor_speed_rad_s"));
        assert_eq!(options.channels.len(), 4);
        let [ratio] = &options.ratios[..] else { panic!("{:?}", options.ratios) };
        assert_eq!((ratio.fast.channel.as_str(), ratio.ratio), ("motor_speed_rad_s", 8.0));
        assert!(options.resonances.iter().all(|r| !r.parameters.is_empty()));
        assert!(!options.resonances.is_empty());
    }

    #[test]
    fn a_column_without_a_unit_is_in_that_of_its_quantity_unless_the_model_scales_it() {
        let torque = "role = \"input\"\nquantity = \"torque\"";
        let named = |lines: &str| {
            let text =
                Model::builtin("two-mass").unwrap().text.replacen(torque, &format!("{torque}\n{lines}"), 1);
            of_model(&Model::parse(&text).unwrap(), 0.01).units
        };
        assert_eq!(named("column = \"drive\""), [("drive".to_owned(), "N m".to_owned())]);
        assert_eq!(named("column = \"drive\"\nscale = 0.05"), []);
    }

    #[test]
    fn a_free_axis_has_no_resonance_at_standstill() {
        // Nothing but rounding keeps the angle of a free axis from 0 Hz, where a sensor of angles looks at it.
        let text = Model::builtin("two-mass").unwrap().text;
        let angle =
            text.replacen("quantity = \"speed\"\nat = \"load\"", "quantity = \"angle\"\nat = \"load\"", 1);
        for factor in [0.0_f64, 1e-3, 1.0, 1e3] {
            let damping = format!("motor_damping = {{ value = {}", 4e-3 * factor);
            let free = angle.replacen("motor_damping = { value = 4e-3", &damping, 1).replacen(
                "load_damping = { value = 8e-3",
                &format!("load_damping = {{ value = {}", 8e-3 * factor.min(1.0)),
                1,
            );
            let options = of_model(&Model::parse(&free).unwrap(), 0.01);
            assert!(
                options.resonances.iter().all(|r| r.frequency_hz > 10.0),
                "{factor}: {:?}",
                options.resonances
            );
        }
    }

    #[test]
    fn the_rate_of_an_encoder_is_an_input() {
        let speed = "[channels.motor_speed]\nrole = \"input\"\nquantity = \"speed\"\nat = \"motor\"";
        let text = Model::builtin("speed-o-cam").unwrap().text;
        assert!(text.contains(speed));
        let encoder = format!("{speed}\ncolumn = \"encoder_rad\"\ntake = \"rate\"");
        let model = Model::parse(&text.replacen(speed, &encoder, 1)).unwrap();
        assert_eq!(of_model(&model, 0.01).input.as_deref(), Some("encoder_rad"));
    }

    #[test]
    fn speeds_are_told_fast_from_slow_and_axes_need_none() {
        let two_mass = of_model(&Model::builtin("two-mass").unwrap(), 0.01);
        assert_eq!(two_mass.input.as_deref(), Some("motor_torque_Nm"));
        assert_eq!(two_mass.ratios[0].ratio, 1.0);
        let [resonance] = &two_mass.resonances[..] else { panic!("{:?}", two_mass.resonances) };
        // sqrt(k (1/Jm + 1/Jl)) / 2 pi
        assert!((resonance.frequency_hz - 58.9).abs() < 0.5, "{resonance:?}");
        assert!(resonance.parameters.iter().any(|name| name == "stiffness"), "{resonance:?}");
        let emps = of_model(&Model::builtin("emps").unwrap(), 0.01);
        assert_eq!((emps.ratios.len(), emps.resonances.len()), (0, 0));
        assert_eq!(emps.both_ways[0].channel, "position_m");
        assert_eq!(emps.both_ways[0].parameters, ["coulomb", "offset"]);
        assert!(two_mass.both_ways.is_empty());
    }
}
