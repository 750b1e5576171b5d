//! Channels that the simulation adds to a model.

use socam_model::{Channel, ChannelTransform, Quantity, Role};

/// A channel that is read as recorded: SI, without gain, offset or noise.
pub(crate) fn plain_channel(
    role: Role,
    quantity: Quantity,
    name: String,
    column: String,
    at: String,
) -> Channel {
    Channel {
        name,
        column,
        role,
        quantity,
        at,
        transform: ChannelTransform::Value,
        scale: 1.0,
        offset: 0.0,
        noise_std: None,
        gain: None,
        estimate_offset: false,
        between: None,
        unit: "",
    }
}
