//! A device that is not the own board, ready to be recorded.

use socam_sources::Timeline;

use crate::device::source::Listened;

/// A device that is ready to be recorded.
pub(crate) struct Opened {
    pub(crate) device: Box<dyn socam_sources::Device>,
    pub(crate) timeline: Timeline,
    pub(crate) heard: Listened,
    /// Text of its description, if it has one.
    pub(crate) description: Option<String>,
}

impl Opened {
    /// A device that is asked and was not listened to.
    pub(crate) fn asked(device: Box<dyn socam_sources::Device>) -> Self {
        let timeline = Timeline::new(device.numbering(), None);
        Self { device, timeline, heard: Listened(Vec::new()), description: None }
    }
}
