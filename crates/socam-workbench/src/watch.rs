//! The state of a watch, as the frame of the window and its title tell it in every view.

/// Weight of a state: how it is coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// Nothing can be said: learning, or nothing was judged.
    #[default]
    Quiet,
    /// Judged, and as usual.
    Good,
    /// An alarm.
    Alarm,
}

/// The state of a watch in a few words.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WatchState {
    /// The words, such as `not judged` or `2 alarms`.
    pub text: String,
    /// Weight.
    pub tone: Tone,
}
