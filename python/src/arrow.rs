//! Recordings as Arrow streams that share the memory of the recording.

use std::sync::Arc;

use arrow_array::{Float64Array, RecordBatch, RecordBatchIterator, ffi_stream::FFI_ArrowArrayStream};
use arrow_buffer::{Buffer, NullBuffer, ScalarBuffer};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use bytes::Bytes;
use socam_recording::{Channel, Shared};

/// Values of one column, as bytes that Arrow can keep a reference to.
struct Owner {
    samples: Shared,
    /// Index of the channel; `None` for the times.
    channel: Option<usize>,
}

impl AsRef<[u8]> for Owner {
    fn as_ref(&self) -> &[u8] {
        bytemuck::cast_slice(values(&self.samples, self.channel))
    }
}

/// Values of a channel, or the times.
pub(crate) fn values(samples: &Shared, channel: Option<usize>) -> &[f64] {
    channel.map_or(samples.time_s(), |channel| samples.values(channel).unwrap_or_default())
}

/// The recording's columns, `t_s` first. A missing value is a null, and NaN in the buffer below it.
pub(crate) fn stream(channels: &[Channel], samples: &Shared) -> Result<FFI_ArrowArrayStream, ArrowError> {
    let names = std::iter::once("t_s".to_owned()).chain(channels.iter().map(Channel::column_name));
    let indices = std::iter::once(None).chain((0..channels.len()).map(Some));
    let column = |channel| {
        let values = values(samples, channel);
        let known = || values.iter().map(|value| !value.is_nan());
        let nulls = known().any(|known| !known).then(|| NullBuffer::from(known().collect::<Vec<_>>()));
        let owner = Owner { samples: samples.clone(), channel };
        let buffer = ScalarBuffer::from(Buffer::from(Bytes::from_owner(owner)));
        Float64Array::new(buffer, nulls)
    };
    let arrays: Vec<Float64Array> = indices.map(column).collect();
    let fields = names.map(|name| {
        let is_channel = name != "t_s";
        Field::new(name, DataType::Float64, is_channel)
    });
    let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
    let columns = arrays.into_iter().map(|array| Arc::new(array) as _).collect();
    let batch = RecordBatch::try_new(schema.clone(), columns)?;
    Ok(FFI_ArrowArrayStream::new(Box::new(RecordBatchIterator::new([Ok(batch)], schema))))
}
