//! The model file as it is written, every name with its place.

use std::{fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer,
    de::{MapAccess, Visitor},
};
use toml::Spanned;

use crate::{Intersample, Motion, Quantity, Role, Take};

/// A table whose entries keep the order and the places that they have in the file.
pub(super) struct Ordered<T>(pub(super) Vec<(Spanned<String>, T)>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Ordered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Ordered<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Ordered(entries))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

impl<T> Default for Ordered<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

pub(super) type Name = Spanned<String>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawModel {
    pub(super) schema: Name,
    pub(super) name: String,
    #[serde(default)]
    pub(super) description: String,
    pub(super) motion: Motion,
    pub(super) parameters: Ordered<RawParameter>,
    pub(super) nodes: Vec<RawNode>,
    #[serde(default)]
    pub(super) springs: Vec<RawSpring>,
    #[serde(default)]
    pub(super) gears: Vec<RawGear>,
    #[serde(default)]
    pub(super) shafts: Vec<RawShaft>,
    #[serde(default)]
    pub(super) bearings: Vec<RawBearing>,
    #[serde(default)]
    pub(super) effects: Vec<RawEffect>,
    pub(super) servo: Option<RawServo>,
    pub(super) channels: Ordered<RawChannel>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table like { value = 1.2, unit = \"N m/rad\" }")]
pub(super) struct RawParameter {
    pub(super) value: Spanned<f64>,
    pub(super) unit: Name,
    pub(super) bounds: Option<Spanned<[f64; 2]>>,
    #[serde(default)]
    pub(super) fixed: bool,
    #[serde(default)]
    pub(super) source: String,
    pub(super) prior: Option<RawPrior>,
    /// 95 % interval of an earlier identification: kept for the reader, not used.
    #[allow(dead_code)]
    pub(super) ci95: Option<toml::Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table like { value = 1.2, std = 0.1 }")]
pub(super) struct RawPrior {
    pub(super) value: f64,
    pub(super) std: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[nodes]] table")]
pub(super) struct RawNode {
    pub(super) name: Name,
    pub(super) inertia: Option<Name>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[springs]] table")]
pub(super) struct RawSpring {
    pub(super) name: Name,
    pub(super) from: Name,
    pub(super) to: Name,
    pub(super) stiffness: Name,
    pub(super) damping: Option<Name>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[gears]] table")]
pub(super) struct RawGear {
    pub(super) name: Name,
    pub(super) from: Name,
    pub(super) to: Name,
    pub(super) ratio: Name,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[shafts]] table")]
pub(super) struct RawShaft {
    pub(super) name: Name,
    pub(super) from: Name,
    pub(super) to: Name,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[bearings]] table")]
pub(super) struct RawBearing {
    pub(super) name: Name,
    pub(super) at: Name,
    pub(super) damping: Option<Name>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an [[effects]] table")]
pub(super) struct RawEffect {
    pub(super) effect: Name,
    pub(super) at: Name,
    pub(super) parameters: Ordered<Name>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [servo] table")]
pub(super) struct RawServo {
    pub(super) name: Name,
    pub(super) at: Name,
    pub(super) position_gain: Name,
    pub(super) velocity_gain: Name,
    pub(super) drive_gain: Name,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [channels.NAME] table")]
pub(super) struct RawChannel {
    pub(super) role: Role,
    pub(super) quantity: Quantity,
    pub(super) at: Name,
    pub(super) column: Option<String>,
    pub(super) take: Option<Spanned<Take>>,
    #[serde(default = "one")]
    pub(super) scale: f64,
    #[serde(default)]
    pub(super) offset: f64,
    pub(super) noise_std: Option<Spanned<f64>>,
    pub(super) gain: Option<Name>,
    #[serde(default)]
    pub(super) estimate_offset: bool,
    pub(super) between: Option<Spanned<Intersample>>,
}

fn one() -> f64 {
    1.0
}
