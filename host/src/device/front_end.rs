//! A board's converters and the calibration that reads their counts.

use anyhow::{Context, bail};
use socam_core::scaling::Converter;
use socam_recording::Calibration;
use socam_wire::{BoardKind, FrontEnd};

/// The calibration of the default bench for a board, on its own converters, as text and read.
pub(crate) fn default_calibration(front_end: &FrontEnd) -> anyhow::Result<(String, Calibration)> {
    if front_end.kind == BoardKind::Gearmotor {
        let text = Calibration::gearmotor_text();
        return Ok((text.to_owned(), Calibration::parse(text)?));
    }
    let text = Calibration::default_text();
    let (inputs, outputs) = text.split_once("[output]").context("the default calibration has no [output]")?;
    let with =
        |part: &str, uv| part.replacen("full_scale_V = 10\n", &format!("full_scale_V = {}\n", volts(uv)), 1);
    let text = format!(
        "{}[output]{}",
        with(inputs, front_end.input_full_scale_uv),
        with(outputs, front_end.output_full_scale_uv)
    );
    let calibration = Calibration::parse(&text)?;
    Ok((text, calibration))
}

/// Refuses a calibration for other converters, which would read every count wrong by a few per cent.
pub(crate) fn check(calibration: &Calibration, front_end: &FrontEnd) -> anyhow::Result<()> {
    if calibration.board != front_end.kind {
        bail!(
            "the calibration is for a board of kind `{}`, this board is of kind `{}`: give another --calibration, or none for the default one",
            calibration.board,
            front_end.kind
        );
    }
    for (table, converter, uv) in [
        ("input", calibration.input, front_end.input_full_scale_uv),
        ("output", calibration.output, front_end.output_full_scale_uv),
    ] {
        if !fits(&converter, uv) {
            bail!(
                "the calibration says [{table}] full_scale_V = {} at {} bits, but the board's converter has {} V at 16 bits",
                converter.full_scale_v,
                converter.bits,
                volts(uv)
            );
        }
    }
    Ok(())
}

/// Full scale is the voltage at 2^15 counts, for a converter with any number of bits.
fn fits(converter: &Converter, full_scale_uv: u32) -> bool {
    (converter.volts_per_count() * 32_768.0 / volts(full_scale_uv) - 1.0).abs() < 1e-6
}

fn volts(uv: u32) -> f64 {
    f64::from(uv) / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    const PICO: FrontEnd = FrontEnd {
        kind: BoardKind::Analog,
        input_full_scale_uv: 10_240_000,
        output_full_scale_uv: 10_000_000,
        channel_step_ns: 3500,
    };

    #[test]
    fn the_default_calibration_takes_the_boards_converters_and_another_one_is_refused() {
        let (text, calibration) = default_calibration(&PICO).unwrap();
        assert!(text.contains("full_scale_V = 10.24\n") && text.contains("full_scale_V = 10\n"), "{text}");
        assert_eq!(calibration.input.full_scale_v, 10.24);
        assert_eq!(calibration.output, Converter::DEFAULT);
        check(&calibration, &PICO).unwrap();
        let sentence = check(&Calibration::default(), &PICO).unwrap_err().to_string();
        assert!(
            sentence.contains("[input] full_scale_V = 10 at 16 bits") && sentence.contains("10.24 V"),
            "{sentence}"
        );
        let coarse = Calibration { output: Converter { bits: 12, ..Converter::DEFAULT }, ..calibration };
        assert!(check(&coarse, &PICO).is_err());
        check(&coarse, &FrontEnd { output_full_scale_uv: 160_000_000, ..PICO }).unwrap();
    }
}
