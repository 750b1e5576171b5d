//! The objects by which a drive that is commanded is watched.

use socam_units::Unit;

use super::commands::{Marked, OwnLimit};
use super::messages::STATUSWORD;
use super::objects::Objects;
use super::place::Place;
use crate::drive::Watched;
use crate::error::{Result, SourceError};

/// Speed, torque and current of CiA 402.
const SPEED: Place = (0x606c, 0);
const TORQUE: Place = (0x6077, 0);
const CURRENT: Place = (0x6078, 0);
impl Objects {
    /// What a drive's commands need of the list, and the channels that limits are compared with.
    ///
    /// # Errors
    /// What must be written into the list.
    pub(super) fn commanded(&self) -> Result<(Marked, Watched)> {
        let Some(marked) = self.marked.clone() else {
            return Err(SourceError::Foreign(
                "the list of objects does not say that this drive may be commanded: once you have made sure that it may move, add a table [commands] with `may_be_written = true`, and `unit` and `scale` of its target velocity (60FF)".into(),
            ));
        };
        let find = |place: Place, unit: Unit| {
            self.all.iter().position(|object| object.place == place && object.map.unit == unit)
        };
        let effort = find(TORQUE, Unit::Nm).or_else(|| find(CURRENT, Unit::A));
        let has_status = self.all.iter().any(|object| object.place == STATUSWORD);
        let (Some(speed), Some(effort), true) = (find(SPEED, Unit::RadPerS), effort, has_status) else {
            return Err(SourceError::Foreign(
                "a drive that is commanded is watched by its speed (606C, as rad/s or rpm), its torque (6077, as N m) or current (6078, as A), and its statusword (6041): add those that are missing to the list of objects".into(),
            ));
        };
        let is_torque = self.all[effort].place == TORQUE;
        let other = if is_torque { OwnLimit::Current } else { OwnLimit::Torque };
        if marked.limits.contains(&other) {
            let (limit, kind, object) =
                if is_torque { ("6073", "current", "6078") } else { ("6072", "torque", "6077") };
            return Err(SourceError::Foreign(format!(
                "`limits` of the list of objects names {limit}, but the limit of this run is not one of a {kind}: leave it out, or record {object} instead"
            )));
        }
        Ok((marked, Watched { speed, effort, position: None }))
    }
}
