//! Plots of every kind.

use socam_workbench::arrangement::{Arrangement, Node, Part, Plot};
use socam_workbench::derivation::{Derivation, Operation};
use socam_workbench::signal::Signal;

fn signal(name: &str, unit: &str) -> Signal {
    Signal { name: name.into(), unit: unit.into() }
}

pub(super) fn power() -> Derivation {
    let second = Some("motor_speed".into());
    Derivation { operation: Operation::Product, of: "torque_in".into(), second, ..Derivation::default() }
}

/// Plots of every kind.
pub(super) fn tiles() -> Arrangement {
    let [motor, output] = ["motor_speed", "output_speed"].map(|name| signal(name, "rad/s"));
    let [torque_in, torque_out] = ["torque_in", "torque_out"].map(|name| signal(name, "N m"));
    let part = |share, of| Part { share, of };
    let plot = |plot| part(1.0, Node::Plot(plot));
    let xy = Plot::Xy { y: torque_out.clone(), x: output.clone() };
    let pictures = Node::Column(vec![plot(xy), plot(Plot::Spectrogram(motor.clone()))]);
    let over_time = vec![
        plot(Plot::Time(vec![motor, output])),
        plot(Plot::Time(vec![torque_in, torque_out])),
        plot(Plot::Time(vec![signal("torque_in.times.motor_speed", "W")])),
        plot(Plot::Statistics),
    ];
    Arrangement {
        plots: Some(Node::Row(vec![part(3.0, Node::Column(over_time)), part(2.0, pictures)])),
        hidden: [signal("command", "V")].into(),
        derived: vec![power()],
        ..Arrangement::default()
    }
}

/// What an analyst looks at: a formula, speeds in revolutions per minute, a histogram, a table of values.
pub(super) fn bench() -> Arrangement {
    let [motor, output] = ["motor_speed", "output_speed"].map(|name| signal(name, "rad/s"));
    let torque_out = signal("torque_out", "N m");
    let part = |share, of| Part { share, of };
    let plot = |plot| part(1.0, Node::Plot(plot));
    let power_out = Derivation {
        operation: Operation::Formula,
        of: "power_out".into(),
        formula: Some("torque_out * output_speed".into()),
        ..Derivation::default()
    };
    let over_time = vec![
        plot(Plot::Time(vec![motor])),
        plot(Plot::Time(vec![output.clone(), torque_out.clone()])),
        plot(Plot::Time(vec![signal("power_out", "W")])),
    ];
    let beside = Node::Column(vec![plot(Plot::Histogram(torque_out)), plot(Plot::Table)]);
    let mut arrangement = Arrangement {
        plots: Some(Node::Row(vec![part(3.0, Node::Column(over_time)), part(2.0, beside)])),
        hidden: [signal("command", "V"), signal("torque_in", "N m")].into(),
        derived: vec![power_out],
        ..Arrangement::default()
    };
    arrangement.units.choose_for_all("rad/s", "rpm");
    arrangement
}
