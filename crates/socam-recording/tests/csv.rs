//! CSV recordings: what is read, what is refused, and in which words.

use std::path::PathBuf;

use proptest::prelude::*;
use socam_recording::{Channel, Dataset, Steady, Unit, Warning};

fn file(dir: &tempfile::TempDir, name: &str, content: impl AsRef<[u8]>) -> String {
    let path = dir.path().join(name);
    std::fs::write(&path, content).unwrap();
    path.to_str().unwrap().to_owned()
}

fn refusal(name: &str, content: impl AsRef<[u8]>) -> String {
    let dir = tempfile::tempdir().unwrap();
    let message = Dataset::open(&file(&dir, name, content)).unwrap_err().to_string();
    assert!(!message.contains('\n'), "one sentence: {message}");
    assert!(message.contains(name), "names the file: {message}");
    message
}

#[test]
fn columns_become_channels_and_the_rest_is_left_aside() {
    let dir = tempfile::tempdir().unwrap();
    let path = file(
        &dir,
        "run.csv",
        "\u{feff}t_s,motor_speed_rad_s,split,\"u_V\",count,note_A,void_K\r\n\
         0,1.5,train,2,7,x,\r\n\
         0.001,,train,3,8,y,\r\n\
         \r\n\
         0.002,2.5,test,-4e-3,9,,\r\n",
    );
    let data = Dataset::open(&path).unwrap();
    assert_eq!(data.channels(), [Channel::new("motor_speed", Unit::RadPerS), Channel::new("u", Unit::V)]);
    let column = |name: &str| Warning::ColumnWithoutUnit { column: name.into() };
    assert_eq!(
        data.warnings(),
        [
            column("split"),
            column("count"),
            Warning::TextColumn { column: "note_A".into() },
            Warning::EmptyColumn { column: "void_K".into() },
        ]
    );
    assert_eq!(data.rows(), 3);
    assert_eq!(data.statistics()[0].missing, 1);
    assert_eq!(data.statistics()[1].min, Some(-4e-3));
    let block = data.blocks().unwrap().next().unwrap().unwrap();
    assert_eq!(block.time_s, [0.0, 0.001, 0.002]);
    assert_eq!(block.columns[0].get(1), None);
    assert_eq!(block.columns[0].get(2), Some(2.5));
    assert!(block.columns[1].is_complete() && !block.columns[0].is_complete());
    assert_eq!(data.channel_index("u_V").unwrap(), 1);
    assert!(data.channel_index("w").is_err());
}

#[test]
fn blocks_stop_at_gaps_and_selections_keep_their_times() {
    let dir = tempfile::tempdir().unwrap();
    let mut text = String::from("t_s,u_V\n");
    for i in (0..10_000).filter(|i| !(5000..5010).contains(i)) {
        text += &format!("{},{i}\n", f64::from(i) / 1000.0);
    }
    let path = file(&dir, "run.csv", text);
    let data = Dataset::open(&path).unwrap();
    assert_eq!(data.segments().len(), 2);
    assert_eq!(data.segments()[1].first_row, 5000);
    for _ in 0..2 {
        let mut row = 0;
        for block in data.blocks().unwrap() {
            let block = block.unwrap();
            assert_eq!(block.first_row, row);
            assert_eq!(block.segment, usize::from(row >= 5000));
            row += block.rows() as u64;
        }
        assert_eq!(row, 9990);
    }
    let part = Dataset::open(&format!("{path}@1..2.5")).unwrap();
    assert_eq!((part.rows(), part.start_s(), part.end_s()), (1500, 1.0, 2.499));
    assert_eq!(part.load(&["u"]).unwrap().columns[0].values()[0], 1000.0);
    let message = Dataset::open(&format!("{path}@90..99")).unwrap_err().to_string();
    assert!(message.contains("widen the selection"), "{message}");
}

#[test]
fn bad_files_get_one_sentence_with_the_place() {
    let dir = tempfile::tempdir().unwrap();
    let message = Dataset::open(dir.path().to_str().unwrap()).unwrap_err();
    assert!(message.to_string().contains("is a directory"), "{message}");
    let absent = dir.path().join("absent.csv");
    let message = Dataset::open(absent.to_str().unwrap()).unwrap_err();
    assert!(message.to_string().contains("no such file"), "{message}");
    for (name, content, expected) in [
        ("a.csv", "", "is empty"),
        ("b.csv", "time,u_V\n0,1\n", "line 1: the header starts with `time`"),
        ("c.csv", "t_s,u\n0,1\n", "no numeric column ends in a unit"),
        ("d.csv", "t_s,u_V\n", "holds no samples"),
        ("e.csv", "t_s,u_V\n0,1\n0.1,NaN\n", "line 3: column `u_V` holds `NaN`"),
        ("f.csv", "t_s,u_V\n0,1\n0.1,-inf\n", "line 3: column `u_V` holds `-inf`"),
        ("g.csv", "t_s,u_V\n0,1\n0.1,x\n", "line 3: column `u_V` holds `x`"),
        ("h.csv", "t_s,u_V\n0,x\n0.1,2\n", "line 3: column `u_V` holds a number here but `x` in line 2"),
        ("i.csv", "t_s,u_V\n0,1\n0.1,2\n0.05,3\n", "line 4: time goes from 0.1 s to 0.05 s"),
        ("j.csv", "t_s,u_V\n0,1\n0.1\n", "line 3: 1 cells where the header names 2"),
        ("k.csv", "t_s,u_V\n0,1\n,2\n", "line 3: `t_s` is empty"),
        ("l.csv", "t_s,u_V,u_V\n0,1,2\n", "two columns are named `u_V`"),
        ("m.dat", "hello\n", "starts with `hello`"),
        ("n.dat", "PAR1....", "Parquet"),
        ("o.csv", "point_1,u_V\n1,2\n", "steady states"),
        ("p.csv", "t_s,u_V\n0,a\n1,b\n", "no numeric column"),
        ("q.mcap", "\u{89}", "starts with"),
        ("r.csv", "t_s,u_V\nnan,1\n", "line 2: column `t_s` holds `nan`"),
    ] {
        let message = refusal(name, content);
        assert!(message.contains(expected), "{name}: {message}");
    }
    assert!(refusal("s.mcap", &b"\x89MCAP"[..]).contains("cut off after 5 bytes"));
}

#[test]
fn the_thesis_program_log_is_read_in_both_brackets() {
    for (open, close) in [("[", "];"), ("{", "};")] {
        let dir = tempfile::tempdir().unwrap();
        let path = file(
            &dir,
            "run.m",
            format!(
                "samprate= 0.00500;\namplitude= 0.50000;\nfrequency= 1.00000;\noffset= 1.88000;\ndata={open}\n\
                 6.90000 -19.30000 0.10000 0.20000 1.88000\n3.45000 0.00000 0.10000 0.20000 1.90000\n{close}\n"
            ),
        );
        let data = Dataset::open(&path).unwrap();
        let loaded = data.load(&["command", "motor_speed", "output_speed", "torque_in_V"]).unwrap();
        assert_eq!(loaded.time_s, [0.0, 0.005]);
        assert_eq!(loaded.columns[0].values(), [1.88, 1.90]);
        let krpm = 1000.0 * std::f64::consts::TAU / 60.0;
        assert!((loaded.columns[1].values()[0] - krpm).abs() < 1e-9);
        assert!((loaded.columns[2].values()[0] + krpm).abs() < 1e-9);
        assert_eq!(loaded.columns[3].values(), [0.1, 0.1]);
    }
    let cut = refusal("cut.m", "samprate= 0.005;\ndata=[\n1 2 3 4 5\n");
    assert!(cut.contains("cut off"), "{cut}");
    let short = refusal("short.m", "samprate= 0.005;\ndata=[\n1 2 3 4\n];\n");
    assert!(short.contains("line 3: found `1 2 3 4`"), "{short}");
}

#[test]
fn steady_states_are_a_table_of_their_own() {
    let dir = tempfile::tempdir().unwrap();
    let path = file(
        &dir,
        "steady.csv",
        "point_1,motor_speed_rad_s,torque_in_Nm\n500,52.82309,0.69\n1000,106.4647,\n",
    );
    let steady = Steady::open(&PathBuf::from(&path)).unwrap();
    assert_eq!(steady.rows.len(), 2);
    assert_eq!(steady.column("torque_in").unwrap(), [Some(0.69), None]);
    let series = file(&dir, "series.csv", "t_s,u_V\n0,1\n");
    assert!(Steady::open(&PathBuf::from(series)).is_err());
}

/// Recordings of other people, in the folder `SOCAM_DATA`, can be opened.
#[test]
fn recordings_of_others_open() {
    let Some(root) = std::env::var_os("SOCAM_DATA").map(PathBuf::from) else {
        eprintln!("skipped: SOCAM_DATA does not name a folder of recordings");
        return;
    };
    let mut opened = 0;
    for folder in std::fs::read_dir(root).unwrap() {
        for entry in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            let path = entry.unwrap().path();
            // Tables of several runs have another first column; their users cut them into recordings.
            let is_recording = |text: &str| text.starts_with("t_s");
            if path.extension().is_some_and(|e| e == "csv")
                && is_recording(&std::fs::read_to_string(&path).unwrap())
            {
                let data = Dataset::open(path.to_str().unwrap()).unwrap();
                let rows = std::fs::read_to_string(&path).unwrap().lines().count() - 1;
                assert_eq!(data.rows(), rows as u64, "{}", path.display());
                // Clocks of servos and their buses are irregular; those of the others leave no gap.
                if !["bam", "odrive"].iter().any(|name| path.parent().unwrap().ends_with(name)) {
                    assert_eq!(data.segments().len(), 1, "{}", path.display());
                }
                opened += 1;
            }
        }
    }
    assert!(opened > 0);
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let dir = tempfile::tempdir().unwrap();
        let mut content = b"t_s,u_V,w_rad_s\n".to_vec();
        content.extend(bytes);
        let _ = Dataset::open(&file(&dir, "x.csv", content));
    }
}
