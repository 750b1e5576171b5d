//! Attachments of a log: files that travel with a recording.

use std::path::Path;

use mcap::records::{Record, op};

use super::records::{Next, Records};
use crate::error::Result;

/// A file that travels with a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Name of the attachment, such as `model.toml`.
    pub name: String,
    /// Media type, such as `application/toml`.
    pub media_type: String,
    /// Content of the attachment.
    pub data: Vec<u8>,
}

/// Attachments of a log, with their content, in the file's order.
///
/// ```
/// use socam_recording::{Attachment, Channel, Recorder, RecordingHeader, SampleRow, Unit, read_attachments};
///
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("run.mcap");
/// let mut header = RecordingHeader::new(vec![Channel::new("torque", Unit::Nm)]);
/// let model = Attachment { name: "model.toml".into(), media_type: "application/toml".into(), data: b"x = 1".to_vec() };
/// header.attachments.push(model.clone());
/// let mut recorder = Recorder::create(&path, &header)?;
/// recorder.push_samples(&[SampleRow { device_time_ns: 0, sequence: 0, flags: 0, raw_counts: &[], values: &[1.0] }]);
/// recorder.finish()?;
/// assert_eq!(read_attachments(&path)?, [model]);
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
///
/// # Errors
/// When the file cannot be read or is no MCAP log. Attachments after a cut are not there.
pub fn read_attachments(path: &Path) -> Result<Vec<Attachment>> {
    let mut records = Records::open(path)?;
    let mut attachments = Vec::new();
    loop {
        let (opcode, body) = match records.next(|opcode| opcode == op::ATTACHMENT)? {
            Next::Record { opcode, body, .. } => (opcode, body),
            Next::Damaged(..) => continue,
            Next::End | Next::Cut(_) => break,
        };
        if opcode == op::ATTACHMENT
            && let Some(Record::Attachment { header, data, .. }) = super::parse::record(opcode, body)
        {
            attachments.push(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            });
        }
    }
    Ok(attachments)
}
