//! Tables of names and lists of tables, with limits of their lengths.

use std::{fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer,
    de::{Error, MapAccess, SeqAccess, Visitor},
};
use toml::Spanned;

/// Most parameters of a model, and most channels.
const MOST_NAMES: usize = 300;

/// Most nodes, and most elements of each kind. A run of 3 s of a chain of 100 nodes is simulated in 2 s, one of 300 in half a minute.
const MOST_ITEMS: usize = 100;

/// A table whose entries keep their order and positions in the file.
pub(super) struct Ordered<T>(pub(super) Vec<(Spanned<String>, T)>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Ordered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Ordered<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a table of names, written with single brackets as [parameters] or [channels.NAME]",
                )
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                    if entries.len() > MOST_NAMES {
                        return Err(A::Error::custom(format_args!(
                            "this table has more than {MOST_NAMES} names, the most that are read"
                        )));
                    }
                }
                Ok(Ordered(entries))
            }
        }
        deserializer.deserialize_any(Entries(PhantomData))
    }
}

impl<T> Default for Ordered<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

/// Tables of one kind, each under its own `[[NAME]]`.
pub(super) struct List<T>(pub(super) Vec<T>);

/// The contents of a `[[NAME]]` table.
pub(super) trait Listed {
    const NAME: &str;
}

impl<'de, T: Deserialize<'de> + Listed> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Items<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de> + Listed> Visitor<'de> for Items<T> {
            type Value = List<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "one [[{0}]] table for each of the {0}", T::NAME)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Self::Value, A::Error> {
                let mut list = Vec::new();
                while let Some(item) = items.next_element()? {
                    list.push(item);
                    if list.len() > MOST_ITEMS {
                        let name = T::NAME;
                        return Err(A::Error::custom(format_args!(
                            "a model has at most {MOST_ITEMS} [[{name}]]; its equations take the cube of that in time"
                        )));
                    }
                }
                Ok(List(list))
            }
            fn visit_map<A: MapAccess<'de>>(self, _: A) -> Result<Self::Value, A::Error> {
                let name = T::NAME;
                Err(A::Error::custom(format_args!(
                    "[{name}] is one table, but a model has a list of {name}; write [[{name}]], with two brackets, above each of them"
                )))
            }
        }
        deserializer.deserialize_any(Items(PhantomData))
    }
}

impl<T> Default for List<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}
