//! Descriptions of objects in a segment.

use super::Problem;
use super::fields::{Fields, Property};
use super::raw::Storage;

/// The first 28 bytes of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeadIn {
    contents: u32,
    pub(super) next_offset: u64,
    pub(super) raw_offset: u64,
}

impl LeadIn {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Problem> {
        let mut fields = Fields { bytes, at: 4, is_big_endian: false };
        if !bytes.starts_with(b"TDSm") {
            return Err("a segment does not begin with TDSm".into());
        }
        let contents = fields.u32()?;
        fields.is_big_endian = contents & 0x40 != 0;
        let _version = fields.u32()?;
        Ok(Self { contents, next_offset: fields.u64()?, raw_offset: fields.u64()? })
    }

    pub(super) fn has_description(self) -> bool {
        self.contents & 0x02 != 0
    }
    pub(super) fn is_new_list(self) -> bool {
        self.contents & 0x04 != 0
    }
    pub(super) fn has_data(self) -> bool {
        self.contents & 0x08 != 0
    }
    pub(super) fn is_interleaved(self) -> bool {
        self.contents & 0x20 != 0
    }
    pub(super) fn is_big_endian(self) -> bool {
        self.contents & 0x40 != 0
    }
    pub(super) fn is_daqmx(self) -> bool {
        self.contents & 0x80 != 0
    }
}

/// Description of an object's data in a segment.
pub(super) enum Index {
    None,
    Same,
    New(Storage),
}

pub(super) struct Object {
    pub(super) path: String,
    pub(super) storage: Index,
    pub(super) properties: Vec<(String, Property)>,
}

/// Group and channel of a path such as `/'Group'/'Channel'`; `None` for other objects.
pub(super) fn path_parts(path: &str) -> Option<(String, String)> {
    let inner = path.strip_prefix("/'")?.strip_suffix('\'')?;
    let (group, channel) = inner.split_once("'/'")?;
    let plain = |part: &str| part.replace("''", "'");
    Some((plain(group), plain(channel)))
}

pub(super) fn objects(bytes: &[u8], is_big_endian: bool) -> Result<Vec<Object>, Problem> {
    let mut fields = Fields { bytes, at: 0, is_big_endian };
    let count = fields.count()?;
    (0..count).map(|_| object(&mut fields)).collect()
}

fn object(fields: &mut Fields<'_>) -> Result<Object, Problem> {
    let path = fields.text()?;
    let storage = match fields.u32()? {
        u32::MAX => Index::None,
        0 => Index::Same,
        // Unscaled values of a DAQ device, in two variants.
        0x1269 | 0x1369 | 0x6912_0000 | 0x6913_0000 => {
            return Err("it holds unscaled DAQmx data; save it as scaled values with NI's software".into());
        }
        _ => Index::New(Storage::parse(fields)?),
    };
    let count = fields.count()?;
    let properties =
        (0..count).map(|_| Ok((fields.text()?, fields.property()?))).collect::<Result<_, Problem>>()?;
    Ok(Object { path, storage, properties })
}
