//! Words and numbers with units.

use socam_units::Dimension;

use crate::DescribeError;

/// A number with its unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Size {
    pub(crate) value: f64,
    /// Unit as written; empty for a bare number.
    pub(crate) unit: String,
    /// Value in SI.
    pub(crate) si: f64,
    pub(crate) dimension: Dimension,
}

/// The words of one part.
#[derive(Debug, Clone, Default)]
pub(crate) struct Words {
    /// The part as it was written.
    pub(crate) text: String,
    pub(crate) names: Vec<String>,
    pub(crate) sizes: Vec<Size>,
    /// Two numbers with a colon between them, and their unit.
    pub(crate) pair: Option<(f64, f64, String)>,
    /// Sizes with a word before them that says what they are, such as `span 400mm`.
    pub(crate) keyed: Vec<(String, Size)>,
}

/// Words that say what the size behind them is.
const KEYS: [&str; 3] = ["span", "width", "pitch"];

pub(crate) fn dimension(unit: &str) -> Dimension {
    socam_units::parse(unit).map_or([0; 5], |unit| unit.dimension)
}

impl Words {
    pub(crate) fn read(text: &str) -> Result<Self, DescribeError> {
        let mut words = Self { text: text.trim().to_owned(), ..Self::default() };
        let all: Vec<String> = text.split_whitespace().map(|word| word.replace('\u{d7}', "x")).collect();
        let mut next = 0;
        let mut key = None;
        while let Some(word) = all.get(next) {
            next += 1;
            let Some((number, rest)) = number(word) else {
                let word = word.to_lowercase();
                if KEYS.contains(&word.as_str()) {
                    key = Some(word);
                } else {
                    words.names.push(word);
                }
                continue;
            };
            if let Some((second, unit)) = rest.strip_prefix(':').and_then(self::number) {
                words.pair = Some((number, second, unit.to_owned()));
                continue;
            }
            let mut numbers = vec![number];
            let mut rest = rest;
            while let Some((more, after)) = rest.strip_prefix('x').and_then(self::number) {
                numbers.push(more);
                rest = after;
            }
            // A unit of several words: `0.9 kg cm2`.
            let mut unit = rest.to_owned();
            while let Some(more) = all.get(next) {
                let longer = format!("{unit} {more}").trim().to_owned();
                if self::number(more).is_some() || socam_units::parse(&longer).is_none() {
                    break;
                }
                unit = longer;
                next += 1;
            }
            for number in numbers {
                let size = words.size(number, &unit)?;
                match key.take() {
                    Some(key) => words.keyed.push((key, size)),
                    None => words.sizes.push(size),
                }
            }
        }
        Ok(words)
    }

    fn size(&self, value: f64, unit: &str) -> Result<Size, DescribeError> {
        let parsed = socam_units::parse(if unit.is_empty() { "1" } else { unit });
        let Some(parsed) = parsed else {
            let problem = format!("\"{unit}\" is no unit; write one such as kgcm2, Nm/rad, mm, kg or ohm");
            return Err(DescribeError::text(&self.text, problem));
        };
        if !(value.is_finite() && value > 0.0) {
            return Err(DescribeError::text(&self.text, format!("{value}{unit} must be above 0")));
        }
        Ok(Size { value, unit: unit.to_owned(), si: value * parsed.factor, dimension: parsed.dimension })
    }

    /// Takes the first size of a unit's dimension.
    pub(crate) fn take(&mut self, unit: &str) -> Option<Size> {
        let wanted = dimension(unit);
        let bare = unit == "1";
        let at =
            self.sizes.iter().position(|size| size.dimension == wanted && size.unit.is_empty() == bare)?;
        Some(self.sizes.remove(at))
    }

    pub(crate) fn take_keyed(&mut self, key: &str) -> Option<Size> {
        let at = self.keyed.iter().position(|(known, _)| known == key)?;
        Some(self.keyed.remove(at).1)
    }

    /// Takes a word, if it is one of these.
    pub(crate) fn take_name(&mut self, names: &[&str]) -> Option<String> {
        let at = self.names.iter().position(|name| names.contains(&name.as_str()))?;
        Some(self.names.remove(at))
    }

    /// Refuses words that no part has used. `how` explains how the part is written.
    pub(crate) fn finish(&self, how: &str) -> Result<(), DescribeError> {
        let size = |size: &Size| format!("{}{}", size.value, size.unit);
        let name = self.names.first().cloned();
        let keyed = self.keyed.first().map(|(key, own)| format!("{key} {}", size(own)));
        let pair = self.pair.as_ref().map(|(a, b, unit)| format!("{a}:{b}{unit}"));
        match name.or(keyed).or(pair).or_else(|| self.sizes.first().map(size)) {
            Some(left) => {
                Err(DescribeError::text(&self.text, format!("\"{left}\" is not understood; write {how}")))
            }
            None => Ok(()),
        }
    }
}

/// The longest number that a word begins with, and the rest of the word.
fn number(word: &str) -> Option<(f64, &str)> {
    let starts = word.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+'));
    let ends = word.char_indices().map(|(index, _)| index).chain([word.len()]).filter(|end| *end > 0);
    let longest =
        ends.filter_map(|end| Some((word[..end].parse::<f64>().ok()?, &word[end..]))).next_back()?;
    (starts && longest.0.is_finite()).then_some(longest)
}
