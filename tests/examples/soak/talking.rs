//! Rows of devices that send by themselves.

use socam_sources::simulators::SlcanSimulator;

/// Makes the rows of a source.
pub(crate) struct Rows {
    name: String,
    adapter: SlcanSimulator,
}

impl Rows {
    pub(crate) fn new(name: &str) -> Self {
        Self { name: name.to_owned(), adapter: SlcanSimulator::new(true) }
    }

    /// Whether rows would leave: the channel of an adapter of CAN has to be opened first.
    pub(crate) fn are_wanted(&self) -> bool {
        self.name != "slcan" || !self.adapter.frame(0.0, 0, &[]).is_empty()
    }

    /// What a recorder that connects is sent first.
    pub(crate) fn greeting(&self) -> Vec<Vec<u8>> {
        vec![b"t_us,n,k_V\n".to_vec()]
    }

    /// The answer to bytes of the recorder, which only an adapter of CAN understands.
    pub(crate) fn answer(&mut self, bytes: &[u8]) -> Option<Vec<u8>> {
        if self.name != "slcan" || bytes.is_empty() {
            return None;
        }
        Some(self.adapter.receive(bytes)).filter(|answer| !answer.is_empty())
    }

    /// A row at a time since the device was switched on, with its number since then, and the number that goes on when it is switched on again.
    pub(crate) fn row(&self, time_us: u64, number: u64, k: u64) -> Option<Vec<u8>> {
        Some(match self.name.as_str() {
            "text" => format!("t_us:{time_us},n:{number},k_V:{k}\n").into_bytes(),
            "tcp" => format!("{time_us},{number},{k}\n").into_bytes(),
            "udp" | "server" => format!("{{\"t_us\":{time_us},\"n\":{number},\"k_V\":{k}}}").into_bytes(),
            "cobs" => frame(time_us as u32, number as u32, k as f64),
            _ => {
                // A microsecond more, so that rounding down gives the millisecond.
                let time_s = (time_us + 1) as f64 * 1e-6;
                let mut frames = self.adapter.frame(time_s, 257, &(k as i32).to_le_bytes());
                if k.is_multiple_of(4) {
                    frames.extend(self.adapter.frame(time_s, 258, &25_i16.to_le_bytes()));
                }
                return Some(frames).filter(|frames| !frames.is_empty());
            }
        })
    }
}

/// A frame by COBS, with a zero behind it.
fn frame(time_us: u32, number: u32, k: f64) -> Vec<u8> {
    let mut plain = [&time_us.to_le_bytes()[..], &number.to_le_bytes(), &k.to_le_bytes()].concat();
    let sum = plain.iter().fold(0xffff_u16, |sum, byte| {
        (0..8)
            .fold(sum ^ u16::from(*byte) << 8, |sum, _| sum << 1 ^ if sum & 0x8000 == 0 { 0 } else { 0x1021 })
    });
    plain.extend(sum.to_le_bytes());
    // Shorter than 254 bytes: each part between zeros gets its length in front.
    let mut coded = Vec::new();
    for part in plain.split(|byte| *byte == 0) {
        coded.push(part.len() as u8 + 1);
        coded.extend_from_slice(part);
    }
    coded.push(0);
    coded
}
