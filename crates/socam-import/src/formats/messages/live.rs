//! Messages of a topic while it is published, one by one.

use super::flatten::Number;
use super::{Decoder, Schema, convention};
use crate::formats::fence::fenced;

/// A number in a message.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MessageNumber {
    /// A number, or a truth value as 0 or 1.
    Value(f64),
    /// A time that the message states, ns since 1970 or any other beginning.
    Time(i64),
}

/// What decodes the messages of a topic.
pub struct LiveMessages {
    decoder: Decoder,
    /// Type of the messages, without its package.
    kind: String,
}

impl LiveMessages {
    /// The decoder of messages in an encoding (`json`, `cdr`, `protobuf`), whose type is defined by a schema in a language (`ros2msg`,
    /// `ros2idl`, `protobuf`).
    ///
    /// # Errors
    /// Why messages cannot be decoded, in words.
    pub fn new(encoding: &str, name: &str, language: &str, schema: Vec<u8>) -> Result<Self, String> {
        let schema = Schema { name: name.into(), encoding: language.into(), data: schema };
        let kind = schema.kind().to_owned();
        let decoder = fenced(|| Decoder::of(encoding, Some(&schema)));
        let decoder = decoder.unwrap_or_else(|| Err(format!("its schema `{name}` cannot be read")))?;
        Ok(Self { decoder, kind })
    }

    /// Paths and numbers of a message, as those of recorded topics are named; `None` if it cannot be decoded.
    #[must_use]
    pub fn numbers(&self, data: &[u8]) -> Option<Vec<(String, MessageNumber)>> {
        let numbers = fenced(|| self.decoder.numbers(data)).flatten()?;
        let number = |number| match number {
            Number::Float(value) => MessageNumber::Value(value),
            Number::Integer(value) => MessageNumber::Value(value as f64),
            Number::Time(time) => MessageNumber::Time(time),
        };
        Some(numbers.0.into_iter().map(|(path, one)| (path, number(one))).collect())
    }

    /// The unit that the convention of ROS gives to a number, by its path.
    #[must_use]
    pub fn convention(&self, path: &str) -> Option<&'static str> {
        // The hint names the unit first, then that of another kind of joint.
        convention(&self.kind, path)?.split('"').nth(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_of_ros_is_decoded_and_damaged_ones_are_not() {
        let schema = b"float64[] velocity\nbool on\n".to_vec();
        let messages = LiveMessages::new("cdr", "sensor_msgs/msg/JointState", "ros2msg", schema).unwrap();
        let mut data = vec![0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0];
        data.extend(1.5_f64.to_le_bytes());
        data.push(1);
        let numbers = messages.numbers(&data).unwrap();
        let expected =
            [("velocity.0".into(), MessageNumber::Value(1.5)), ("on".into(), MessageNumber::Value(1.0))];
        assert_eq!(numbers, expected);
        assert_eq!(messages.convention("velocity.0"), Some("rad/s"));
        assert_eq!(messages.numbers(&data[..15]), None);
        assert!(LiveMessages::new("flatbuffer", "x", "flatbuffer", Vec::new()).is_err());
    }
}
