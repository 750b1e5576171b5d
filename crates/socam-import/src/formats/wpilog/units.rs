//! Units that the metadata of an entry states.

/// Names by which WPILib's library of units calls them, in the metadata of SysId's entries.
const UNITS: [(&str, &str); 14] = [
    ("Volt", "V"),
    ("Amp", "A"),
    ("Rotation", "rot"),
    ("Rotation per Second", "rot/s"),
    ("Radian", "rad"),
    ("Radian per Second", "rad/s"),
    ("Degree", "deg"),
    ("Degree per Second", "deg/s"),
    ("Meter", "m"),
    ("Meter per Second", "m/s"),
    ("Foot", "ft"),
    ("Foot per Second", "ft/s"),
    ("Inch", "in"),
    ("Inch per Second", "in/s"),
];

/// The unit in an entry's metadata: JSON with `unit`, or what SysId writes.
pub(super) fn unit(metadata: &str) -> Option<String> {
    let metadata = metadata.trim();
    let stated = if metadata.starts_with('{') {
        let value: serde_json::Value = serde_json::from_str(metadata).ok()?;
        value.get("unit").or_else(|| value.get("units"))?.as_str()?.to_owned()
    } else {
        metadata.to_owned()
    };
    let known = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(&stated));
    Some(known.map_or(stated, |(_, unit)| (*unit).to_owned())).filter(|unit| !unit.is_empty())
}

#[cfg(test)]
mod tests {
    use super::unit;

    #[test]
    fn units_are_found_in_all_metadata() {
        for (metadata, stated) in [
            ("", None),
            ("Rotation per Second", Some("rot/s")),
            ("volt", Some("V")),
            (r#"{"source":"NT"}"#, None),
            (r#"{"source":"AdvantageKit","unit":"meter per second"}"#, Some("m/s")),
            ("{", None),
        ] {
            assert_eq!(unit(metadata).as_deref(), stated, "{metadata}");
        }
    }
}
