//! Definitions of common types of ROS 2 (common_interfaces), for bags of releases that did not write them.

use crate::formats::messages::Schema;

/// Types of messages and their fields.
const TYPES: [(&str, &str); 17] = [
    (
        "sensor_msgs/msg/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    ),
    (
        "sensor_msgs/msg/Imu",
        "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
         geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
         geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
    ),
    ("geometry_msgs/msg/Vector3", VECTOR3),
    ("geometry_msgs/msg/Wrench", WRENCH),
    ("geometry_msgs/msg/WrenchStamped", "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n"),
    ("geometry_msgs/msg/Twist", TWIST),
    ("geometry_msgs/msg/TwistStamped", "std_msgs/Header header\ngeometry_msgs/Twist twist\n"),
    ("std_msgs/msg/Float64", "float64 data\n"),
    ("std_msgs/msg/Float32", "float32 data\n"),
    ("std_msgs/msg/Int64", "int64 data\n"),
    ("std_msgs/msg/Int32", "int32 data\n"),
    ("std_msgs/msg/Int16", "int16 data\n"),
    ("std_msgs/msg/UInt32", "uint32 data\n"),
    ("std_msgs/msg/UInt16", "uint16 data\n"),
    ("std_msgs/msg/Bool", "bool data\n"),
    ("std_msgs/msg/Float64MultiArray", "std_msgs/MultiArrayLayout layout\nfloat64[] data\n"),
    ("std_msgs/msg/Float32MultiArray", "std_msgs/MultiArrayLayout layout\nfloat32[] data\n"),
];

const VECTOR3: &str = "float64 x\nfloat64 y\nfloat64 z\n";
const WRENCH: &str = "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n";
const TWIST: &str = "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n";

/// Types that those name.
const PARTS: [(&str, &str); 8] = [
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    ("geometry_msgs/Vector3", VECTOR3),
    ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"),
    ("geometry_msgs/Wrench", WRENCH),
    ("geometry_msgs/Twist", TWIST),
    ("std_msgs/MultiArrayLayout", "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n"),
    ("std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n"),
];

/// The definition of a type as bags hold it; `None` for types that are not known here.
pub(super) fn definition(kind: &str) -> Option<Schema> {
    let (_, fields) = TYPES.iter().find(|(name, _)| *name == kind)?;
    let mut text = (*fields).to_owned();
    for (name, fields) in PARTS {
        text.push_str(&format!("{}\nMSG: {name}\n{fields}", "=".repeat(80)));
    }
    Some(Schema { name: kind.to_owned(), encoding: "ros2msg".into(), data: text.into_bytes() })
}

#[cfg(test)]
mod tests {
    use super::{TYPES, definition};
    use crate::formats::messages::Decoder;

    #[test]
    fn every_definition_is_complete() {
        for (name, _) in TYPES {
            let schema = definition(name).unwrap();
            let decoder = Decoder::of("cdr", Some(&schema));
            assert!(decoder.is_ok(), "{name}: {:?}", decoder.err());
        }
        assert!(definition("my_msgs/msg/State").is_none());
    }
}
