//! A virtual fleet: sister machines with different parameters, their recordings at several dates, and faults of a few of them.

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal, Uniform};
use socam_core::Profile;
use socam_model::{Model, effects};
use socam_recording::Dataset;

use crate::{Concealed, Override, Setup, SimError, Truth, calibration_for};

/// Factors between which the size of a fault is drawn, evenly in the logarithm.
const SIZES: (f64, f64) = (0.5, 2.0);

/// Distribution from which a fleet is drawn.
#[derive(Debug, Clone)]
pub struct FleetPlan {
    /// The written model; its parameters are those of a typical machine.
    pub model: Model,
    /// Number of machines.
    pub machines: usize,
    /// Recordings of each machine.
    pub dates: usize,
    /// Relative standard deviation of each free parameter between machines.
    pub spread: f64,
    /// Faults: each faulty machine has one of them, larger or smaller by up to a factor of two, in all its recordings.
    pub faults: Vec<Concealed>,
    /// Share of the machines that have a fault.
    pub faulty_share: f64,
    /// Parameters that wear, and their change from the first date to the last, as a share of the value.
    pub wear: Vec<Override>,
    /// Share of the machines that wear; none of these is faulty.
    pub worn_share: f64,
    /// Seed of all random draws.
    pub seed: u64,
}

/// A machine of a fleet, with its truth.
#[derive(Debug, Clone)]
pub struct FleetMachine {
    /// Serial number.
    pub serial: String,
    /// Parameters of the machine.
    pub values: Vec<Override>,
    /// Fault of the machine.
    pub fault: Option<Concealed>,
    /// Wear of the machine: a parameter, and its change from the first date to the last as a share of the value.
    pub wear: Option<Override>,
    seed: u64,
}

/// A fleet.
#[derive(Debug, Clone)]
pub struct VirtualFleet {
    /// Machines of the fleet.
    pub machines: Vec<FleetMachine>,
    model: Model,
    dates: usize,
}

impl VirtualFleet {
    /// Draws a fleet. The stated shares of faulty and of worn machines are met exactly, up to rounding.
    #[must_use]
    pub fn draw(plan: &FleetPlan) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
        let count = |share: f64| (share * plan.machines as f64).round() as usize;
        let mut order: Vec<usize> = (0..plan.machines).collect();
        for last in (1..order.len()).rev() {
            order.swap(last, below(last + 1, &mut random));
        }
        let (faulty, worn) = (count(plan.faulty_share), count(plan.worn_share));
        let mut machines: Vec<FleetMachine> =
            (0..plan.machines).map(|number| sister(plan, number, &mut random)).collect();
        // In fleets with few faulty machines, the faults depend on the seed.
        let turn = (plan.seed % 1_000_000) as usize;
        for (rank, number) in order.into_iter().enumerate().take(faulty + worn) {
            let machine = &mut machines[number];
            if rank < faulty && !plan.faults.is_empty() {
                machine.fault = Some(sized(&plan.faults[(turn + rank) % plan.faults.len()], &mut random));
            } else if rank >= faulty && !plan.wear.is_empty() {
                machine.wear = Some(plan.wear[(turn + rank) % plan.wear.len()].clone());
            }
        }
        Self { machines, model: plan.model.clone(), dates: plan.dates }
    }

    /// A recording of a machine at one of its dates, counted from 0.
    ///
    /// # Errors
    /// Where the fault does not fit the model, or the run ends early.
    pub fn record(
        &self,
        machine: usize,
        date: usize,
        profile: &Profile,
        period_us: u32,
    ) -> Result<Dataset, SimError> {
        let own = &self.machines[machine];
        let mut values = own.values.clone();
        if let Some(wear) = &own.wear {
            let passed = date as f64 / self.dates.saturating_sub(1).max(1) as f64;
            let worn = values.iter_mut().filter(|value| value.name == wear.name);
            worn.for_each(|value| value.value *= 1.0 + passed * wear.value);
        }
        let faults: Vec<Concealed> = own.fault.iter().cloned().collect();
        let truth = Truth::new(&self.model, &values, &faults)?;
        let seed = own.seed.wrapping_add(date as u64);
        let setup = Setup::new(truth, calibration_for(&self.model), seed);
        setup.record(format!("{} {date}", own.serial), profile, period_us)
    }
}

fn sister(plan: &FleetPlan, number: usize, random: &mut ChaCha8Rng) -> FleetMachine {
    let free = plan.model.parameters.iter().filter(|parameter| !parameter.fixed);
    let values = free.map(|parameter| {
        let draw: f64 = StandardNormal.sample(random);
        Override { name: parameter.name.clone(), value: parameter.value * (plan.spread * draw).exp() }
    });
    let values = values.collect();
    let seed = plan.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1000 * number as u64 + 1);
    FleetMachine { serial: format!("SN{number:05}"), values, fault: None, wear: None, seed }
}

/// A fault of another size: the distance of its amplitude from the null value is multiplied by a random factor.
fn sized(fault: &Concealed, random: &mut ChaCha8Rng) -> Concealed {
    let mut fault = fault.clone();
    let Some(effect) = effects::find(&fault.effect) else { return fault };
    let [least, most] = [SIZES.0, SIZES.1].map(f64::ln);
    let factor = Uniform::new(least, most).map_or(1.0, |uniform| uniform.sample(random).exp());
    let null = Some(effect.amplitude.null).filter(|null| null.is_finite()).unwrap_or(0.0);
    for parameter in &mut fault.parameters {
        if effect.amplitude.parameters.contains(&parameter.name.as_str()) {
            parameter.value = null + factor * (parameter.value - null);
        }
    }
    fault
}

/// A whole number below a limit.
fn below(limit: usize, random: &mut ChaCha8Rng) -> usize {
    Uniform::new(0, limit).map_or(0, |uniform| uniform.sample(random))
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::ProfileFile;

    #[test]
    fn a_fleet_has_its_shares_of_faults_and_wear_and_the_same_seed_gives_the_same_recording() {
        let plan = FleetPlan {
            model: Model::builtin("two-mass").unwrap(),
            machines: 100,
            dates: 3,
            spread: 0.05,
            faults: vec!["coulomb_friction@load_bearing:torque=0.1".parse().unwrap()],
            faulty_share: 0.02,
            wear: vec!["load_damping=0.5".parse().unwrap()],
            worn_share: 0.05,
            seed: 4,
        };
        let fleet = VirtualFleet::draw(&plan);
        let faulty = fleet.machines.iter().filter(|machine| machine.fault.is_some());
        let sizes: Vec<f64> = faulty.map(|m| m.fault.as_ref().unwrap().parameters[0].value).collect();
        assert!(sizes.len() == 2 && sizes.iter().all(|size| (0.05..=0.2).contains(size)), "{sizes:?}");
        let worn: Vec<usize> = (0..100).filter(|k| fleet.machines[*k].wear.is_some()).collect();
        assert_eq!(worn.len(), 5);
        assert!(fleet.machines.iter().all(|machine| machine.fault.is_none() || machine.wear.is_none()));
        let profile =
            ProfileFile { duration_s: 1.0, ..ProfileFile::open("multisine").unwrap() }.profile(1000).unwrap();
        let speed = |date| {
            let data = fleet.record(worn[0], date, &profile, 1000).unwrap();
            data.load(&["load_speed"]).unwrap().columns[0].values().to_vec()
        };
        assert_eq!(speed(1), speed(1));
        // At the last date the damping is 1.5 times the first one, so the speed is lower.
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        assert!(mean(&speed(2)) < 0.95 * mean(&speed(0)), "{} {}", mean(&speed(2)), mean(&speed(0)));
    }
}
