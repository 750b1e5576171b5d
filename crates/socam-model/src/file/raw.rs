//! The model file as it is written; names have their positions in the text.

use std::fmt;

use serde::{
    Deserialize, Deserializer,
    de::{Error, IgnoredAny, MapAccess, Visitor},
};
use toml::Spanned;

use super::lists::{List, Listed, Ordered};
use crate::{ChannelTransform, Intersample, Motion, Quantity, Role};

pub(super) type Name = Spanned<String>;

/// The name of a parameter, where one is expected.
pub(super) type Reference = Spanned<Written>;

/// A value where the name of a parameter is expected.
pub(super) enum Written {
    Name(String),
    /// A number, which lacks unit, bounds and source.
    Number(f64),
    /// A table or a list.
    Other,
}

impl<'de> Deserialize<'de> for Written {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Anything;
        impl<'de> Visitor<'de> for Anything {
            type Value = Written;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a parameter in quotes")
            }
            fn visit_str<E: Error>(self, name: &str) -> Result<Written, E> {
                Ok(Written::Name(name.into()))
            }
            fn visit_i64<E: Error>(self, number: i64) -> Result<Written, E> {
                Ok(Written::Number(number as f64))
            }
            fn visit_f64<E: Error>(self, number: f64) -> Result<Written, E> {
                Ok(Written::Number(number))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Written, A::Error> {
                while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
                Ok(Written::Other)
            }
        }
        deserializer.deserialize_any(Anything)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawModel {
    pub(super) schema: Name,
    pub(super) name: String,
    #[serde(default)]
    pub(super) description: String,
    pub(super) motion: Motion,
    pub(super) parameters: Ordered<RawParameter>,
    pub(super) nodes: List<RawNode>,
    #[serde(default)]
    pub(super) springs: List<RawSpring>,
    #[serde(default)]
    pub(super) gears: List<RawGear>,
    #[serde(default)]
    pub(super) differentials: List<RawDifferential>,
    #[serde(default)]
    pub(super) shafts: List<RawShaft>,
    #[serde(default)]
    pub(super) bearings: List<RawBearing>,
    #[serde(default)]
    pub(super) effects: List<RawEffect>,
    #[serde(default)]
    pub(super) laws: List<RawLaw>,
    #[serde(default)]
    pub(super) motors: List<RawMotor>,
    pub(super) servo: Option<RawServo>,
    pub(super) channels: Ordered<RawChannel>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table like { value = 1.2, unit = \"N m/rad\" }")]
pub(super) struct RawParameter {
    pub(super) value: Spanned<f64>,
    pub(super) unit: Name,
    pub(super) bounds: Option<Spanned<Vec<f64>>>,
    #[serde(default)]
    pub(super) fixed: bool,
    #[serde(default)]
    pub(super) source: String,
    pub(super) prior: Option<RawPrior>,
    /// 95 % interval of an earlier identification; allowed in a file and not used.
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
    pub(super) inertia: Option<Reference>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[springs]] table")]
pub(super) struct RawSpring {
    pub(super) name: Name,
    pub(super) from: Name,
    pub(super) to: Name,
    pub(super) stiffness: Reference,
    pub(super) damping: Option<Reference>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[gears]] table")]
pub(super) struct RawGear {
    pub(super) name: Name,
    pub(super) from: Name,
    pub(super) to: Name,
    pub(super) ratio: Reference,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[differentials]] table")]
pub(super) struct RawDifferential {
    pub(super) name: Name,
    pub(super) from: Vec<Name>,
    pub(super) to: Name,
    pub(super) factors: Vec<Reference>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[motors]] table")]
pub(super) struct RawMotor {
    pub(super) name: Name,
    pub(super) at: Name,
    pub(super) resistance: Reference,
    pub(super) torque_constant: Reference,
    pub(super) back_emf: Option<Reference>,
    pub(super) inductance: Option<Reference>,
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
    pub(super) damping: Option<Reference>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an [[effects]] table")]
pub(super) struct RawEffect {
    pub(super) effect: Name,
    pub(super) at: Name,
    pub(super) parameters: Ordered<Reference>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [[laws]] table")]
pub(super) struct RawLaw {
    pub(super) name: Name,
    pub(super) at: Name,
    #[serde(default = "curve_alone")]
    pub(super) formula: Name,
    pub(super) curve: Option<Spanned<RawCurve>>,
    #[serde(default)]
    pub(super) parameters: Ordered<Reference>,
    #[serde(default)]
    pub(super) inputs: Ordered<Name>,
    #[serde(default)]
    pub(super) candidate: bool,
}

/// The formula of a law that is a curve and nothing else.
fn curve_alone() -> Name {
    Spanned::new(0..0, crate::formula::CURVE.to_owned())
}

#[derive(Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { over = \"speed\", at = [0, 50], values = [0, 0.3], unit = \"N m\" }"
)]
pub(super) struct RawCurve {
    pub(super) over: Name,
    pub(super) at: Spanned<Vec<f64>>,
    pub(super) at_unit: Option<Name>,
    pub(super) values: Spanned<Vec<Reference>>,
    pub(super) unit: Option<Name>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [servo] table")]
pub(super) struct RawServo {
    pub(super) name: Name,
    pub(super) at: Name,
    pub(super) position_gain: Reference,
    pub(super) velocity_gain: Reference,
    pub(super) drive_gain: Reference,
    pub(super) limit: Option<Reference>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a [channels.NAME] table")]
pub(super) struct RawChannel {
    pub(super) role: Role,
    pub(super) quantity: Quantity,
    pub(super) at: Name,
    pub(super) column: Option<Name>,
    pub(super) unit: Option<Name>,
    pub(super) take: Option<Spanned<ChannelTransform>>,
    pub(super) scale: Option<f64>,
    #[serde(default)]
    pub(super) offset: f64,
    pub(super) noise_std: Option<Spanned<f64>>,
    pub(super) gain: Option<Reference>,
    #[serde(default)]
    pub(super) estimate_offset: bool,
    pub(super) between: Option<Spanned<Intersample>>,
}

macro_rules! listed {
    ($($table:ty = $name:literal),*) => { $(impl Listed for $table { const NAME: &str = $name; })* };
}

listed!(
    RawNode = "nodes",
    RawSpring = "springs",
    RawGear = "gears",
    RawDifferential = "differentials",
    RawMotor = "motors",
    RawShaft = "shafts",
    RawBearing = "bearings",
    RawEffect = "effects",
    RawLaw = "laws"
);
