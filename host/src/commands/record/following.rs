//! A drive that is to follow a profile: what is refused before anything leaves for it, and what is said. The command line and the window share it.

use std::path::Path;

use socam_core::Generator;
#[cfg(feature = "formats-can")]
use socam_recording::Unit;
use socam_recording::{ProfileCommand, ProfileFile, RecordingHeader};
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::{Commanded, Commands, Device, Drive, Limits};

use super::attachment;
use crate::device::source::{Node, Protocol, SourceAddress};

/// Time without a command after which a drive stops by itself, s: longer than an ordinary computer pauses, and short for a machine.
const WATCHDOG_S: f64 = 0.25;
/// The same while torques are commanded, s: a motor gains speed until then.
const WATCHDOG_OF_TORQUES_S: f64 = 0.1;

/// What a drive limits beside its speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Effort {
    Torque,
    Current,
}

impl Effort {
    /// What a drive limits beside its speed, by the list of its objects where it has one; an error for devices that take no commands.
    pub(crate) fn of(address: &SourceAddress, list: Option<&Path>) -> Result<Self, String> {
        drive(address, list, 1_000_000).map(|(_, effort)| effort)
    }

    fn unit(self) -> &'static str {
        if self == Self::Torque { "N m" } else { "A" }
    }
}

/// What a drive is to do.
#[derive(Debug, Clone)]
pub(crate) struct Wish {
    /// Name of the profile, for messages and the recording.
    pub(crate) name: String,
    pub(crate) profile: ProfileFile,
    pub(crate) period_us: u32,
    /// Limit of the speed, rad/s.
    pub(crate) speed_rad_s: f64,
    /// Limit of the torque, N m, or of the current, A.
    pub(crate) effort: f64,
}

/// A drive that is ready to follow a profile. Nothing has left for it.
pub(crate) struct Following {
    pub(crate) device: Box<dyn Device>,
    pub(crate) terms: Terms,
}

/// What a drive follows, and within which limits.
pub(crate) struct Terms {
    pub(crate) wish: Wish,
    /// Largest value of the profile, in its unit.
    pub(crate) peak: f64,
    /// Its limits, in words.
    pub(crate) limits: String,
    /// What the drive itself keeps to, and what it does not promise: a sentence each.
    pub(crate) promises: [Vec<String>; 2],
    /// The limit of each channel, in its unit.
    #[cfg(feature = "window")]
    pub(crate) channel_limits: Vec<Option<f64>>,
}

impl Following {
    /// A drive with a wish, unless the wish passes its limits; an error is one sentence.
    #[cfg(feature = "window")]
    pub(crate) fn new(address: &SourceAddress, wish: Wish) -> Result<Self, String> {
        Self::by_list(address, None, wish)
    }

    /// The same of a drive that may need a list of its objects.
    pub(crate) fn by_list(address: &SourceAddress, list: Option<&Path>, wish: Wish) -> Result<Self, String> {
        let period_ns = i64::from(wish.period_us) * 1000;
        let (mut drive, effort) = drive(address, list, period_ns)?;
        let Wish { name, profile, period_us, .. } = &wish;
        let commands = match profile.command {
            ProfileCommand::Voltage => {
                return Err(format!(
                    "the profile `{name}` commands a voltage; a drive takes speeds: `command = \"speed\"`, with levels and limits in rad/s, or torques: `command = \"torque\"`, in N m"
                ));
            }
            ProfileCommand::Torque if takes_speeds_alone(&address.protocol) => {
                return Err(format!(
                    "the profile `{name}` commands a torque; a drive with CANopen takes speeds: `command = \"speed\"`, with levels and limits in rad/s"
                ));
            }
            ProfileCommand::Torque => Commands::Torques,
            ProfileCommand::SpeedOpenLoop | ProfileCommand::SpeedClosedLoop => Commands::Speeds,
        };
        let longest_s = Commanded::longest_period_s();
        if f64::from(*period_us) * 1e-6 > longest_s {
            return Err(format!(
                "a drive is commanded at {} Hz or faster, not at {} Hz",
                1.0 / longest_s,
                1e6 / f64::from(*period_us)
            ));
        }
        let core = profile.sampled(*period_us).map_err(|error| error.to_string())?;
        let peak_micro = Generator::peak_micro(&core.shape, *period_us).map_err(|error| error.to_string())?;
        let peak = peak_micro as f64 * 1e-6;
        let limit = match (commands, effort) {
            (Commands::Speeds, _) => Some(wish.speed_rad_s),
            (Commands::Torques, Effort::Torque) => Some(wish.effort),
            // The drive's limit is one of current, which it keeps whatever the torque is.
            (Commands::Torques, Effort::Current) => None,
        };
        if let Some(limit) = limit.filter(|limit| peak > *limit) {
            let unit = profile.command.unit();
            return Err(format!(
                "the profile `{name}` reaches {peak} {unit}, beyond the limit of {limit} {unit}: nothing was commanded"
            ));
        }
        let limits = Limits {
            speed_rad_s: wish.speed_rad_s,
            effort: wish.effort,
            commands,
            acceleration_rad_s2: profile.slew,
            watchdog_s: if commands == Commands::Torques { WATCHDOG_OF_TORQUES_S } else { WATCHDOG_S },
        };
        drive.limit(limits);
        let promises = drive.promises();
        let device = Commanded::new(drive, &core, *period_us, limits)
            .map_err(|error| format!("the profile `{name}` cannot run: {error}"))?;
        let terms = Terms {
            peak,
            limits: format!("{} rad/s, {} {}", wish.speed_rad_s, wish.effort, effort.unit()),
            promises,
            wish,
            #[cfg(feature = "window")]
            channel_limits: device.channel_limits(),
        };
        Ok(Self { device: Box::new(device), terms })
    }
}

impl Terms {
    /// Time that the profile takes, s.
    pub(crate) fn planned_s(&self) -> f64 {
        self.wish.profile.duration_s + self.wish.profile.ramp_s
    }

    /// Says in a recording what is followed, and within which limits.
    pub(crate) fn describe(&self, header: &mut RecordingHeader) {
        header.planned_duration_s = Some(self.planned_s());
        header.metadata.insert("profile".into(), self.wish.name.clone());
        header.metadata.insert("limits".into(), self.limits.clone());
        header.attachments.extend(attachment("profile.toml", self.wish.profile.to_toml()));
    }
}

/// Whether torques cannot be commanded.
fn takes_speeds_alone(protocol: &Protocol) -> bool {
    matches!(protocol, Protocol::Can(Node::Canopen(_)))
}

/// The drive at an address, by the list of its objects where it has one, and what it limits beside its speed.
#[cfg_attr(
    not(feature = "formats-can"),
    expect(unused_variables, reason = "lists are those of drives on a CAN bus")
)]
fn drive(
    address: &SourceAddress,
    list: Option<&Path>,
    period_ns: i64,
) -> Result<(Box<dyn Drive>, Effort), String> {
    let words = |error: socam_sources::SourceError| error.to_string();
    Ok(match address.protocol {
        Protocol::Moteus(id) => (Box::new(Moteus::new(id, period_ns).map_err(words)?), Effort::Torque),
        Protocol::Odrive(axis) => (Box::new(Odrive::new(axis, period_ns).map_err(words)?), Effort::Current),
        #[cfg(feature = "formats-can")]
        Protocol::Can(Node::Odrive(node)) => {
            let drive = super::can::odrive(address, node, period_ns);
            (Box::new(drive.map_err(|error| format!("{error:#}"))?), Effort::Current)
        }
        #[cfg(feature = "formats-can")]
        Protocol::Can(Node::Canopen(node)) => {
            let drive = super::can::commanded(address, list, node, period_ns);
            let drive = drive.map_err(|error| format!("{error:#}"))?;
            let is_torque = drive.channels()[drive.watched().effort].unit == Unit::Nm;
            (Box::new(drive), if is_torque { Effort::Torque } else { Effort::Current })
        }
        Protocol::Text
        | Protocol::Can(_)
        | Protocol::Dynamixel(_)
        | Protocol::Feetech(_)
        | Protocol::Foxglove(_) => {
            return Err(format!(
                "a profile commands a board, a virtual bench or a drive; {address} is only listened to or asked, so it follows none"
            ));
        }
    })
}

/// What a drive limits beside its speed, and what it does not promise, whatever its limits are; `None` for devices that take no commands.
#[cfg(feature = "window")]
pub(crate) fn offered(address: &SourceAddress) -> Option<(Effort, Vec<String>)> {
    let (mut drive, effort) = drive(address, None, 1_000_000).ok()?;
    let commands = Commands::Speeds;
    drive.limit(Limits {
        speed_rad_s: 1.0,
        effort: 1.0,
        commands,
        acceleration_rad_s2: 1.0,
        watchdog_s: WATCHDOG_S,
    });
    let [_, not_promised] = drive.promises();
    Some((effort, not_promised))
}
