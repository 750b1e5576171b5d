//! How large concealed effects are, and where: the one table from just detectable to gross.

use super::Hidden;
use super::random::Draw;

/// Least and greatest size, drawn log-uniformly; what is measured is the effect's first parameter unless `hide` says otherwise.
/// The least ones gain some tens in whitened chi-square on two held-out recordings at the usual noise of the sensors.
pub(super) type Range = (&'static str, &'static [(&'static str, (f64, f64))]);

/// The catalogue at its places on the default bench, and torque ripple on the two-mass drive. Left out are places at which
/// nothing can show: the driven node, and `roller_pins` as a spring that hardens or rubs, because it winds up a thousandth of
/// what the couplings do. `load_hub` is the load by another name.
pub(super) const RANGES: [Range; 24] = [
    ("coulomb_friction", &[("load_bearing", (1.5e-3, 1.2)), ("cam_bearing", (2e-4, 0.15))]),
    ("stribeck_friction", &[("load_bearing", (2e-3, 1.0)), ("cam_bearing", (2e-4, 0.12))]),
    ("quadratic_drag", &[("load_bearing", (1.5e-5, 5e-3)), ("cam_bearing", (3e-8, 1e-5))]),
    ("damping_drift", &[("load_bearing", (6e-4, 8e-2))]),
    ("direction_dependence", &[("load_bearing", (2e-3, 1.0)), ("cam_bearing", (3e-4, 0.12))]),
    ("constant_load", &[("load", (5e-4, 1.5))]),
    ("mesh_loss", &[("mesh", (4e-4, 0.3))]),
    ("backlash", &[("mesh", (2e-5, 2e-2))]),
    ("kinematic_error", &[("mesh", (6e-6, 2e-3))]),
    (
        "stiffness_hardening",
        &[("coupling_3", (0.6, 800.0)), ("coupling_1", (10.0, 3000.0)), ("coupling_2", (10.0, 3000.0))],
    ),
    ("hysteresis", &[("coupling_3", (1e-3, 2.0)), ("coupling_1", (4e-3, 0.4)), ("coupling_2", (4e-3, 0.4))]),
    ("missing_compliance", &[("load_shaft", (40.0, 2e4))]),
    (
        "missing_inertia",
        &[
            ("load", (9e-6, 8e-3)),
            ("disk", (3e-5, 5e-3)),
            ("cam_shaft", (4e-8, 8e-5)),
            ("torque_sensor_in", (3e-7, 1e-4)),
            ("torque_sensor_out", (2e-6, 5e-3)),
        ],
    ),
    ("coupling_slip", &[("coupling_3", (1.0, 7.0)), ("coupling_1", (0.2, 1.3)), ("coupling_2", (0.2, 1.3))]),
    ("gravity_unbalance", &[("load", (5e-4, 1.5))]),
    ("external_disturbance", &[("load", (8e-4, 1.5))]),
    ("torque_ripple", &[("motor", (6e-4, 0.2))]),
    (
        "sensor_gain",
        &[
            ("output_speed", (4e-5, 0.3)),
            ("torque_in", (8e-4, 0.3)),
            ("torque_out", (8e-4, 0.3)),
            ("motor_speed", (2e-4, 0.3)),
        ],
    ),
    (
        "sensor_offset",
        &[
            ("torque_out", (5e-4, 1.0)),
            ("torque_in", (1e-4, 0.2)),
            ("output_speed", (4e-4, 0.5)),
            ("motor_speed", (5e-3, 3.0)),
        ],
    ),
    (
        "sensor_lag",
        &[("output_speed", (4e-5, 2e-2)), ("torque_in", (2e-5, 2e-2)), ("torque_out", (2e-5, 2e-2))],
    ),
    (
        "sensor_delay",
        &[("output_speed", (2e-5, 2e-2)), ("torque_in", (1e-5, 2e-2)), ("torque_out", (1e-5, 2e-2))],
    ),
    (
        "sensor_saturation",
        &[("output_speed", (6.0, 17.0)), ("torque_in", (0.2, 1.5)), ("torque_out", (1.0, 7.0))],
    ),
    (
        "sensor_hum",
        &[
            ("torque_out", (1e-3, 0.3)),
            ("torque_in", (3e-4, 0.06)),
            ("output_speed", (1e-3, 0.3)),
            ("motor_speed", (3e-3, 1.0)),
        ],
    ),
    (
        "sensor_ripple",
        &[
            ("output_speed", (1e-3, 0.3)),
            ("torque_in", (3e-4, 0.06)),
            ("torque_out", (1e-3, 0.3)),
            ("motor_speed", (3e-3, 1.0)),
        ],
    ),
];

/// Kinds that the catalogue does not hold. They are meant to be seen, not to be on the edge of it.
pub(super) const OUTSIDE: [Range; 7] = [
    ("eddy_current_brake", &[("load_bearing", (2e-2, 0.8)), ("cam_bearing", (4e-3, 0.1))]),
    ("late_pad", &[("load_bearing", (2e-2, 0.8)), ("cam_bearing", (4e-3, 0.1))]),
    ("angle_play", &[("mesh", (2e-3, 2e-2))]),
    ("angle_drag", &[("load_bearing", (3e-2, 1.0)), ("cam_bearing", (8e-3, 0.1))]),
    ("loosening", &[("coupling_3", (2e-2, 0.6)), ("coupling_1", (2e-2, 0.6)), ("coupling_2", (2e-2, 0.6))]),
    (
        "gain_drift",
        &[("torque_out", (1e-3, 3e-2)), ("torque_in", (1e-3, 3e-2)), ("output_speed", (3e-4, 3e-2))],
    ),
    ("wearing_in", &[("load_bearing", (3e-2, 0.8)), ("cam_bearing", (8e-3, 0.1))]),
];

/// Every pair of effect and place in turn: effects first, so that each gets as many cases as any other.
pub(super) fn hide_one(ranges: &[Range], turn: u64, draw: &mut Draw) -> Hidden {
    // Five steps on each time, so that a few cases in a row are of all sorts; no list's length is a multiple of five.
    let (effect, places) = ranges[(5 * turn % ranges.len() as u64) as usize];
    let (place, range) = places[(turn / ranges.len() as u64 % places.len() as u64) as usize];
    let size = draw.log(range);
    hide(effect, place, size, draw)
}

/// An effect of a size, all else drawn.
pub(super) fn hide(effect: &str, place: &str, size: f64, draw: &mut Draw) -> Hidden {
    let fast = matches!(place, "cam_bearing" | "motor" | "motor_speed" | "torque_in");
    // Speeds of the fast side are eight times those of the slow one.
    let speed = if fast { 8.0 } else { 1.0 };
    let parameters: Vec<(&str, f64)> = match effect {
        "stribeck_friction" => vec![
            ("torque", size),
            ("static_torque", size * draw.between(1.3, 2.5)),
            ("stribeck_speed", speed * draw.log((0.3, 3.0))),
        ],
        "quadratic_drag" => vec![("coefficient", size)],
        // Never so far down that the damping would turn negative within ten seconds.
        "damping_drift" => vec![("rate", if draw.chance(0.5) { size } else { -size })],
        "direction_dependence" => vec![
            ("torque_difference", size * draw.sign()),
            ("damping_difference", size * draw.between(-1.0, 1.0) / (10.0 * speed)),
        ],
        "constant_load" => vec![("torque", size * draw.sign())],
        "mesh_loss" => vec![("fraction", size)],
        "backlash" => vec![("gap", size)],
        "kinematic_error" => vec![
            ("order", draw.one_of(&[0.125, 0.5, 1.0, 2.0])),
            ("amplitude", size),
            ("phase", draw.phase_rad()),
        ],
        // A spring that softens must not give way altogether.
        "stiffness_hardening" => vec![("cubic", if draw.chance(0.3) { -0.1 * size } else { size })],
        "hysteresis" => vec![("torque", size), ("deflection", draw.log((2e-3, 2e-2)))],
        // Damped so that it gives slowly: a quick one is told from a softer coupling by nothing.
        "missing_compliance" => vec![("stiffness", size), ("damping", size * draw.log((3e-3, 0.3)))],
        "missing_inertia" => vec![("inertia", size)],
        "gravity_unbalance" => vec![("torque", size), ("phase", draw.phase_rad())],
        "external_disturbance" => {
            vec![("torque", size), ("frequency", draw.log((0.5, 60.0))), ("phase", draw.phase_rad())]
        }
        "torque_ripple" => vec![
            ("order", draw.one_of(&[1.0, 2.0, 6.0, 12.0])),
            ("torque", size),
            ("phase", draw.phase_rad()),
        ],
        "sensor_gain" => vec![("gain", 1.0 + size * draw.sign())],
        "sensor_offset" => vec![("offset", size * draw.sign())],
        "sensor_lag" => vec![("time_constant", size)],
        "sensor_delay" => vec![("delay", size)],
        "sensor_saturation" => vec![("limit", size)],
        "sensor_hum" => vec![
            ("amplitude", size),
            ("frequency", draw.one_of(&[50.0, 60.0, 100.0, 150.0])),
            ("phase", draw.phase_rad()),
        ],
        "sensor_ripple" => {
            vec![("amplitude", size), ("order", draw.one_of(&[1.0, 2.0, 4.0])), ("phase", draw.phase_rad())]
        }
        "eddy_current_brake" => vec![("torque", size), ("speed", speed * draw.between(2.0, 6.0))],
        "late_pad" => vec![("torque", size), ("time", draw.between(3.0, 7.0))],
        "angle_play" => vec![("gap", size), ("phase", draw.phase_rad())],
        "angle_drag" => vec![("torque", size), ("phase", draw.phase_rad())],
        "loosening" => vec![("share", size), ("time", draw.between(3.0, 7.0))],
        "gain_drift" => vec![("rate", size * draw.sign())],
        "wearing_in" => vec![("torque", size), ("angle", speed * draw.log((10.0, 60.0)))],
        // Coulomb friction and slip.
        _ => vec![("torque", size)],
    };
    Hidden {
        effect: effect.into(),
        place: place.into(),
        parameters: parameters.into_iter().map(|(name, value)| (name.into(), value)).collect(),
    }
}
