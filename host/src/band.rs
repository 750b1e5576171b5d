//! `--band LOW..HIGH`: the fit to recordings that were held out, counted within a band of frequencies.

use socam_identify::{Band, BandFit, BandFits};
use socam_recording::Dataset;

use crate::output::WrongArguments;
use crate::table;

/// `LOW..HIGH` in Hz.
pub(crate) fn parse(text: &str) -> Result<Band, String> {
    let expected = || "expected LOW..HIGH in Hz, as in 2..80".to_owned();
    let (low, high) = text.split_once("..").ok_or_else(expected)?;
    let number = |text: &str| text.trim().parse::<f64>().map_err(|_| expected());
    Band::new(number(low)?, number(high)?).map_err(|error| error.to_string())
}

/// Whether all recordings show the band.
pub(crate) fn check(band: Band, datasets: &[Dataset]) -> Result<(), WrongArguments> {
    datasets.iter().try_for_each(|dataset| band.check(dataset)).map_err(|e| WrongArguments(e.to_string()))
}

/// Fits within a band as a table.
pub(crate) fn table(fits: &BandFits) -> String {
    let ends = format!("  within {} to {} Hz", fits.band.low_hz(), fits.band.high_hz());
    let head = vec![ends, "residual rms".into(), "fit".into()];
    let row = |(name, fit): &(String, Option<BandFit>)| match fit {
        Some(fit) => {
            vec![format!("  {name}"), table::number(fit.rms), format!("{:.1} %", fit.fit_percent)]
        }
        None => vec![format!("  {name}"), "nothing there".into(), "-".into()],
    };
    let rows: Vec<_> = std::iter::once(head).chain(fits.channels.iter().map(row)).collect();
    table::align(&rows, &[false, true, true])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_is_two_numbers_in_order() {
        let band = parse("2..80.5").unwrap();
        assert_eq!((band.low_hz(), band.high_hz()), (2.0, 80.5));
        for text in ["", "2", "2-80", "2..x", "..80", "80..2", "5..5", "-1..5"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
