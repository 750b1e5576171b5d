//! A device that is not the own board, ready to be recorded.

use socam_sources::Timeline;

use crate::device::source::Listened;

/// A device that is ready to be recorded.
pub(super) struct Opened {
    pub(super) device: Box<dyn socam_sources::Device>,
    pub(super) timeline: Timeline,
    pub(super) heard: Listened,
    /// Text of its description, if it has one.
    pub(super) description: Option<String>,
}

impl Opened {
    /// A device that is asked and was not listened to.
    pub(super) fn asked(device: Box<dyn socam_sources::Device>) -> Self {
        let timeline = Timeline::new(device.numbering(), None);
        Self { device, timeline, heard: Listened(Vec::new()), description: None }
    }
}
