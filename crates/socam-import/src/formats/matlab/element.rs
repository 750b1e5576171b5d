//! Elements of a `.mat` file: a type, a length and content.

/// Why an element cannot be read.
pub(super) type Problem = String;

/// Elements that follow one another.
pub(super) struct Elements<'b> {
    bytes: &'b [u8],
    is_big_endian: bool,
}

impl<'b> Elements<'b> {
    pub(super) fn new(bytes: &'b [u8], is_big_endian: bool) -> Self {
        Self { bytes, is_big_endian }
    }

    /// Type and content of the next element; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<(u32, &'b [u8])>, Problem> {
        let Some((head, rest)) = self.bytes.split_first_chunk::<8>() else {
            return if self.bytes.iter().all(|byte| *byte == 0) {
                Ok(None)
            } else {
                Err("it ends within an element".into())
            };
        };
        let word = |at: usize| {
            let mut word = [head[at], head[at + 1], head[at + 2], head[at + 3]];
            if self.is_big_endian {
                word.reverse();
            }
            u32::from_le_bytes(word)
        };
        let (first, second) = (word(0), word(4));
        // An element of up to four bytes has its length beside its type, and its content where the length would be.
        if first >> 16 != 0 {
            let length = (first >> 16) as usize;
            let content = self.bytes.get(4..4 + length).filter(|_| length <= 4);
            let content = content.ok_or("a short element is longer than four bytes")?;
            self.bytes = rest;
            return Ok(Some((first & 0xffff, content)));
        }
        let length = second as usize;
        let content = rest
            .get(..length)
            .ok_or_else(|| format!("{length} bytes are needed where {} are left", rest.len()))?;
        // All but compressed elements end at a multiple of eight bytes.
        let padded = if first == super::COMPRESSED { length } else { length.next_multiple_of(8) };
        self.bytes = rest.get(padded..).unwrap_or_default();
        Ok(Some((first, content)))
    }

    /// The next element as text.
    pub(super) fn text(&mut self) -> Result<Option<String>, Problem> {
        Ok(self.next()?.map(|(_, content)| String::from_utf8_lossy(content).into_owned()))
    }

    /// The next element as integers.
    pub(super) fn integers(&mut self) -> Result<Option<Vec<i64>>, Problem> {
        let Some((kind, content)) = self.next()? else { return Ok(None) };
        let values = decode(kind, content, self.is_big_endian)?;
        Ok(Some(values.into_iter().map(|value| value as i64).collect()))
    }

    /// The next element as numbers; numbers may be stored in fewer bytes than their class has.
    pub(super) fn numbers(&mut self) -> Result<Vec<f64>, Problem> {
        let Some((kind, content)) = self.next()? else { return Ok(Vec::new()) };
        decode(kind, content, self.is_big_endian)
    }
}

fn decode(kind: u32, content: &[u8], is_big_endian: bool) -> Result<Vec<f64>, Problem> {
    fn each<const N: usize>(content: &[u8], is_big_endian: bool, value: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        let ordered = |bytes: &[u8; N]| {
            let mut bytes = *bytes;
            if is_big_endian {
                bytes.reverse();
            }
            value(bytes)
        };
        content.as_chunks::<N>().0.iter().map(ordered).collect()
    }
    let b = is_big_endian;
    Ok(match kind {
        1 => each(content, b, |bytes| i8::from_le_bytes(bytes).into()),
        2 => each(content, b, |bytes| u8::from_le_bytes(bytes).into()),
        3 => each(content, b, |bytes| i16::from_le_bytes(bytes).into()),
        4 => each(content, b, |bytes| u16::from_le_bytes(bytes).into()),
        5 => each(content, b, |bytes| i32::from_le_bytes(bytes).into()),
        6 => each(content, b, |bytes| u32::from_le_bytes(bytes).into()),
        7 => each(content, b, |bytes| f32::from_le_bytes(bytes).into()),
        9 => each(content, b, f64::from_le_bytes),
        12 => each(content, b, |bytes| i64::from_le_bytes(bytes) as f64),
        13 => each(content, b, |bytes| u64::from_le_bytes(bytes) as f64),
        other => return Err(format!("numbers are stored in a type {other}, which is not known")),
    })
}
