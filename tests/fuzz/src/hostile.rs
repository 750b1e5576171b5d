//! Inputs that are hostile by their size or nesting. Each is parsed once, and not mutated.

/// Nesting, columns, digits: more than any honest file has.
const DEEP: usize = 50_000;
const WIDE: usize = 1_000_000;
/// Head of a model.
const MODEL: &str = "schema = \"socam.model/1\"\nname = \"chain\"\nmotion = \"rotation\"\n";

/// Hostile inputs of the parsers of files with this extension.
pub(crate) fn inputs(extension: &str) -> Vec<Vec<u8>> {
    let texts = match extension {
        "csv" => tables(),
        "m" => {
            let row = "0 0 0 0 0\n";
            let log = |rows: &str| format!("samprate=0.001\ndata=[\n{rows}];\n");
            vec![
                log(&"1 ".repeat(WIDE)),
                log(&row.repeat(WIDE / 10)),
                log(&"1".repeat(WIDE)),
                "samprate=1\n".repeat(WIDE / 10),
            ]
        }
        "toml" => settings(),
        "dbc" => databases(),
        "json" => {
            vec!["[".repeat(WIDE), "{\"a\":".repeat(WIDE), format!("{{\"schema\":{}}}", "9".repeat(WIDE))]
        }
        _ => Vec::new(),
    };
    let mut all: Vec<Vec<u8>> = texts.into_iter().map(String::into_bytes).collect();
    all.extend([vec![0; WIDE], vec![0xff; WIDE]]);
    all
}

fn databases() -> Vec<String> {
    let signals = |mark: &dyn Fn(usize) -> String| -> String {
        let signal = |k: usize| format!(" SG_ s{k} {}: 0|8@1+ (1,0) [0|0] \"V\" B\n", mark(k));
        "VERSION \"\"\nBO_ 257 D: 8 B\n".to_owned() + &(0..DEEP).map(signal).collect::<String>()
    };
    let by_values = signals(&|k| if k == 0 { "M ".into() } else { format!("m{k} ") });
    // Each is chosen by the one before it.
    let chain = signals(&|k| if k == 0 { "M ".into() } else { "m1M ".into() });
    let links: String = (1..DEEP).map(|k| format!("SG_MUL_VAL_ 257 s{k} s{} 0-255;\n", k - 1)).collect();
    vec![
        signals(&|_| String::new()),
        by_values,
        chain + &links,
        "BO_ ".repeat(WIDE / 4),
        format!("CM_ \"{}", "\\\"".repeat(WIDE / 2)),
    ]
}

fn tables() -> Vec<String> {
    let header = |first: &str, columns: usize| {
        (0..columns).fold(first.to_owned(), |all, k| all + &format!(",c{k}_Nm"))
    };
    let mut all = Vec::new();
    for first in ["t_s", "point_1", "c_V"] {
        all.push(header(first, WIDE));
        all.push(format!("{}\n0{}\n1{}\n", header(first, 9_999), ",1".repeat(9_999), ",".repeat(9_999)));
        all.push(format!("{first},a_Nm,a_V\n0,{},1\n", "1".repeat(WIDE)));
        all.push(format!("{first},a_Nm,a_V\n0,\"{}", "1,\n".repeat(WIDE / 3)));
        all.push(format!("{first},a_Nm,a_V\n{}", "\n".repeat(WIDE)));
        all.push(format!("{first},{}_Nm,a_V\n0,1,1\n1,2,1\n", "a".repeat(WIDE)));
    }
    all
}

fn settings() -> Vec<String> {
    let parameters: String =
        (0..60_000).map(|k| format!("p{k} = {{ value = 1, unit = \"kg m2\" }}\n")).collect();
    vec![
        "a = ".to_owned() + &"[".repeat(DEEP),
        "a = ".to_owned() + &"{ a = ".repeat(DEEP),
        format!("a{} = 1", ".a".repeat(DEEP)),
        format!("[a{}]\n", ".a".repeat(DEEP)),
        format!("a = {{ a{} = 1 }}", ".a".repeat(DEEP)),
        format!("a = {}", "1".repeat(WIDE)),
        format!("{} = 1", "a".repeat(WIDE)),
        format!("name = \"{}\"", "a".repeat(WIDE)),
        "[[nodes]]\n".repeat(WIDE / 10),
        format!("{MODEL}[parameters]\n{parameters}"),
        chain(100),
        chain(1000),
    ]
}

/// As many nodes, each on a spring to the one before.
fn chain(nodes: usize) -> String {
    let mut text = format!(
        "{MODEL}[parameters]\nJ = {{ value = 1, unit = \"kg m2\" }}\nk = {{ value = 1, unit = \"N m/rad\" }}\n"
    );
    for k in 0..nodes {
        text += &format!("[[nodes]]\nname = \"n{k}\"\ninertia = \"J\"\n");
    }
    for k in 1..nodes {
        text += &format!(
            "[[springs]]\nname = \"s{k}\"\nfrom = \"n{}\"\nto = \"n{k}\"\nstiffness = \"k\"\n",
            k - 1
        );
    }
    text + "[channels.torque]\nrole = \"input\"\nquantity = \"torque\"\nat = \"n0\"\n"
        + "[channels.speed]\nrole = \"output\"\nquantity = \"speed\"\nat = \"n1\"\n"
}
