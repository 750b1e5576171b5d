//! A writer of XML that escapes its content.

use quick_xml::{
    Writer,
    events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event},
};

use crate::{ExportError, names::line};

pub(crate) struct Xml {
    writer: Writer<Vec<u8>>,
    open: Vec<&'static str>,
}

impl Xml {
    pub(crate) fn new() -> Result<Self, ExportError> {
        let mut xml = Self { writer: Writer::new_with_indent(Vec::new(), b' ', 2), open: Vec::new() };
        xml.write(Event::Decl(BytesDecl::new("1.0", Some("utf-8"), None)))?;
        Ok(xml)
    }

    fn write(&mut self, event: Event<'_>) -> Result<(), ExportError> {
        self.writer.write_event(event).map_err(|error| ExportError::Xml(error.to_string()))
    }

    /// A comment of one line or more. XML ends a comment at two hyphens.
    pub(crate) fn comment(&mut self, lines: &[String]) -> Result<(), ExportError> {
        let plain = lines.iter().map(|text| line(text).replace("--", "- -").trim_end_matches('-').to_owned());
        let text = if let [one] = lines {
            format!(" {} ", line(one).replace("--", "- -").trim_end_matches('-'))
        } else {
            format!("\n{}\n", plain.collect::<Vec<_>>().join("\n"))
        };
        self.write(Event::Comment(BytesText::from_escaped(text)))
    }

    fn start(name: &'static str, attributes: &[(&'static str, String)]) -> BytesStart<'static> {
        let mut start = BytesStart::new(name);
        for (key, value) in attributes {
            start.push_attribute((*key, line(value).as_str()));
        }
        start
    }

    /// Opens an element.
    pub(crate) fn open(
        &mut self,
        name: &'static str,
        attributes: &[(&'static str, String)],
    ) -> Result<(), ExportError> {
        self.open.push(name);
        self.write(Event::Start(Self::start(name, attributes)))
    }

    /// Closes the element that was opened last.
    pub(crate) fn close(&mut self) -> Result<(), ExportError> {
        match self.open.pop() {
            Some(name) => self.write(Event::End(BytesEnd::new(name))),
            None => Ok(()),
        }
    }

    /// An element without content.
    pub(crate) fn empty(
        &mut self,
        name: &'static str,
        attributes: &[(&'static str, String)],
    ) -> Result<(), ExportError> {
        self.write(Event::Empty(Self::start(name, attributes)))
    }

    /// An element that holds a text.
    pub(crate) fn text(
        &mut self,
        name: &'static str,
        attributes: &[(&'static str, String)],
        text: &str,
    ) -> Result<(), ExportError> {
        self.write(Event::Start(Self::start(name, attributes)))?;
        self.write(Event::Text(BytesText::new(&line(text))))?;
        self.write(Event::End(BytesEnd::new(name)))
    }

    /// The whole text, after all elements are closed.
    pub(crate) fn finish(mut self) -> Result<String, ExportError> {
        while !self.open.is_empty() {
            self.close()?;
        }
        let text = String::from_utf8(self.writer.into_inner())
            .map_err(|error| ExportError::Xml(error.to_string()))?;
        Ok(text + "\n")
    }
}

/// An attribute.
pub(crate) fn attribute(key: &'static str, value: impl ToString) -> (&'static str, String) {
    (key, value.to_string())
}

/// Numbers separated by blanks.
pub(crate) fn numbers(all: &[f64]) -> String {
    all.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(" ")
}
