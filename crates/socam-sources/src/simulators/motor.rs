//! The motor of a simulated drive, and what can go wrong with both.

/// Time step of the motor, s.
const STEP_S: f64 = 2e-4;
/// Controller of the speed: damping, N m s/rad, and its integral, N m/rad.
const DAMPING: f64 = 0.05;
const STIFFNESS: f64 = 0.5;
/// Speed over which dry friction changes its sign, rad/s.
const ROUNDED_RAD_S: f64 = 0.05;

/// What turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Inertia, kg m2.
    pub inertia_kg_m2: f64,
    /// Viscous damping, N m s/rad.
    pub damping_nm_s: f64,
    /// Dry friction, N m.
    pub friction_nm: f64,
}

/// The motor of a simulated drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    /// What it moves; a motor without it turns evenly, whatever it is told.
    pub inertia: Option<Inertia>,
    /// Angle, rad.
    pub angle_rad: f64,
    /// Speed, rad/s.
    pub speed_rad_s: f64,
    /// Torque, N m.
    pub torque_nm: f64,
    /// Torque per current, N m/A.
    pub torque_constant_nm_a: f64,
    /// Supply, V.
    pub voltage_v: f64,
    /// Integral of the controller, N m.
    integral_nm: f64,
}

/// What goes wrong with a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mishap {
    /// It has no power: no answers, no torque.
    Dies,
    /// Its program hangs: no answers, and the motor goes on.
    Freezes,
    /// It reports this fault and switches its motor off.
    Fault(u32),
    /// It states a speed of 0 and turns twice as fast as it is told.
    Lies,
    /// It turns twice as fast as it is told, and states so.
    RunsAway,
}

/// What a drive wants of its motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Want {
    /// It coasts.
    Off,
    /// A speed, rad/s, with at most this torque, N m.
    Speed(f64, f64),
    /// A torque, N m.
    Torque(f64),
}

impl Motor {
    /// A motor that is turned evenly by something else, with this torque and 1 N m/A.
    #[must_use]
    pub fn turning(speed_rad_s: f64, torque_nm: f64, voltage_v: f64) -> Self {
        Self { torque_nm, speed_rad_s, voltage_v, inertia: None, ..Self::at_rest(Inertia::SMALL, 1.0) }
    }

    /// A motor at rest behind a supply of 24 V.
    #[must_use]
    pub fn at_rest(inertia: Inertia, torque_constant_nm_a: f64) -> Self {
        Self {
            inertia: Some(inertia),
            angle_rad: 0.0,
            speed_rad_s: 0.0,
            torque_nm: 0.0,
            torque_constant_nm_a,
            voltage_v: 24.0,
            integral_nm: 0.0,
        }
    }

    /// Current, A.
    #[must_use]
    pub fn current_a(&self) -> f64 {
        self.torque_nm / self.torque_constant_nm_a
    }

    /// Moves it on by a time, s.
    pub(super) fn advance(&mut self, seconds: f64, want: Want) {
        let Some(inertia) = self.inertia else {
            self.angle_rad += self.speed_rad_s * seconds;
            return;
        };
        let steps = (seconds / STEP_S).ceil().max(0.0);
        for _ in 0..steps as u64 {
            self.step(seconds / steps, inertia, want);
        }
    }

    fn step(&mut self, seconds: f64, inertia: Inertia, want: Want) {
        self.torque_nm = match want {
            Want::Off => {
                self.integral_nm = 0.0;
                0.0
            }
            Want::Torque(torque_nm) => {
                self.integral_nm = 0.0;
                torque_nm
            }
            Want::Speed(wanted_rad_s, most_nm) => {
                let error = wanted_rad_s - self.speed_rad_s;
                self.integral_nm = (self.integral_nm + STIFFNESS * error * seconds).clamp(-most_nm, most_nm);
                (DAMPING * error + self.integral_nm).clamp(-most_nm, most_nm)
            }
        };
        let dry_nm = inertia.friction_nm * (self.speed_rad_s / ROUNDED_RAD_S).tanh();
        let losses_nm = dry_nm + inertia.damping_nm_s * self.speed_rad_s;
        self.speed_rad_s += seconds * (self.torque_nm - losses_nm) / inertia.inertia_kg_m2;
        self.angle_rad += seconds * self.speed_rad_s;
    }
}

impl Inertia {
    /// That of a small motor with a disc.
    pub const SMALL: Self = Self { inertia_kg_m2: 4e-4, damping_nm_s: 5e-4, friction_nm: 0.01 };
}
