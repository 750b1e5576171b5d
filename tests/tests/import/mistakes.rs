//! Typical mistakes in a mapping, and the sentence that each of them gets.

use socam_tests::{path, run};

const GOOD: &str =
    "[[clocks]]\ntime = \"Zeit\"\nunit = \"ms\"\n\n[channels.speed]\nsignal = \"n_Motor\"\nunit = \"rpm\"\n";

/// Each entry: the text that is replaced in a good mapping, its replacement, and the message, in which `LOG` and `MAP` stand for
/// the files.
const MISTAKES: [(&str, &str, &str); 22] = [
    (
        "unit = \"rpm\"",
        "unit = \"?\"",
        "`MAP`, line 7: `unit` of `speed` is not known yet; write the unit of the numbers in the file, such as \"rpm\" or \"N m\"",
    ),
    ("unit = \"rpm\"", "", "`MAP`, line 5: `unit` is missing; expected a text in quotes"),
    (
        "unit = \"rpm\"",
        "unit = \"furlong\"",
        "`MAP`, line 7: `unit` of `speed` is \"furlong\", which is no unit known here; write one such as rpm, deg/s, N m, mm, A or 1, and what a number stands for with `scale` and `to`",
    ),
    ("unit = \"rpm\"", "unit = rpm", "`MAP`, line 7: string values must be quoted, expected literal string"),
    ("unit = \"rpm\"", "units = \"rpm\"", "`MAP`, line 7: `units` is not a key here; expected one of"),
    (
        "unit = \"rpm\"",
        "unit = \"counts\"",
        "`MAP`, line 7: `speed` is in counts; say `counts_per_turn` or `counts_per_m`",
    ),
    (
        "unit = \"rpm\"",
        "unit = \"rpm\"\ncounts_per_turn = 4096",
        "`MAP`, line 8: `counts_per_turn` is for a signal whose `unit` is \"counts\"",
    ),
    (
        "unit = \"rpm\"",
        "unit = \"A\"\nscale = 0.055\nto = \"Furlong\"",
        "`MAP`, line 9: `to` is \"Furlong\", which is no unit known here",
    ),
    (
        "unit = \"rpm\"",
        "unit = \"rpm\"\nwrap = 0",
        "`MAP`, line 8: `wrap` is 0; expected a number from 0.000000001 to 1000000000000000000",
    ),
    (
        "unit = \"rpm\"",
        "unit = \"rpm\"\nbetween = \"cubic\"",
        "`MAP`, line 8: `between` is \"cubic\"; expected \"linear\" or \"hold\" or \"missing\"",
    ),
    ("\"n_Motor\"", "\"n_motor\"", "line 5: `LOG` holds no signal `n_motor` of numbers; is it `n_Motor`?"),
    (
        "\"n_Motor\"",
        "\"Torque\"",
        "line 5: `LOG` holds no signal `Torque` of numbers; it holds `Zeit`, `n_Motor`, `M`",
    ),
    (
        "\"Zeit\"",
        "\"time\"",
        "line 1: `LOG` holds no signal `time` of numbers; it holds `Zeit`, `n_Motor`, `M`",
    ),
    (
        "unit = \"ms\"",
        "unit = \"rpm\"",
        "`MAP`, line 3: `unit` of the clock is \"rpm\"; expected s, ms, us, ns, min or h",
    ),
    ("unit = \"ms\"", "", "`MAP`, line 1: `unit` of the clock is left out; expected s, ms, us, ns, min or h"),
    (
        "time = \"Zeit\"\nunit = \"ms\"",
        "",
        "`MAP`, line 1: a clock needs `time`, the signal with the times, or `rate_Hz`",
    ),
    (
        "unit = \"ms\"",
        "unit = \"ms\"\nrate_Hz = 1000",
        "`MAP`, line 4: a clock has either `time` or `rate_Hz`; leave one out",
    ),
    ("[[clocks]]", "[clocks]", "`MAP`, line 1: `clocks` is a table; expected one table [[clocks]] or more"),
    ("[[clocks]]", "[[clocks]]\ngroup = \"DAQ\"", "line 1: `LOG` holds no group `DAQ` that is used"),
    ("time = \"Zeit\"", "time = \"M\"", "`LOG` cannot be imported: the time `M` goes back from"),
    (
        "[channels.speed]",
        "[channels.\"motor speed\"]",
        "`MAP`, line 5: `motor speed` is no name of a channel; use letters, digits and underscores",
    ),
    (
        "[channels.speed]",
        "[channel.speed]",
        "`MAP`, line 1: it maps no channel; add [channels.NAME] with `signal` and `unit`",
    ),
];

#[test]
fn every_mistake_in_a_mapping_gets_one_sentence_that_says_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    let (table, map, log) =
        (path(&folder, "drive.csv"), path(&folder, "map.toml"), path(&folder, "run.mcap"));
    std::fs::write(&table, "Zeit;n_Motor;M\n0;1;0,5\n1;2;0,25\n2;3;-1\n").unwrap();
    std::fs::write(&map, GOOD).unwrap();
    let _ = run(["import", &table, "--map", &map, "-o", &log]).done();
    std::fs::remove_file(&log).unwrap();
    for (good, bad, sentence) in MISTAKES {
        assert!(GOOD.contains(good), "{good}");
        std::fs::write(&map, GOOD.replacen(good, bad, 1)).unwrap();
        let ran = run(["import", &table, "--map", &map, "-o", &log]);
        let found = ran.refusal(1);
        let expected = sentence.replace("LOG", &table).replace("MAP", &map);
        assert!(found.contains(&expected), "{bad}:\n  found    {found}\n  expected {expected}");
        assert!(!std::path::Path::new(&log).exists(), "{bad} leaves a log behind");
    }
}
