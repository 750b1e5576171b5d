//! What a list of objects says of commands: without it nothing is ever written to a drive.

use socam_recording::Fields;

use super::messages::LARGEST_NODE;
use crate::drive::Limits;

/// Number of this computer on the bus, whose heartbeat the drive waits for.
const OWN_NODE: u8 = 127;

/// A limit that a drive keeps itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OwnLimit {
    /// 607F, in the unit of the target velocity.
    ProfileVelocity,
    /// 6080, rpm.
    MotorSpeed,
    /// 6072, in the unit of 6077.
    Torque,
    /// 6073, in the unit of 6078.
    Current,
}

impl OwnLimit {
    /// Those of a speed; the others are of an effort.
    pub(super) fn is_of_speed(self) -> bool {
        matches!(self, Self::ProfileVelocity | Self::MotorSpeed)
    }
}

/// The table `[commands]` of a list: the operator states that the drive may be commanded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Marked {
    /// Speed of one count of the target velocity (60FF), rad/s.
    pub(super) factor: f64,
    pub(super) limits: Vec<OwnLimit>,
    /// Number of this computer on the bus.
    pub(super) own_node: u8,
}

/// Reads the table; its mistakes are those of the fields.
pub(super) fn read(fields: &mut Fields<'_>) -> Option<Marked> {
    let is_allowed = fields.flag("may_be_written");
    let unit = fields.text("unit");
    let scale = fields.maybe_number("scale", -1e9..=1e9).unwrap_or(1.0);
    if scale == 0.0 {
        fields.complain_about("scale", "`scale` is 0; expected the speed of one count of 60FF".into());
    }
    let rad_s = socam_units::parse("rad/s").map(|known| known.dimension);
    let known = socam_units::parse(&unit).filter(|known| Some(known.dimension) == rad_s);
    if known.is_none() && !unit.is_empty() {
        let message =
            format!("`unit` is \"{unit}\"; expected that of the target velocity (60FF), as in \"rpm\"");
        fields.complain_about("unit", message);
    }
    let mut limits = Vec::new();
    for text in fields.maybe_texts("limits").unwrap_or_default() {
        match text.to_uppercase().as_str() {
            "607F" => limits.push(OwnLimit::ProfileVelocity),
            "6080" => limits.push(OwnLimit::MotorSpeed),
            "6072" => limits.push(OwnLimit::Torque),
            "6073" => limits.push(OwnLimit::Current),
            _ => {
                let message = format!(
                    "`limits` holds \"{text}\"; expected \"607F\" or \"6080\" (speed), \"6072\" (torque) or \"6073\" (current)"
                );
                fields.complain_about("limits", message);
            }
        }
    }
    let own = fields.maybe_whole("heartbeat_node", 1..=u32::from(LARGEST_NODE)).map(|node| node as u8);
    let factor = scale * known?.factor;
    is_allowed.then_some(Marked { factor, limits, own_node: own.unwrap_or(OWN_NODE) })
}

impl Marked {
    /// What a drive keeps to by itself, and what it does not promise, with the symbol of the effort's unit.
    pub(super) fn promises(&self, limits: &Limits, symbol: &str) -> [Vec<String>; 2] {
        let Limits { speed_rad_s, effort, watchdog_s, .. } = *limits;
        let own = self.own_node;
        let mut kept = vec![format!(
            "It gets a heartbeat of node {own} to wait for (1016:01), and a quick stop (6007) where that is missing. Both are tried with the motor enabled at speed 0: it is commanded only if it states within {watchdog_s} s of the last heartbeat that it is enabled no longer."
        )];
        let mut not_promised = Vec::new();
        let has = |is_of_speed| self.limits.iter().any(|limit| limit.is_of_speed() == is_of_speed);
        let [of_speed, of_effort] =
            [format!("a speed of {speed_rad_s} rad/s"), format!("an effort of {effort} {symbol}")];
        let mut tell = |is_listed: bool, what: &str, objects: &str| {
            if is_listed {
                kept.push(format!("It is told to keep to {what} ({objects}), and is commanded only if it states that; a lower limit of its own stays."));
            } else {
                not_promised.push(format!("The list of objects names no limit for {what} (`limits`, {objects}): the drive does not keep to it by itself, this computer ends the run where it states more."));
            }
        };
        tell(has(true), &of_speed, "607F or 6080");
        tell(has(false), &of_effort, "6072 or 6073");
        kept.push("A stop is its quick stop (6040), then its voltage is switched off; the run ends where it states more than the limits.".into());
        not_promised.push("How fast it brakes in a quick stop is its own setting (605A, 6085); so are its acceleration and deceleration (6083, 6084), and a steeper profile is followed late.".into());
        not_promised
            .push("A motor whose voltage is off coasts: nothing brakes it, and a weight falls.".into());
        [kept, not_promised]
    }
}
