//! Runs a profile on the bench and records it in memory.

use socam_core::{Board, Profile, Request, Ring, Sample, State};
use socam_recording::{Calibration, Channel, Dataset};

use crate::SimError;
use crate::setup::{NO_TACHOMETER, Setup};
use crate::wiring::Wiring;

/// Size of the ring between board and recording, which is emptied at every tick.
const RING_SAMPLES: usize = 4;

impl Setup {
    /// Runs a profile on a board at this bench and returns the recording that a host would make, without wire and file: the columns
    /// of the calibration, from the first sample of the profile to the one at which the command is 0 again.
    ///
    /// # Errors
    /// [`SimError::Refused`] where the board refuses calibration or profile, [`SimError::Fault`] where it ends the run,
    /// as it does when a sensor reaches its limit; otherwise where the bench cannot be built or simulated.
    pub fn record(
        &self,
        name: impl Into<String>,
        profile: &Profile,
        period_us: u32,
    ) -> Result<Dataset, SimError> {
        let plants = self.plants()?;
        let mut ring = Ring::<i32, RING_SAMPLES>::new();
        let (producer, mut samples) = ring.split();
        let mut board = Board::new(Wiring::start(self, &plants)?, producer);
        // The first tick after power-on is not part of the run.
        board.tick();
        board.handle(Request::Configure(self.calibration.config(period_us)?))?;
        for request in [Request::Load(*profile), Request::Arm, Request::Stream(true), Request::Run] {
            board.handle(request)?;
        }
        let mut rows = Rows::of(self, period_us);
        loop {
            board.ports_mut().now_us += u64::from(period_us);
            board.handle(Request::Heartbeat)?;
            board.tick();
            board.ports_mut().failed()?;
            let Some(sample) = samples.pop() else { continue };
            rows.take(&sample);
            if !sample.flags.state().is_some_and(State::is_live) {
                break;
            }
        }
        if let Some(fault) = board.status().fault {
            let names: Vec<&str> =
                self.calibration.channels.iter().map(|c| c.channel.name.as_str()).collect();
            let time_s = rows.time_s.last().copied().unwrap_or(0.0);
            return Err(SimError::Fault { time_s, reason: fault.with_names(&names).to_string() });
        }
        let Rows { channels, time_s, columns, .. } = rows;
        Ok(Dataset::from_columns(name, channels, time_s, columns)?)
    }
}

/// The rows recorded so far.
struct Rows<'s> {
    calibration: &'s Calibration,
    period_us: u32,
    channels: Vec<Channel>,
    /// Whether each value is recorded, in the calibration's order, the command first.
    recorded: Vec<bool>,
    first_tick: Option<u32>,
    time_s: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl<'s> Rows<'s> {
    fn of(setup: &'s Setup, period_us: u32) -> Self {
        let all = setup.calibration.recorded_channels();
        let recorded: Vec<bool> = all.iter().map(|channel| channel.name != NO_TACHOMETER).collect();
        let channels: Vec<Channel> = all
            .into_iter()
            .zip(&recorded)
            .filter_map(|(channel, recorded)| recorded.then_some(channel))
            .collect();
        let columns = vec![Vec::new(); channels.len()];
        let calibration = &setup.calibration;
        Self { calibration, period_us, channels, recorded, first_tick: None, time_s: Vec::new(), columns }
    }

    fn take(&mut self, sample: &Sample) {
        let first = *self.first_tick.get_or_insert(sample.tick);
        let passed_us = u64::from(sample.tick.wrapping_sub(first)) * u64::from(self.period_us);
        // The division rounds in the same way as a log's reader.
        self.time_s.push(passed_us as f64 / 1e6);
        let values = self.calibration.values(sample.output_count, &sample.counts);
        let recorded = values.zip(&self.recorded).filter_map(|(value, recorded)| recorded.then_some(value));
        self.columns.iter_mut().zip(recorded).for_each(|(column, value)| column.push(value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Truth, calibration_for};
    use socam_model::Model;
    use socam_recording::ProfileFile;

    fn setup(model: &str, seed: u64) -> Setup {
        let truth = Truth::new(&Model::builtin(model).unwrap(), &[], &[]).unwrap();
        let calibration = calibration_for(&truth.model);
        Setup::new(truth, calibration, seed)
    }

    fn profile(name: &str, duration_s: f64) -> Profile {
        ProfileFile { duration_s, ..ProfileFile::open(name).unwrap() }.profile(1000).unwrap()
    }

    fn column(data: &Dataset, name: &str) -> Vec<f64> {
        data.load(&[name]).unwrap().columns[0].values().to_vec()
    }

    #[test]
    fn a_run_begins_and_ends_at_rest_and_is_repeatable() {
        let record =
            |seed| setup("speed-o-cam", seed).record("run", &profile("multisine", 2.0), 1000).unwrap();
        let data = record(1);
        // The fade-out is included.
        assert!((2990..3010).contains(&data.rows()), "{}", data.rows());
        assert_eq!(data.segments().len(), 1);
        let command = column(&data, "command_V");
        assert!(command[0].abs() < 0.01 && command.last() == Some(&0.0));
        assert!(column(&data, "motor_speed_rad_s")[1500] > 50.0);
        assert_eq!(column(&data, "torque_out_Nm"), column(&record(1), "torque_out_Nm"));
        assert_ne!(column(&data, "torque_out_Nm"), column(&record(2), "torque_out_Nm"));
        assert_eq!(
            setup("emps", 1).record("run", &profile("triangle", 1.0), 1000).unwrap().channels().len(),
            3
        );
    }

    #[test]
    fn noise_is_of_the_size_that_was_asked_for_and_of_that_channel_only() {
        let run = |noise_std: &[(&str, f64)]| {
            let noise_std = noise_std.iter().map(|(name, std)| ((*name).to_owned(), *std)).collect();
            Setup { noise_std, ..setup("speed-o-cam", 1) }.record("run", &profile("steps", 2.0), 1000)
        };
        let usual = run(&[]).unwrap();
        let inactive = Setup { noisy: false, ..setup("speed-o-cam", 1) };
        let inactive =
            column(&inactive.record("run", &profile("steps", 2.0), 1000).unwrap(), "motor_speed_rad_s");
        let noise = |data: &Dataset| {
            let noisy = column(data, "motor_speed_rad_s");
            let squares: f64 = noisy.iter().zip(&inactive).map(|(a, b)| (a - b).powi(2)).sum();
            (squares / noisy.len() as f64).sqrt()
        };
        let loud = run(&[("motor_speed", 0.1)]).unwrap();
        assert!((noise(&usual) / 0.02 - 1.0).abs() < 0.05, "{}", noise(&usual));
        assert!((noise(&loud) / 0.1 - 1.0).abs() < 0.05, "{}", noise(&loud));
        assert_eq!(noise(&run(&[("motor_speed", 0.0)]).unwrap()), 0.0);
        assert_eq!(column(&usual, "torque_in_Nm"), column(&loud, "torque_in_Nm"));
        let problem = |name: &str, std| run(&[(name, std)]).unwrap_err().to_string();
        assert!(problem("motor", 0.1).contains("the bench has motor_speed, output_speed"));
        assert!(problem("motor_speed", -1.0).contains("must be 0 or more"));
    }

    #[test]
    fn a_run_that_the_board_ends_is_no_recording() {
        let mut setup = setup("speed-o-cam", 1);
        setup.calibration.channels[0].limit = Some(50.0);
        let problem = setup.record("run", &profile("multisine", 2.0), 1000).unwrap_err().to_string();
        assert!(
            problem.starts_with("the board ended the run at ") && problem.contains("motor_speed"),
            "{problem}"
        );
    }
}
