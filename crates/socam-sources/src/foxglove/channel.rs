//! A channel that a server advertises.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::Value as Json;
use socam_import::LiveMessages;

/// A channel that the server has.
#[derive(Debug)]
pub(super) struct Channel {
    pub(super) topic: String,
    pub(super) encoding: String,
    pub(super) schema_name: String,
    schema_encoding: String,
    schema: String,
}

impl Channel {
    /// A channel of an advertisement, with its number.
    pub(super) fn read(json: &Json) -> Option<(u64, Self)> {
        let text = |key: &str| json[key].as_str().unwrap_or_default().to_owned();
        let channel = Self {
            topic: text("topic"),
            encoding: text("encoding"),
            schema_name: text("schemaName"),
            schema_encoding: text("schemaEncoding"),
            schema: text("schema"),
        };
        Some((json["id"].as_u64()?, channel))
    }

    /// What decodes its messages, or why nothing does.
    pub(super) fn decoder(&self) -> std::result::Result<LiveMessages, String> {
        // Servers that state no language use that which goes with the encoding.
        let language = match (self.schema_encoding.as_str(), self.encoding.as_str()) {
            ("", "cdr") => "ros2msg",
            ("", encoding) => encoding,
            (language, _) => language,
        };
        let schema = match language {
            "protobuf" | "flatbuffer" => BASE64_STANDARD
                .decode(&self.schema)
                .map_err(|_| format!("its schema `{}` is no base64", self.schema_name))?,
            _ => self.schema.clone().into_bytes(),
        };
        LiveMessages::new(&self.encoding, &self.schema_name, language, schema)
    }
}
