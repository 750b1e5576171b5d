//! Prints a model file as a file of a target: `export MODEL TARGET`.
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let text = std::fs::read_to_string(&a[1]).unwrap();
    let model = socam_model::Model::parse(&text).unwrap();
    let t = socam_export::Target::ALL.into_iter().find(|t| t.name().eq_ignore_ascii_case(&a[2])).unwrap();
    let e = socam_export::export(
        &model,
        &socam_export::Provenance::new(&a[1], &text),
        t,
        a.get(3).map_or(&model.name, |n| n),
    )
    .unwrap();
    print!("{}", e.text);
    for l in e.left_out {
        eprintln!("left out: {l}");
    }
}
