//! One part of the chain.

use crate::{
    DescribeError,
    sizes::{self, Parameter, SHEAR_MODULI, rounded},
    words::{Size, Words},
};

/// A part of the chain.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) name: String,
    pub(crate) kind: PartKind,
}

/// Kind of part.
#[derive(Debug, Clone)]
pub(crate) enum PartKind {
    /// A node with inertia.
    Body(Body),
    Spring {
        stiffness: Parameter,
        relaxation_s: f64,
    },
    Rigid,
    Gear {
        ratio: Parameter,
    },
    /// A screw, which converts turns to travel; its lead is in m per turn.
    Screw {
        lead_m: f64,
        stiffness: Option<Size>,
    },
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Body {
    pub(crate) role: BodyRole,
    /// Inertia; `None` where the description gives none.
    pub(crate) inertia: Option<Parameter>,
    /// Mass of a slide, kg.
    pub(crate) mass: Option<Size>,
    pub(crate) torque_constant: Option<Size>,
    pub(crate) resistance: Option<Size>,
    pub(crate) inductance: Option<Size>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum BodyRole {
    Motor,
    #[default]
    Load,
    Slide,
    Other,
}

/// Names of parts, and examples of how each is written.
const KINDS: [(&[&str], &str); 10] = [
    (&["motor"], "motor 0.9kgcm2, and for a drive by current or voltage 0.055Nm/A 1.2ohm 0.5mH"),
    (&["coupling", "spring"], "coupling 800Nm/rad, coupling jaw, coupling bellows or coupling rigid"),
    (&["shaft"], "shaft 20x300mm steel (diameter, length), shaft 5kNm/rad or shaft rigid"),
    (&["sensor", "torquemeter", "torque_sensor"], "sensor 5kNm/rad"),
    (&["gear", "gearbox", "reducer"], "gear 5, gear 5:1, gear 20:100 teeth or gear 50 8kNm/rad 0.1kgcm2"),
    (&["belt"], "belt 20:60 span 400mm width 15mm (teeth) or belt 16:48mm span 400mm width 15mm (radii)"),
    (&["screw", "ballscrew", "rack"], "screw 5mm, screw 5mm 80N/um or rack 120mm (travel per turn)"),
    (&["slide", "carriage", "table"], "slide 12kg"),
    (
        &["load", "link", "arm"],
        "load 0.02kgm2, load disc 4kg 200mm (diameter), load rod 2kg 500mm (length) or load 2kg 300mm (radius)",
    ),
    (&["inertia", "flange", "flywheel", "pulley", "brake"], "inertia 0.5kgcm2"),
];

/// Damping of a spring divided by its stiffness, s: metal, and elastomer or belt. At 50 Hz, a loss factor of 1.6 % and 13 %.
const METAL_S: f64 = 5e-5;
const ELASTOMER_S: f64 = 4e-4;

impl Part {
    /// Reads a part. A gear with inertia and stiffness, or a belt, is several.
    pub(crate) fn read(text: &str) -> Result<Vec<Self>, DescribeError> {
        let (name, rest) = match text.split_once(": ") {
            Some((name, rest)) if !name.trim().contains(char::is_whitespace) => (Some(name.trim()), rest),
            _ => (None, text),
        };
        let mut words = Words::read(rest)?;
        let all = || KINDS.iter().flat_map(|(names, _)| *names);
        let Some(kind) = words.names.first().cloned().filter(|kind| all().any(|known| known == kind)) else {
            let names = all().copied().collect::<Vec<_>>().join(", ");
            return Err(DescribeError::text(text.trim(), format!("a part begins with one of {names}")));
        };
        words.names.remove(0);
        let (names, how) =
            KINDS.iter().find(|(names, _)| names.contains(&kind.as_str())).unwrap_or(&KINDS[0]);
        let name = name.unwrap_or(&kind).to_owned();
        if let Some(wrong) = name.chars().find(|c| !(c.is_alphanumeric() || *c == '_' || *c == '-')) {
            return Err(DescribeError::text(text.trim(), format!("the name \"{name}\" holds \"{wrong}\"")));
        }
        let one = |kind: PartKind| vec![Self { name: name.clone(), kind }];
        let parts = match names[0] {
            "motor" => one(PartKind::Body(motor(&mut words))),
            "load" | "inertia" => one(PartKind::Body(body(&mut words, names[0])?)),
            "slide" => {
                one(PartKind::Body(Body { role: BodyRole::Slide, mass: words.take("kg"), ..Body::default() }))
            }
            "coupling" => one(coupling(&mut words)),
            "shaft" => one(shaft(&mut words)?),
            "sensor" => one(spring(&mut words, METAL_S, || {
                Parameter::usual(1e4, "N m/rad", 1e3, 1e5, "torque sensors")
            })),
            "screw" => one(screw(&mut words, how)?),
            "gear" => gear(&mut words, &name, how)?,
            _ => belt(&mut words, &name, how)?,
        };
        words.finish(how)?;
        Ok(parts)
    }
}

fn motor(words: &mut Words) -> Body {
    Body {
        role: BodyRole::Motor,
        inertia: words.take("kg m2").map(|size| Parameter::given(&size)),
        torque_constant: words.take("N m/A"),
        resistance: words.take("ohm"),
        inductance: words.take("H"),
        ..Body::default()
    }
}

fn body(words: &mut Words, kind: &str) -> Result<Body, DescribeError> {
    let role = if kind == "load" { BodyRole::Load } else { BodyRole::Other };
    if let Some(inertia) = words.take("kg m2") {
        return Ok(Body { role, inertia: Some(Parameter::given(&inertia)), ..Body::default() });
    }
    let disc = words.take_name(&["disc", "disk", "cylinder"]);
    let rod = words.take_name(&["rod", "bar", "beam"]);
    let centre = words.take_name(&["centre", "center"]);
    let Some(mass) = words.take("kg") else { return Ok(Body { role, ..Body::default() }) };
    let Some(length) = words.take("m") else {
        let problem =
            "a mass needs a size: disc 4kg 200mm (diameter), rod 2kg 500mm (length) or 2kg 300mm (radius)";
        return Err(DescribeError::text(&words.text, problem));
    };
    let (m, l) = (mass.si, length.si);
    let said = format!("{} kg, {} mm", rounded(m), rounded(1e3 * l));
    let (inertia, how) = match (disc, rod, centre) {
        (Some(_), ..) => (m * l * l / 8.0, format!("disc of {said} in diameter: m d^2/8")),
        (_, Some(_), None) => (m * l * l / 3.0, format!("rod of {said} about its end: m L^2/3")),
        (_, Some(_), Some(_)) => (m * l * l / 12.0, format!("rod of {said} about its middle: m L^2/12")),
        _ => (m * l * l, format!("mass of {said} from the axis: m r^2")),
    };
    let inertia = Parameter::computed(inertia, "kg m2", (3.0, 3.0), how);
    Ok(Body { role, inertia: Some(inertia), ..Body::default() })
}

/// A spring whose stiffness is the given one, or a usual value.
fn spring(words: &mut Words, relaxation_s: f64, usual: impl FnOnce() -> Parameter) -> PartKind {
    let given = words.take("N m/rad").or_else(|| words.take("N/m"));
    let stiffness = given.map_or_else(usual, |size| Parameter::given(&size));
    PartKind::Spring { stiffness, relaxation_s }
}

fn coupling(words: &mut Words) -> PartKind {
    if words.take_name(&["rigid"]).is_some() {
        return PartKind::Rigid;
    }
    if words.take_name(&["jaw", "elastomer"]).is_some() {
        return spring(words, ELASTOMER_S, || {
            Parameter::usual(200.0, "N m/rad", 50.0, 1000.0, "jaw couplings")
        });
    }
    if words.take_name(&["bellows", "disc", "beam"]).is_some() {
        return spring(words, METAL_S, || {
            Parameter::usual(5e3, "N m/rad", 500.0, 5e4, "metal bellows and disc couplings")
        });
    }
    spring(words, METAL_S, || Parameter::usual(1e3, "N m/rad", 50.0, 5e4, "couplings of any kind"))
}

fn shaft(words: &mut Words) -> Result<PartKind, DescribeError> {
    if words.take_name(&["rigid"]).is_some() {
        return Ok(PartKind::Rigid);
    }
    let material = SHEAR_MODULI.iter().find_map(|(names, modulus)| Some((words.take_name(names)?, *modulus)));
    let Some(diameter) = words.take("m") else {
        return Ok(spring(words, METAL_S, || {
            Parameter::usual(3e3, "N m/rad", 100.0, 1e5, "shafts; a size such as 20x300mm gives a better one")
        }));
    };
    let Some(length) = words.take("m") else {
        let problem = "a shaft needs diameter and length, such as shaft 20x300mm steel";
        return Err(DescribeError::text(&words.text, problem));
    };
    let (material, modulus) = material.unwrap_or(("steel".into(), SHEAR_MODULI[0].1));
    let stiffness = sizes::shaft(diameter.si, length.si, &material, modulus);
    Ok(PartKind::Spring { stiffness, relaxation_s: METAL_S })
}

fn screw(words: &mut Words, how: &str) -> Result<PartKind, DescribeError> {
    let Some(lead) = words.take("m") else {
        return Err(DescribeError::text(&words.text, format!("its travel per turn is missing; write {how}")));
    };
    Ok(PartKind::Screw { lead_m: lead.si, stiffness: words.take("N/m") })
}

fn gear(words: &mut Words, name: &str, how: &str) -> Result<Vec<Part>, DescribeError> {
    let teeth = words.take_name(&["teeth", "tooth"]).is_some();
    let (ratio, source) = match (words.pair.take(), words.take("1")) {
        (Some((a, b, _)), None) if teeth => (b / a, format!("given: {a} and {b} teeth")),
        (Some((a, b, _)), None) => (a / b, format!("given: {a}:{b}")),
        (None, Some(size)) => (size.value, "given".to_owned()),
        _ => return Err(DescribeError::text(&words.text, format!("its ratio is missing; write {how}"))),
    };
    if !(ratio.is_finite() && ratio > 0.0) {
        return Err(DescribeError::text(&words.text, "a gear's ratio must be above 0"));
    }
    let part = |name: String, kind: PartKind| Part { name, kind };
    let mut parts = Vec::new();
    if let Some(inertia) = words.take("kg m2") {
        let inertia = Some(Parameter::given(&inertia));
        parts.push(part(
            format!("{name}_in"),
            PartKind::Body(Body { role: BodyRole::Other, inertia, ..Body::default() }),
        ));
    }
    parts.push(part(name.to_owned(), PartKind::Gear { ratio: Parameter::fixed(ratio, "1", source) }));
    if let Some(stiffness) = words.take("N m/rad") {
        let stiffness = Parameter::given(&stiffness);
        parts.push(part(format!("{name}_teeth"), PartKind::Spring { stiffness, relaxation_s: METAL_S }));
    }
    Ok(parts)
}

fn belt(words: &mut Words, name: &str, how: &str) -> Result<Vec<Part>, DescribeError> {
    words.take_name(&["teeth", "radii"]);
    let Some((first, second, unit)) = words.pair.take().filter(|(a, b, _)| *a > 0.0 && *b > 0.0) else {
        return Err(DescribeError::text(&words.text, format!("its two pulleys are missing; write {how}")));
    };
    let pitch = words.take_keyed("pitch");
    let (driven_m, pulleys) = match socam_units::parse(&unit) {
        Some(parsed) if !unit.is_empty() => {
            (second * parsed.factor, format!("radii {first}:{second} {unit}"))
        }
        _ => {
            let pitch_m = pitch.map_or(5e-3, |pitch| pitch.si);
            let said = format!("{first} and {second} teeth of {} mm", rounded(1e3 * pitch_m));
            (second * pitch_m / std::f64::consts::TAU, said)
        }
    };
    let per_width = words.take("N/m");
    let per_width = (per_width.as_ref().map_or(sizes::BELT_N_PER_M, |size| size.si), per_width.is_some());
    let given = words.take("N m/rad");
    let (span, width) = (words.take_keyed("span"), words.take_keyed("width"));
    let stiffness = match (given, &span) {
        (Some(given), _) => Parameter::given(&given),
        (None, Some(span)) => {
            sizes::belt(width.map_or(15e-3, |width| width.si), span.si, driven_m, per_width)
        }
        (None, None) => {
            Parameter::usual(1e3, "N m/rad", 50.0, 2e4, "belts; span and width give a better one")
        }
    };
    let mut parts = Vec::new();
    if first != second {
        let ratio = Parameter::fixed(second / first, "1", format!("given: {pulleys}"));
        parts.push(Part { name: format!("{name}_pulleys"), kind: PartKind::Gear { ratio } });
    }
    parts.push(Part {
        name: name.to_owned(),
        kind: PartKind::Spring { stiffness, relaxation_s: ELASTOMER_S },
    });
    Ok(parts)
}
