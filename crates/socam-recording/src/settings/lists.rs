//! Lists and tables of tables.

use toml::de::DeValue;

use super::{Fields, describe, line_of};

impl<'t> Fields<'t> {
    /// The tables `[key.NAME]`, in the order of the file; none where `key` is left out.
    pub fn named_tables<T>(&mut self, key: &str, mut read: impl FnMut(&str, &mut Fields<'t>) -> T) -> Vec<T> {
        let tables = match self.take(key) {
            Some((_, DeValue::Table(tables))) => tables,
            Some((line, value)) => {
                let expected = format!("tables [{key}.NAME]");
                return self.expected(line, key, &expected, &describe(&value)).unwrap_or_default();
            }
            None => return Vec::new(),
        };
        let mut tables: Vec<_> = tables.into_iter().collect();
        tables.sort_by_key(|(name, _)| name.span().start);
        let mut values = Vec::new();
        for (name, table) in tables {
            let line = line_of(self.text, name.span().start);
            if let DeValue::Table(inner) = table.into_inner() {
                let mut inner = Fields::over(self.text, line, inner);
                values.push(read(name.get_ref(), &mut inner));
                self.problems.extend(inner.finish().err());
            } else {
                self.note(
                    line,
                    format!("`{}` is no table; expected [{key}.{}]", name.get_ref(), name.get_ref()),
                );
            }
        }
        values
    }

    /// The tables of a list, or none.
    pub fn maybe_tables<T>(&mut self, key: &str, read: impl FnMut(&mut Fields<'t>) -> T) -> Vec<T> {
        if self.values.contains_key(key) {
            return self.tables(key, read);
        }
        self.known.push(key.to_owned());
        Vec::new()
    }

    /// An optional list of texts.
    pub fn maybe_texts(&mut self, key: &str) -> Option<Vec<String>> {
        let (line, value) = self.take(key)?;
        let texts = value
            .as_array()
            .map(|list| list.iter().map(|text| text.get_ref().as_str().map(str::to_owned)).collect());
        match texts {
            Some(Some(texts)) => Some(texts),
            _ => self.expected(line, key, "a list of texts in quotes", &describe(&value)),
        }
    }

    /// The tables of a list; at least one.
    pub fn tables<T>(&mut self, key: &str, mut read: impl FnMut(&mut Fields<'t>) -> T) -> Vec<T> {
        let expected = format!("one table [[{key}]] or more");
        let tables = match self.take(key) {
            Some((_, DeValue::Array(tables))) => tables,
            Some((line, value)) => {
                return self.expected(line, key, &expected, &describe(&value)).unwrap_or_default();
            }
            None => {
                self.missing(key, &expected);
                return Vec::new();
            }
        };
        let mut values = Vec::new();
        for table in tables {
            let line = line_of(self.text, table.span().start);
            if let DeValue::Table(table) = table.into_inner() {
                let mut table = Fields::over(self.text, line, table);
                values.push(read(&mut table));
                self.problems.extend(table.finish().err());
            } else {
                self.note(line, format!("`{key}` holds something else; expected {expected}"));
            }
        }
        values
    }
}
