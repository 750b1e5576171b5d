//! Laws for which simulators have elements of their own, recognised by their formulas, so that no effect is named here.

use socam_model::{EffectUse, Site, effects::Acts};

use crate::formula::Formula;

/// Form of an effect in other simulators. Numbers are indices of parameters of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Dry friction of constant size.
    Dry { torque: usize },
    /// Dry friction of constant size behind a small deflection.
    Presliding { torque: usize },
    /// Dry friction that is `still` at rest and falls to `torque`.
    Falling { torque: usize, still: usize },
    /// Drag in proportion to the square of speed.
    Quadratic { coefficient: usize },
    /// A constant torque, against positive motion.
    Against { torque: usize },
    /// A constant addition to a reading.
    Offset { offset: usize },
    /// The weight of an eccentric load.
    Unbalance { torque: usize, phase: usize },
    /// A stiffness that grows with the square of twist.
    Cubic { cubic: usize },
    /// Play between teeth.
    Play { gap: usize },
}

/// Makes a shape of the parameters of a template.
type Make = fn(&[usize]) -> Shape;

/// Templates: capital letters stand for parameters, in the order of the alphabet.
const TEMPLATES: [(&str, Make); 7] = [
    ("-A*tanh(speed/B)", |p| Shape::Dry { torque: p[0] }),
    ("-(A + (B - A)*exp(-(speed/C)^2))*tanh(speed/D)", |p| Shape::Falling { torque: p[0], still: p[1] }),
    ("-A*speed*abs(speed)", |p| Shape::Quadratic { coefficient: p[0] }),
    ("-A", |p| Shape::Against { torque: p[0] }),
    ("A", |p| Shape::Offset { offset: p[0] }),
    ("-A*sin(angle + B)", |p| Shape::Unbalance { torque: p[0], phase: p[1] }),
    ("stiffness*A*twist^3", |p| Shape::Cubic { cubic: p[0] }),
];

impl Shape {
    /// `None` where no simulator has an element for the effect.
    pub(crate) fn of(used: &EffectUse) -> Option<Self> {
        let laws = used.effect.laws();
        let index = |name: &str| {
            let own = used.effect.parameters.iter().position(|own| own.name == name)?;
            used.parameters.get(own).copied()
        };
        match laws {
            [law] if matches!(used.at, Site::Gear { .. }) && law.acts == Acts::Torque => {
                index("gap").map(|gap| Self::Play { gap })
            }
            [law] => {
                let formula = Formula::parse(law.formula).ok()?;
                TEMPLATES.iter().find_map(|(template, shape)| {
                    let mut found = [None; 4];
                    if !fits(&Formula::parse(template).ok()?, &formula, &mut found, &index) {
                        return None;
                    }
                    Some(shape(&found.into_iter().flatten().collect::<Vec<_>>()))
                })
            }
            [state, law] if state.acts == Acts::State => {
                let mut found = [None; 4];
                let (torque, rate) = (Formula::parse(law.formula).ok()?, Formula::parse(state.formula).ok()?);
                let dahl = Formula::parse("speed - speed*tanh(speed/C)*state/B").ok()?;
                let fits = fits(&Formula::parse("-A*state/B").ok()?, &torque, &mut found, &index)
                    && fits(&dahl, &rate, &mut found, &index);
                found[0].filter(|_| fits).map(|torque| Self::Presliding { torque })
            }
            _ => None,
        }
    }
}

/// Whether a formula fits a template, whose capital letters are then bound to parameters.
fn fits(
    template: &Formula,
    formula: &Formula,
    found: &mut [Option<usize>; 4],
    index: &dyn Fn(&str) -> Option<usize>,
) -> bool {
    match (template, formula) {
        (Formula::Name(letter), Formula::Name(name)) => {
            let place = match letter.as_bytes() {
                [letter @ b'A'..=b'D'] => usize::from(letter - b'A'),
                _ => return letter == name,
            };
            let Some(parameter) = index(name) else { return false };
            *found[place].get_or_insert(parameter) == parameter
        }
        (Formula::Number(a), Formula::Number(b)) => a == b,
        (Formula::Negative(a), Formula::Negative(b)) => fits(a, b, found, index),
        (Formula::Binary(p, a, b), Formula::Binary(q, c, d)) => {
            p == q && fits(a, c, found, index) && fits(b, d, found, index)
        }
        (Formula::Call(f, a), Formula::Call(g, b)) => {
            f == g && a.len() == b.len() && a.iter().zip(b).all(|(a, b)| fits(a, b, found, index))
        }
        _ => false,
    }
}
