//! Protobuf schemas of a log, as descriptor sets that any reader understands without a plug-in.
//!
//! Every scalar field tracks its presence (proto3 `optional`): a missing value is an absent field, and 0 is a value.

use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet, OneofDescriptorProto,
};

use crate::Channel;

pub(crate) const SAMPLE: &str = "socam.Sample";
pub(crate) const STATUS: &str = "socam.Status";
pub(crate) const EVENT: &str = "socam.Event";

/// Field numbers of `socam.Sample`; channels follow from [`FIRST_CHANNEL`].
pub(crate) const DEVICE_TIME_NS: u32 = 1;
pub(crate) const SEQUENCE: u32 = 2;
pub(crate) const FLAGS: u32 = 3;
pub(crate) const RAW_COUNTS: u32 = 4;
pub(crate) const EXACT_TIME_S: u32 = 5;
pub(crate) const FIRST_CHANNEL: u32 = 16;

/// The descriptor set of `socam.Sample` for these channels.
pub(crate) fn sample(channels: &[Channel]) -> Vec<u8> {
    let mut message = Builder::new("Sample");
    message.optional("device_time_ns", DEVICE_TIME_NS, Type::Int64);
    message.optional("sequence", SEQUENCE, Type::Uint64);
    message.optional("flags", FLAGS, Type::Uint32);
    message.repeated("raw_counts", RAW_COUNTS, Type::Sint32);
    message.optional("t_s", EXACT_TIME_S, Type::Double);
    for (name, number) in field_names(channels).iter().zip(FIRST_CHANNEL..) {
        message.optional(name, number, Type::Double);
    }
    message.descriptor_set()
}

/// The descriptor set of `socam.Status`.
pub(crate) fn status() -> Vec<u8> {
    let mut message = Builder::new("Status");
    message.optional("device_time_ns", 1, Type::Int64);
    message.optional("state", 2, Type::String);
    message.optional("overruns", 3, Type::Uint64);
    message.optional("lost", 4, Type::Uint64);
    message.optional("link_errors", 5, Type::Uint64);
    message.descriptor_set()
}

/// The descriptor set of `socam.Event`.
pub(crate) fn event() -> Vec<u8> {
    let mut message = Builder::new("Event");
    message.optional("device_time_ns", 1, Type::Int64);
    message.optional("kind", 2, Type::String);
    message.optional("text", 3, Type::String);
    message.descriptor_set()
}

/// Field names of the channels: their columns' names, made into identifiers and made unique.
pub(crate) fn field_names(channels: &[Channel]) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(channels.len());
    for channel in channels {
        let column = channel.column_name();
        let mut name: String =
            column.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            name.insert_str(0, "x_");
        }
        let plain = name.clone();
        let mut copy = 2;
        while names.contains(&name) {
            name = format!("x{copy}_{plain}");
            copy += 1;
        }
        names.push(name);
    }
    names
}

/// Fields of doubles in the message of this name (`package.Message`), with their numbers: a reader takes them as
/// channels. `None` when the data are no descriptor set with such a message.
pub(crate) fn double_fields(descriptor_set: &[u8], name: &str) -> Option<Vec<(u32, String)>> {
    let set = FileDescriptorSet::decode(descriptor_set).ok()?;
    let (package, short) = name.rsplit_once('.').unwrap_or(("", name));
    let message = set
        .file
        .iter()
        .filter(|file| file.package() == package)
        .flat_map(|file| &file.message_type)
        .find(|message| message.name() == short)?;
    let doubles = message
        .field
        .iter()
        .filter(|field| field.r#type() == Type::Double && field.label() != Label::Repeated)
        .filter_map(|field| Some((u32::try_from(field.number()).ok()?, field.name().to_owned())))
        .collect();
    Some(doubles)
}

struct Builder(DescriptorProto);

impl Builder {
    fn new(name: &str) -> Self {
        Self(DescriptorProto { name: Some(name.into()), ..DescriptorProto::default() })
    }

    fn optional(&mut self, name: &str, number: u32, of: Type) {
        let oneof_index = Some(self.0.oneof_decl.len() as i32);
        self.0.oneof_decl.push(OneofDescriptorProto { name: Some(format!("_{name}")), options: None });
        self.0.field.push(FieldDescriptorProto {
            oneof_index,
            proto3_optional: Some(true),
            ..field(name, number, of, Label::Optional)
        });
    }

    fn repeated(&mut self, name: &str, number: u32, of: Type) {
        self.0.field.push(field(name, number, of, Label::Repeated));
    }

    fn descriptor_set(self) -> Vec<u8> {
        let file = FileDescriptorProto {
            name: Some(format!("socam/{}.proto", self.0.name().to_lowercase())),
            package: Some("socam".into()),
            message_type: vec![self.0],
            syntax: Some("proto3".into()),
            ..FileDescriptorProto::default()
        };
        FileDescriptorSet { file: vec![file] }.encode_to_vec()
    }
}

fn field(name: &str, number: u32, of: Type, label: Label) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.into()),
        number: Some(number as i32),
        label: Some(label as i32),
        r#type: Some(of as i32),
        json_name: Some(name.into()),
        ..FieldDescriptorProto::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unit;

    #[test]
    fn odd_names_become_distinct_identifiers() {
        let channels = ["a b", "a_b", "1", "\u{e9}"].map(|name| Channel::new(name, Unit::V));
        assert_eq!(field_names(&channels), ["a_b_V", "x2_a_b_V", "x_1_V", "x___V"]);
        let fields = double_fields(&sample(&channels), SAMPLE).unwrap();
        assert_eq!(fields[0], (5, "t_s".into()));
        assert_eq!(fields[1], (16, "a_b_V".into()));
    }
}
