//! Packs a model: `cargo run --release -p socam-fmu --example pack -- two-mass two-mass.fmu`. The model is a file or an embedded name.

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [model, target] = arguments.as_slice() else {
        return Err("expected a model and the .fmu to write".into());
    };
    let text = match socam_model::Model::builtin(model) {
        Some(known) => known.text,
        None => std::fs::read_to_string(model)?,
    };
    // Examples lie one folder below the library.
    let program = std::env::current_exe()?;
    let folder = program.parent().and_then(Path::parent).ok_or("no folder")?;
    socam_fmu::write_fmu(&text, &folder.join(socam_fmu::LIBRARY), Path::new(target))?;
    Ok(())
}
