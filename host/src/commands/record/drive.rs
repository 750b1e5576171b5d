//! `record` of a drive that follows a profile: what is required, and what is said, before anything leaves for it.

use super::Args;
use super::following::{Effort, Following, Terms, Wish};
use crate::device::Device as Board;
use crate::device::source::SourceAddress;
use crate::output::{self, WrongArguments};

/// Options of a drive that follows a profile.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct DriveArgs {
    /// Limits of a drive that follows --profile: one of its speed, and one of its torque (moteus) or current (ODrive), with
    /// CANopen whichever the list of objects names, as in --limit 30rad/s --limit 0.5Nm. The drive is told them, and the run ends where they are exceeded
    #[arg(long = "limit", value_name = "LIMIT", value_parser = limit)]
    limits: Vec<Limit>,
    /// Let a drive follow --profile. Without it, what would happen is said, and nothing is sent
    #[arg(long)]
    arm: bool,
}

/// A limit by its unit, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Limit {
    Speed(f64),
    Torque(f64),
    Current(f64),
}

/// A limit as text: `30rad/s`, `300 rpm`, `0.5 N m`, `5A`.
fn limit(text: &str) -> Result<Limit, String> {
    let expected = "expected a speed, torque or current, as in 30rad/s, 300rpm, 0.5Nm or 5A";
    let split =
        text.find(|c: char| c.is_ascii_alphabetic()).ok_or(format!("{expected}; the unit is missing"))?;
    let (number, unit) = text.split_at(split);
    let number = number.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value > 0.0);
    let (number, scale) = number.zip(socam_units::parse(unit)).ok_or(expected)?;
    let of = |unit: &str| socam_units::parse(unit).map(|scale| scale.dimension);
    let value = number * scale.factor;
    match Some(scale.dimension) {
        dimension if dimension == of("rad/s") && !unit.contains("Hz") => Ok(Limit::Speed(value)),
        dimension if dimension == of("N m") => Ok(Limit::Torque(value)),
        dimension if dimension == of("A") => Ok(Limit::Current(value)),
        _ => Err(expected.into()),
    }
}

impl DriveArgs {
    /// Refuses the options for a board, whose firmware has limits of its own.
    pub(super) fn refuse_for(&self, board: &Board) -> Result<(), WrongArguments> {
        if self.is_set() {
            return Err(WrongArguments(format!("--arm and --limit are for drives, not for {board}")));
        }
        Ok(())
    }

    pub(super) fn is_set(&self) -> bool {
        self.arm || !self.limits.is_empty()
    }
}

/// The drive that follows the profile of the arguments; `None` without one. Refuses what passes the limits, and says what is promised.
pub(super) fn armed(args: &Args, address: &SourceAddress) -> anyhow::Result<Option<Following>> {
    let wrong = |problem: String| anyhow::Error::from(WrongArguments(problem));
    let Some(name) = args.record.profile.clone() else {
        if args.drive.is_set() {
            return Err(wrong("--arm and --limit let a drive follow a profile: name it by --profile".into()));
        }
        return Ok(None);
    };
    let list = args.source.describe.as_deref();
    let effort = Effort::of(address, list).map_err(wrong)?;
    let profile = args.record.load()?;
    let [speed_rad_s, effort] = limits(&args.drive, effort)?;
    let wish = Wish { name, profile, period_us: args.record.period_us()?, speed_rad_s, effort };
    let following = Following::by_list(address, list, wish).map_err(wrong)?;
    let Terms { wish, limits, peak, promises: [kept, not_promised], .. } = &following.terms;
    output::say(format_args!(
        "{address} is to follow `{}`: up to {peak} {} for {:.1} s, within {limits}.",
        wish.name,
        wish.profile.command.unit(),
        following.terms.planned_s()
    ));
    kept.iter().for_each(|promise| output::say(format_args!("  {promise}")));
    not_promised.iter().for_each(output::warn);
    if !args.drive.arm {
        return Err(wrong("nothing was sent: add --arm to let the drive move".into()));
    }
    Ok(Some(following))
}

/// The limits of the arguments: one of each kind, and no other; that of the speed first.
fn limits(args: &DriveArgs, effort: Effort) -> anyhow::Result<[f64; 2]> {
    let (mut speeds, mut efforts) = (Vec::new(), Vec::new());
    for limit in &args.limits {
        match (*limit, effort) {
            (Limit::Speed(value), _) => speeds.push(value),
            (Limit::Torque(value), Effort::Torque) | (Limit::Current(value), Effort::Current) => {
                efforts.push(value)
            }
            (Limit::Torque(_), Effort::Current) => {
                let problem = "an ODrive, or a drive whose list names a current, limits its current, not its torque, as in --limit 5A";
                return Err(WrongArguments(problem.into()).into());
            }
            (Limit::Current(_), Effort::Torque) => {
                let problem = "a moteus limits its torque, not its current, as in --limit 0.5Nm; so does a drive whose list names a torque";
                return Err(WrongArguments(problem.into()).into());
            }
        }
    }
    let ([speed_rad_s], [effort]) = (&speeds[..], &efforts[..]) else {
        let second = if effort == Effort::Torque {
            "torque, as in --limit 30rad/s --limit 0.5Nm"
        } else {
            "current, as in --limit 30rad/s --limit 5A"
        };
        return Err(WrongArguments(format!(
            "a drive that follows a profile needs one --limit of its speed and one of its {second}"
        ))
        .into());
    };
    Ok([*speed_rad_s, *effort])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_told_apart_by_their_unit() {
        let near = |text: &str, wanted: f64| {
            let Ok(Limit::Speed(value) | Limit::Torque(value) | Limit::Current(value)) = limit(text) else {
                panic!("{text}")
            };
            assert!((value - wanted).abs() < 1e-12 * wanted, "{text} {value}");
        };
        near("30rad/s", 30.0);
        near("300 rpm", std::f64::consts::PI * 10.0);
        near("0.5Nm", 0.5);
        near("50 N cm", 0.5);
        near("5000 mA", 5.0);
        for text in ["30", "rad/s", "-1A", "nanA", "3Hz", "3 kg", "0Nm"] {
            assert!(limit(text).is_err(), "{text}");
        }
    }
}
