//! Servos on one bus, asked for their registers by one question a sample; they are never commanded.
//!
//! What differs between makes is data, a [`Make`]. Each servo is first asked for what its numbers mean; then all of them answer to one
//! question (sync read), one behind the other, and their values are one row. A servo that does not answer has missing values in it.

use socam_recording::Channel;
use socam_units::Unit;

use crate::asking::Asking;
use crate::device::{Chunk, Device, Heard, Numbering};
use crate::error::{Result, SourceError};

/// Most servos of a bus.
const MOST: usize = 32;
/// Longest time by which each further servo delays the last answer, ns: 33 bytes take 9 ms at 38400 baud.
const MORE_NS: i64 = 10_000_000;
/// Questions without an answer after which a servo is taken not to be there.
const MOST_UNANSWERED: u32 = 40;

/// A measured quantity of a servo: its value is its register times a factor that the servo states, plus the offset.
pub(crate) struct Quantity {
    pub(crate) name: &'static str,
    pub(crate) unit: Unit,
    pub(crate) offset: f64,
}

impl Quantity {
    pub(crate) const fn new(name: &'static str, unit: Unit, offset: f64) -> Self {
        Self { name, unit, offset }
    }
}

/// What the registers of a servo say of itself.
#[derive(Debug)]
pub(crate) struct Facts {
    /// Factor of each quantity, NaN where its register has no known unit.
    pub(crate) factors: Vec<f64>,
    /// Its model and settings, in words that follow "the servo is".
    pub(crate) words: String,
}

/// An answer of a servo.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Status {
    pub(crate) id: u8,
    pub(crate) error: u8,
    pub(crate) values: Vec<u8>,
}

/// Protocol and registers of a make of servos.
pub(crate) struct Make {
    pub(crate) name: &'static str,
    /// An address of it, as an example in messages.
    pub(crate) address: &'static str,
    pub(crate) largest_id: u8,
    /// First register and number of registers that say what the numbers of a servo mean.
    pub(crate) facts: (u16, u16),
    /// Those of a sample.
    pub(crate) sample: (u16, u16),
    pub(crate) quantities: &'static [Quantity],
    /// The packet that asks servos for registers.
    pub(crate) question: fn(&[u8], (u16, u16)) -> Vec<u8>,
    /// Takes the whole packet at the beginning of bytes, which are dropped up to one.
    pub(crate) packet: fn(&mut Vec<u8>) -> Option<std::result::Result<Status, &'static str>>,
    /// Reads the facts, or says why the servo cannot be used.
    pub(crate) learn: fn(&[u8]) -> std::result::Result<Facts, String>,
    /// The numbers of the quantities in the registers of a sample; `None` if there are not enough.
    pub(crate) numbers: fn(&[u8]) -> Option<Vec<f64>>,
    /// Bits of an answer's error that say that the question was refused; the others are faults of the servo.
    pub(crate) refusal: u8,
    /// Faults in words that follow "it reports".
    pub(crate) fault: fn(u8) -> String,
}

/// Servos of one bus, asked together.
pub struct Servos {
    make: &'static Make,
    channels: Vec<Channel>,
    servos: Vec<Servo>,
    asking: Asking,
    bytes: Vec<u8>,
    /// Arrival of the last answer to the present question, ns.
    arrival_ns: i64,
    /// A row of which some servos did not answer in time, and faults found with it.
    late: Vec<Heard>,
    /// Questions in a row for the facts of a servo that got no answer.
    unanswered: u32,
    problem: Option<String>,
}

/// A servo of the bus.
struct Servo {
    id: u8,
    facts: Option<Facts>,
    /// Its values in the row that is being gathered.
    values: Option<Vec<f64>>,
    error: u8,
    is_silent: bool,
}

impl Servos {
    /// Servos of a make by their numbers, asked at this interval.
    pub(crate) fn new(make: &'static Make, ids: &[u8], period_ns: i64) -> Result<Self> {
        let is_twice = |(at, id): (usize, &u8)| ids[..at].contains(id);
        let problem = if let Some(id) = ids.iter().find(|id| **id > make.largest_id) {
            format!("{id} is no number of a {}", make.name)
        } else if ids.is_empty() || ids.len() > MOST {
            format!("a bus has 1 to {MOST} servos, not {}", ids.len())
        } else if ids.iter().enumerate().any(is_twice) {
            "a servo is named twice".into()
        } else {
            let servo = |id: &u8| Servo { id: *id, facts: None, values: None, error: 0, is_silent: false };
            return Ok(Self {
                make,
                channels: channels(make, ids),
                servos: ids.iter().map(servo).collect(),
                asking: Asking::new(period_ns).slower_by(MORE_NS * (ids.len() as i64 - 1)),
                bytes: Vec::new(),
                arrival_ns: 0,
                late: Vec::new(),
                unanswered: 0,
                problem: None,
            });
        };
        let Make { address, largest_id, .. } = make;
        Err(SourceError::Foreign(format!(
            "{problem}; expected numbers from 0 to {largest_id}, as in {address}"
        )))
    }

    fn question(&self) -> Vec<u8> {
        match self.servos.iter().find(|servo| servo.facts.is_none()) {
            Some(servo) => (self.make.question)(&[servo.id], self.make.facts),
            None => {
                let ids: Vec<u8> = self.servos.iter().map(|servo| servo.id).collect();
                (self.make.question)(&ids, self.make.sample)
            }
        }
    }

    fn is_learning(&self) -> bool {
        self.servos.iter().any(|servo| servo.facts.is_none())
    }

    fn status(&mut self, status: &Status, arrival_ns: i64, heard: &mut Vec<Heard>) {
        let (make, is_learning) = (self.make, self.is_learning());
        let Some(servo) = self.servos.iter_mut().find(|servo| servo.id == status.id) else { return };
        if status.error & make.refusal != 0 {
            heard.push(Heard::Damaged("the servo refused the question"));
            return;
        }
        let name = || format!("the {} {}", make.name, status.id);
        if status.error != servo.error {
            servo.error = status.error;
            if status.error != 0 {
                heard.push(Heard::Fault(format!("{} reports {}", name(), (make.fault)(status.error))));
            }
        }
        match &servo.facts {
            None if status.values.len() == usize::from(make.facts.1) => match (make.learn)(&status.values) {
                Ok(facts) => {
                    heard.push(Heard::Talk(format!("{} is {}", name(), facts.words)));
                    servo.facts = Some(facts);
                    self.unanswered = 0;
                    self.asking.answered(arrival_ns, Vec::new());
                }
                Err(problem) => self.problem = Some(format!("{} {problem}", name())),
            },
            Some(facts) if !is_learning => match row(make, facts, status) {
                Some(values) => {
                    servo.values = Some(values);
                    self.arrival_ns = arrival_ns;
                }
                None => heard.push(Heard::Damaged("an answer has another length than was asked for")),
            },
            None | Some(_) => heard.push(Heard::Damaged("an answer has another length than was asked for")),
        }
        // They answer in the order in which they are asked.
        if !is_learning && self.servos.last().is_some_and(|servo| servo.values.is_some()) {
            self.gathered(heard);
        }
    }

    /// Hands on the row of the servos that answered.
    fn gathered(&mut self, heard: &mut Vec<Heard>) {
        let width = self.make.quantities.len() + 1;
        let mut values = Vec::with_capacity(self.channels.len());
        for servo in &mut self.servos {
            let is_silent = servo.values.is_none();
            if is_silent && !servo.is_silent {
                let text =
                    format!("the {} {} does not answer; its values are missing", self.make.name, servo.id);
                heard.push(Heard::Fault(text));
            }
            servo.is_silent = is_silent;
            values.extend(servo.values.take().unwrap_or_else(|| vec![f64::NAN; width]));
        }
        heard.push(self.asking.answered(self.arrival_ns, values));
    }
}

fn channels(make: &Make, ids: &[u8]) -> Vec<Channel> {
    let quantities = || make.quantities.iter().map(|one| (one.name, one.unit)).chain([("error", Unit::One)]);
    let of = |id: &u8| {
        let beginning = if ids.len() == 1 { String::new() } else { format!("servo{id}_") };
        quantities()
            .map(move |(name, unit)| Channel::new(format!("{beginning}{name}"), unit))
            .collect::<Vec<_>>()
    };
    ids.iter().flat_map(of).collect()
}

/// Values of a sample in SI units, the error last.
fn row(make: &Make, facts: &Facts, status: &Status) -> Option<Vec<f64>> {
    let numbers = Some(&status.values).filter(|values| values.len() == usize::from(make.sample.1));
    let numbers = (make.numbers)(numbers?)?;
    let scaled = numbers.iter().zip(&facts.factors).zip(make.quantities);
    let values = scaled.map(|((number, factor), quantity)| number * factor + quantity.offset);
    Some(values.chain([f64::from(status.error)]).collect())
}

impl Device for Servos {
    fn kind(&self) -> String {
        let ids: Vec<String> = self.servos.iter().map(|servo| servo.id.to_string()).collect();
        let verb = if ids.len() == 1 { "is" } else { "are" };
        format!("the {} {}, which {verb} only asked", self.make.name, ids.join(", "))
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        Numbering::Arrival
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        heard.append(&mut self.late);
        self.asking.take_missing(heard);
        for (index, byte) in chunk.bytes.iter().enumerate() {
            self.bytes.push(*byte);
            while let Some(packet) = (self.make.packet)(&mut self.bytes) {
                match packet {
                    Ok(status) => self.status(&status, chunk.arrival_ns(index), heard),
                    Err(problem) => heard.push(Heard::Damaged(problem)),
                }
            }
        }
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        if let Some(problem) = self.problem.take() {
            return Err(SourceError::Foreign(problem));
        }
        if let Some(next_ns) = self.asking.wait(now_ns) {
            return Ok(Some(next_ns));
        }
        if self.asking.awaits() {
            if let Some(servo) = self.servos.iter().find(|servo| servo.facts.is_none()) {
                self.unanswered += 1;
                if self.unanswered >= MOST_UNANSWERED {
                    return Err(SourceError::Foreign(format!(
                        "the {} {} does not answer (asked {MOST_UNANSWERED} times): is it on this bus, supplied, and set to this baud rate?",
                        self.make.name, servo.id
                    )));
                }
            } else if self.servos.iter().any(|servo| servo.values.is_some()) {
                let mut late = std::mem::take(&mut self.late);
                self.gathered(&mut late);
                self.late = late;
            }
        }
        let question = self.question();
        Ok(Some(self.asking.poll(now_ns, &question, out)))
    }

    fn awaits(&self) -> bool {
        self.asking.awaits()
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        let was_within = !self.bytes.is_empty();
        self.bytes.clear();
        self.unanswered = 0;
        self.servos.iter_mut().for_each(|servo| servo.values = None);
        self.asking.interrupted(was_within, heard);
    }
}
