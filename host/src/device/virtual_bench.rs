//! The virtual bench as the command line describes it.

use socam_recording::Calibration;
use socam_sim::{Concealed, Override, Setup, Truth, calibration_for};

use crate::duration::seconds;
use crate::model_file;
use crate::output::WrongArguments;

/// What the virtual bench really is
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct BenchArgs {
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = model_file::HELP)]
    pub(crate) model: String,
    /// Let a parameter of the virtual bench differ from the model's: NAME=VALUE in SI, as in k1=71; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<Override>,
    /// Conceal physics in the virtual bench that the model does not name, in SI, as in coulomb_friction@load_bearing:torque=0.4 or
    /// sensor_gain@torque_out:gain=0.98; may be repeated
    #[arg(long, value_name = "EFFECT@PLACE:name=value,..")]
    pub(crate) hide: Vec<Concealed>,
    /// Let --set and --hide begin in mid-run, so long after the drive was enabled, as in 20s [default: from the start]
    #[arg(long, value_name = "TIME", value_parser = seconds)]
    pub(crate) begin_at: Option<f64>,
    /// Another number, other noise of the sensors
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Take all noise from the sensors
    #[arg(long)]
    pub(crate) no_noise: bool,
}

impl BenchArgs {
    /// The true drivetrain.
    pub(crate) fn truth(&self) -> anyhow::Result<Truth> {
        let model = model_file::load(&self.model)?;
        Truth::new(&model, &self.set, &self.hide).map_err(|error| WrongArguments(error.to_string()).into())
    }

    /// The whole bench, with the sensors of `calibration`, or by default those for the model.
    pub(crate) fn setup(&self, calibration: Option<Calibration>) -> anyhow::Result<Setup> {
        let truth = self.truth()?;
        let calibration = calibration.unwrap_or_else(|| calibration_for(&truth.model));
        let mut setup = Setup::new(truth, calibration, self.seed);
        setup.noisy = !self.no_noise;
        if let Some(begin_s) = self.begin_at {
            if !self.describes_a_change() {
                return Err(
                    WrongArguments("--begin-at needs a --set or --hide that begins then".into()).into()
                );
            }
            setup.before = Some((Truth::new(&model_file::load(&self.model)?, &[], &[])?, begin_s));
        }
        Ok(setup)
    }

    /// Whether anything but the model was given: that makes sense for a virtual bench only.
    pub(crate) fn describes_a_bench(&self) -> bool {
        self.describes_a_change() || self.no_noise || self.begin_at.is_some()
    }

    fn describes_a_change(&self) -> bool {
        !self.set.is_empty() || !self.hide.is_empty()
    }
}
