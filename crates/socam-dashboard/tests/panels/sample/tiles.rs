//! Plots of every kind.

use socam_workbench::arrangement::{Arrangement, Node, Part, Plot};
use socam_workbench::derivation::{Derivation, Operation};
use socam_workbench::signal::Signal;

fn signal(name: &str, unit: &str) -> Signal {
    Signal { name: name.into(), unit: unit.into() }
}

pub(super) fn power() -> Derivation {
    let second = Some("motor_speed".into());
    Derivation { operation: Operation::Product, of: "torque_in".into(), second, value: None }
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
