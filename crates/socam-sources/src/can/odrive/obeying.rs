//! An ODrive on a CAN bus as a drive that obeys orders.

use std::f64::consts::TAU;

use super::trial::Trial;
use super::{OdriveCan, TEMPERATURES_EVERY};
use crate::drive::{Commands, Drive, Limits, Order, Readiness, Standing, Watched};
use crate::odrive::Generation;

/// States of an axis: idle, and obeying.
const IDLE: u8 = 1;
const CLOSED_LOOP: u8 = 8;
/// Age, ns, at which a heartbeat says nothing any more; a drive sends one each 0.1 s unless told otherwise.
const HEARTBEAT_NS: i64 = 500_000_000;

impl Drive for OdriveCan {
    fn watched(&self) -> Watched {
        // Positions of an ODrive may begin anew after a turn.
        Watched { speed: 1, effort: 2, position: None }
    }

    fn limit(&mut self, limits: Limits) {
        self.limits = Some(limits);
    }

    fn order(&mut self, order: Order) {
        self.order = order;
        if order == Order::Prepare {
            self.trial.begin(self.now_ns);
        }
    }

    fn bytes(&self, order: Order) -> Vec<u8> {
        let to = self.to;
        // What is commanded is set before the axis obeys, which is requested once: an axis that switches itself off stays off.
        let obeyed = |command: Vec<u8>| {
            let state = if self.is_begun { Vec::new() } else { to.state(CLOSED_LOOP) };
            [command, state].concat()
        };
        let mut lines = match (order, self.limits) {
            (Order::Speed(speed_rad_s), Some(_)) => obeyed(to.velocity(speed_rad_s / TAU)),
            (Order::Torque(torque_nm), Some(_)) => obeyed(to.torque(torque_nm)),
            (Order::Stop, _) => to.state(IDLE),
            (Order::Prepare, Some(limits)) => {
                let settings = to.settings(limits.commands, limits.speed_rad_s / TAU, limits.effort);
                [to.clear_errors(), settings, to.velocity(0.0), to.torque(0.0)].concat()
            }
            // Its modes and limits cannot be read, so they cannot be put back; no speed or torque is left behind.
            (Order::Release, Some(_)) => [to.velocity(0.0), to.torque(0.0)].concat(),
            (Order::Ask | Order::Speed(_) | Order::Torque(_) | Order::Prepare | Order::Release, _) => {
                Vec::new()
            }
        };
        lines.extend(to.sample());
        if self.generation() == Generation::Late && self.questions.is_multiple_of(TEMPERATURES_EVERY) {
            lines.extend(to.temperatures());
        }
        lines
    }

    fn standing(&self) -> Standing {
        let silent = || Standing::Other("silent about its state: it sends no heartbeats".into());
        // Whether it has stopped is said by its state alone.
        if self.has_rival && !matches!(self.order, Order::Stop | Order::Release) {
            return Standing::Fault("another program on the bus commands this ODrive".into());
        }
        let Some((arrival_ns, error, state)) = self.heartbeat else { return silent() };
        let is_expiry = error == self.generation().watchdog() && self.trial.expects_expiry();
        match state {
            _ if self.now_ns.saturating_sub(arrival_ns) > HEARTBEAT_NS => silent(),
            _ if error != 0 && !is_expiry => Standing::Fault(self.generation().fault_text(error)),
            IDLE => Standing::Stopped,
            CLOSED_LOOP => Standing::Obeying,
            state => Standing::Other(format!("in state {state}")),
        }
    }

    fn readiness(&self) -> Readiness {
        match &self.trial {
            Trial::Passed => Readiness::Ready,
            Trial::Failed(why) => Readiness::Refused(why.clone()),
            _ => Readiness::Pending,
        }
    }

    fn promises(&self) -> [Vec<String>; 2] {
        let Some(Limits { speed_rad_s, effort, watchdog_s, commands, .. }) = self.limits else {
            return Default::default();
        };
        let of_torques = [
            "Whether the axis limits its speed under a torque cannot be read (`controller.config.enable_torque_mode_vel_limit`, by default on): this computer stops it where it states more than its limit, and without this computer it turns faster until its watchdog acts.",
            "A torque is a current by the drive's own torque constant: where that is wrong, so is the torque.",
        ];
        let of_torques = of_torques.into_iter().filter(|_| commands == Commands::Torques).map(str::to_owned);
        [
            vec![
                format!("The axis is told a speed limit of {speed_rad_s} rad/s and a current limit of {effort} A; the run ends where it states more."),
                format!("Its own watchdog is tried at standstill: it is commanded only if that acts within {watchdog_s} s of silence and two intervals of its heartbeats."),
            ],
            vec![
                "CAN Simple reads no settings back: whether the axis took these limits is not known, they replace lower ones of its own, and they and the mode of control stay until it is restarted.".into(),
                "A motor that is switched off coasts, by the watchdog as at the end: nothing brakes it, and a weight falls.".into(),
            ]
            .into_iter()
            .chain(of_torques)
            .collect(),
        ]
    }
}
