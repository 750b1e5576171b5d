//! Reads which PDOs a drive sends, and which objects they hold, out of the drive itself (CiA 301, objects 1800 and 1A00 and those behind them).

use super::messages::{Answer, abort_text, upload};
use super::objects::Objects;
use super::place::{Place, written};
use crate::error::{Result, SourceError};

/// PDOs that are looked at; drives have four.
const PDOS: u16 = 8;
/// Objects of a PDO.
const MOST_ENTRIES: u8 = 64;
/// Time for an answer, ns, and how often it is asked for.
const ANSWER_NS: i64 = 100_000_000;
const TRIES: u32 = 10;

/// A PDO that holds objects of the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pdo {
    pub(super) id: u32,
    /// Length of its frames, bytes.
    pub(super) length: usize,
    /// Objects of the list by their number, and where they begin.
    pub(super) places: Vec<(usize, usize)>,
}

/// Whether a PDO holds an object of the list.
pub(super) fn is_held(pdos: &[Pdo], object: usize) -> bool {
    pdos.iter().any(|pdo| pdo.places.iter().any(|(held, _)| *held == object))
}

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Id,
    Count,
    Entry {
        number: u8,
        count: u8,
        bits: usize,
    },
    /// All objects that no PDO holds, once, by their number.
    Object(usize),
    Done,
}

/// A drive while it is asked how it is configured.
#[derive(Debug)]
pub(super) struct Discovery {
    node: u8,
    number: u16,
    step: Step,
    pdos: Vec<Pdo>,
    present: Pdo,
    /// When it was asked last, and how often in a row.
    asked: Option<(i64, u32)>,
}

impl Discovery {
    pub(super) fn new(node: u8) -> Self {
        let present = Pdo { id: 0, length: 0, places: Vec::new() };
        Self { node, number: 0, step: Step::Id, pdos: Vec::new(), present, asked: None }
    }

    /// Without PDOs: all objects are asked for.
    pub(super) fn of_objects(node: u8) -> Self {
        Self { step: Step::Object(0), ..Self::new(node) }
    }

    /// The PDOs, once all is known.
    pub(super) fn done(&mut self) -> Option<Vec<Pdo>> {
        (self.step == Step::Done).then(|| std::mem::take(&mut self.pdos))
    }

    fn wanted(&self, objects: &Objects) -> Option<Place> {
        let (settings, entries) = (0x1800 + self.number, 0x1a00 + self.number);
        match self.step {
            Step::Id => Some((settings, 1)),
            Step::Count => Some((entries, 0)),
            Step::Entry { number, .. } => Some((entries, number)),
            Step::Object(index) => objects.all.get(index).map(|object| object.place),
            Step::Done => None,
        }
    }

    /// Appends the next question; returns the time of the next call.
    pub(super) fn poll(&mut self, now_ns: i64, objects: &Objects, out: &mut Vec<u8>) -> Result<i64> {
        let tries = match self.asked {
            Some((asked_ns, _)) if now_ns - asked_ns < ANSWER_NS => return Ok(asked_ns + ANSWER_NS),
            Some((_, tries)) => tries,
            None => 0,
        };
        if tries >= TRIES {
            let problem = format!(
                "node {} does not answer: is it on the bus, is that its number, and is the bit rate right?",
                self.node
            );
            return Err(SourceError::Foreign(problem));
        }
        if let Some(place) = self.wanted(objects) {
            out.extend(upload(self.node, place));
            self.asked = Some((now_ns, tries + 1));
        }
        Ok(now_ns + ANSWER_NS)
    }

    /// Takes an answer; one to another question is left out.
    pub(super) fn take(&mut self, answer: &Answer, objects: &Objects) -> Result<()> {
        if self.wanted(objects) != Some(answer.place()) || matches!(answer, Answer::Done(_)) {
            return Ok(());
        }
        self.asked = None;
        let number = answer.number();
        match (self.step, number) {
            (Step::Object(index), _) => return self.checked(index, answer, objects),
            // Bit 31: it is not used; bit 29: its identifier has 29 bits.
            (Step::Id, Some(id)) if id & 0xa000_0000 == 0 => {
                self.present = Pdo { id: id & 0x7ff, length: 0, places: Vec::new() };
                self.step = Step::Count;
            }
            (Step::Count, Some(count)) if (1..=u32::from(MOST_ENTRIES)).contains(&count) => {
                self.step = Step::Entry { number: 1, count: count as u8, bits: 0 };
            }
            (Step::Entry { number, count, bits }, Some(entry)) => {
                return self.entry(number, count, bits, entry, objects);
            }
            (Step::Id | Step::Count | Step::Entry { .. }, _) => self.next_pdo(objects),
            (Step::Done, _) => {}
        }
        Ok(())
    }

    fn entry(&mut self, number: u8, count: u8, bits: usize, entry: u32, objects: &Objects) -> Result<()> {
        let place = ((entry >> 16) as u16, (entry >> 8) as u8);
        let width = (entry & 0xff) as usize;
        if let Some(index) = objects.all.iter().position(|object| object.place == place) {
            let object = &objects.all[index];
            if width != 8 * object.number.width() || !bits.is_multiple_of(8) {
                let problem = format!(
                    "the drive sends {} with {width} bits from bit {bits} of a PDO; line {} of the list says {} bits: correct its type",
                    object.name(),
                    object.map.line,
                    8 * object.number.width()
                );
                return Err(SourceError::Foreign(problem));
            }
            self.present.places.push((index, bits / 8));
        }
        let bits = bits + width;
        if number < count {
            self.step = Step::Entry { number: number + 1, count, bits };
            return Ok(());
        }
        // A frame has eight bytes; a mapping beyond is none.
        if bits <= 64 && !self.present.places.is_empty() {
            self.present.length = bits.div_ceil(8);
            self.pdos.push(self.present.clone());
        }
        self.next_pdo(objects);
        Ok(())
    }

    fn next_pdo(&mut self, objects: &Objects) {
        self.number += 1;
        self.step = Step::Id;
        if self.number >= PDOS {
            self.next_object(0, objects);
        }
    }

    /// The next object from a number that no PDO holds.
    fn next_object(&mut self, from: usize, objects: &Objects) {
        let next = (from..objects.all.len()).find(|index| !is_held(&self.pdos, *index));
        self.step = next.map_or(Step::Done, Step::Object);
    }

    /// An object that is asked for must be there, and have the size of its type.
    fn checked(&mut self, index: usize, answer: &Answer, objects: &Objects) -> Result<()> {
        let object = &objects.all[index];
        let (name, line, width) = (object.name(), object.map.line, object.number.width());
        match answer {
            Answer::Value(_, bytes) if bytes.len() == width => {
                self.next_object(index + 1, objects);
                Ok(())
            }
            Answer::Value(_, bytes) => Err(SourceError::Foreign(format!(
                "the drive states {name} with {} bytes; line {line} of the list says {width}: correct its type",
                bytes.len()
            ))),
            Answer::Done(_) => Ok(()),
            Answer::Abort(place, code) => Err(SourceError::Foreign(format!(
                "the drive does not give {} (line {line} of the list): {}",
                written(*place),
                abort_text(*code)
            ))),
            Answer::Long(place) => Err(SourceError::Foreign(format!(
                "{} (line {line} of the list) has more than four bytes, which is not read",
                written(*place)
            ))),
        }
    }
}
