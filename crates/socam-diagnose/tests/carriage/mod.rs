//! The carriage of the documentation's examples, recorded with physics of one's own.

use std::error::Error;

use socam_diagnose::document::Diagnosis;
use socam_diagnose::{HeldOut, Options, diagnose};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

/// What is true of a carriage of 12 kg and its sensor.
pub(crate) struct Carriage<'a> {
    /// Force against the motion, N, at a time, s, and a speed, m/s.
    pub(crate) resists: &'a dyn Fn(f64, f64) -> f64,
    pub(crate) delay_s: f64,
    pub(crate) offset_m_per_s: f64,
    pub(crate) noise_m_per_s: f64,
    pub(crate) seed: u64,
}

impl Carriage<'_> {
    /// Diagnoses three recordings with the documentation's model, which has viscous friction alone.
    pub(crate) fn diagnosed(&self) -> Diagnosis {
        let recordings: Vec<Dataset> = (0..3).map(|number| self.recorded(number)).collect();
        diagnose(&model().unwrap(), &recordings, HeldOut::none(), &Options::default()).unwrap().diagnosis
    }

    /// 2.4 s by Euler steps of 50 us, sampled every 2 ms.
    fn recorded(&self, number: u64) -> Dataset {
        let (mut speed, mut random) = (0.0_f64, self.seed + number);
        let (mut time_s, mut forces, mut course, mut speeds) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let pace = 1.3 * number as f64;
        let force = |t: f64| 30.0 * ((7.0 + pace) * t).sin() + 20.0 * ((19.0 - pace) * t).sin();
        let late = (self.delay_s / 5e-5).round() as usize;
        for k in 0..1200 {
            let t = 0.002 * f64::from(k);
            // The sum of four uniform numbers.
            let mut scatter = 0.0;
            for _ in 0..4 {
                random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                scatter += (random >> 11) as f64 / 2f64.powi(53) - 0.5;
            }
            time_s.push(t);
            forces.push(force(t));
            course.push(speed);
            let delayed = course[(course.len() - 1).saturating_sub(late)];
            speeds.push(delayed + self.offset_m_per_s + self.noise_m_per_s * 3f64.sqrt() * scatter);
            for part in 0..40 {
                let now = t + 5e-5 * f64::from(part);
                speed += 5e-5 * (force(now) - (self.resists)(now, speed)) / 12.0;
                course.push(speed);
            }
        }
        let channels = vec![Channel::new("force", Unit::N), Channel::new("speed", Unit::MPerS)];
        Dataset::from_columns(format!("run {number}"), channels, time_s, vec![forces, speeds]).unwrap()
    }
}

fn model() -> Result<Model, Box<dyn Error>> {
    let (model, _) = include!("../doc/axis.rs");
    Ok(model)
}
