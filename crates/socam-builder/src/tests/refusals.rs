//! Descriptions that give no model, each with its message.

use super::described;

#[test]
fn what_is_not_understood_is_refused_in_one_sentence() {
    let axis = "motor | coupling jaw | load";
    let torque = "torque@motor";
    let cases: &[(&str, &str, &str, &str)] = &[
        (
            "motr | load",
            torque,
            "speed@load",
            "`motr`: a part begins with one of motor, coupling, spring, shaft, sensor, torquemeter, torque_sensor, gear, gearbox, reducer, belt, screw, ballscrew, rack, slide, carriage, table, load, link, arm, inertia, flange, flywheel, pulley, brake",
        ),
        (
            "motor | gear 5",
            torque,
            "speed@motor",
            "the chain \"motor | gear 5\" must begin with what is driven (motor 0.9kgcm2) and end with what moves (load 0.02kgm2 or slide 12kg)",
        ),
        (
            "motor | gear | load",
            torque,
            "speed@load",
            "`gear`: its ratio is missing; write gear 5, gear 5:1, gear 20:100 teeth or gear 50 8kNm/rad 0.1kgcm2",
        ),
        (
            "motor | shaft 20mm | load",
            torque,
            "speed@load",
            "`shaft 20mm`: a shaft needs diameter and length, such as shaft 20x300mm steel",
        ),
        (
            "motor 3furlong | load",
            torque,
            "speed@load",
            "`motor 3furlong`: \"furlong\" is no unit; write one such as kgcm2, Nm/rad, mm, kg or ohm",
        ),
        (
            "motor 3kg | load",
            torque,
            "speed@load",
            "`motor 3kg`: \"3kg\" is not understood; write motor 0.9kgcm2, and for a drive by current or voltage 0.055Nm/A 1.2ohm 0.5mH",
        ),
        (
            "motor | load disc 4kg",
            torque,
            "speed@load",
            "`load disc 4kg`: a mass needs a size: disc 4kg 200mm (diameter), rod 2kg 500mm (length) or 2kg 300mm (radius)",
        ),
        (
            "motor | slide 3kg",
            torque,
            "speed@slide",
            "`slide`: a slide behind a motor needs a screw or a rack between them, such as screw 5mm or rack 120mm",
        ),
        (
            axis,
            "power@motor",
            "speed@load",
            "`power@motor`: \"power\" drives nothing; write torque, force, current, voltage, speed or position",
        ),
        (
            axis,
            "torque@rotor",
            "speed@load",
            "`torque@rotor`: a torque is that of one of the bodies motor, load",
        ),
        (
            axis,
            "current@motor:i_A",
            "speed@load",
            "`current@motor:i_A`: how many N m is one A? write the torque constant at the motor (motor 0.055Nm/A) or behind the column (*0.055)",
        ),
        (axis, torque, "torque@load", "`torque@load`: a torque is measured in an elastic part: coupling"),
        (axis, torque, "speed", "`speed`: write QUANTITY@PART:COLUMN, such as speed@motor:motor_speed_rad_s"),
        (
            axis,
            torque,
            "speed@load:tacho_1 rpn",
            "`speed@load:tacho_1 rpn`: \"rpn\" is no unit; write one such as rpm, deg or mm",
        ),
        (
            axis,
            torque,
            "current@motor",
            "`current@motor`: a current is predicted only of a motor that a voltage drives; as the drive write current@motor:COLUMN",
        ),
    ];
    for (chain, drive, measure, expected) in cases {
        assert_eq!(described(chain, &[drive], &[measure], None).unwrap_err(), *expected);
    }
    let missing = described(axis, &[], &[], None).unwrap_err();
    let expected =
        "what drives it is missing: say it as in torque@motor:COLUMN, or as none where it swings freely";
    assert_eq!(missing, expected);
    assert!(described(axis, &["none"], &["speed@load"], None).is_ok());
}
