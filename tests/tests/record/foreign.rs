//! `record` and boards with other firmware.

use std::io::{Read, Write};
use std::net::TcpListener;
use std::path::Path;

use socam_tests::{path, run};
use socam_wire::{
    BoardKind, Decoder, EnableFeedback, Encoder, FrontEnd, Identity, Image, MAX_FRAME, SCHEMA_VERSION, Start,
    Text, ToBoard, ToHost,
};

use super::record;

/// A frame as every version of the firmware begins it: version and its complement.
fn foreign_frame() -> Vec<u8> {
    let version = SCHEMA_VERSION + 1;
    vec![0, 6, version, !version, 1, 2, 3, 0]
}

/// A hello of this version, of a board with other converters.
fn foreign_hello() -> Vec<u8> {
    let identity = Identity {
        board: Text::new("mill 3"),
        firmware: Text::new("9.1"),
        front_end: FrontEnd {
            kind: BoardKind::Analog,
            input_full_scale_uv: 2_500_000,
            output_full_scale_uv: 2_500_000,
            channel_step_ns: 0,
        },
        start: Start::Supply,
        enable_feedback: EnableFeedback::Nowhere,
        image: Image::Whole,
    };
    let mut frame = [0; MAX_FRAME];
    let len = Encoder::new().encode(&ToHost::Hello(identity), &mut frame).unwrap();
    frame[..len].to_vec()
}

/// One sentence, and the board has been asked who it is and nothing else.
#[test]
fn a_board_with_foreign_firmware_is_refused_before_anything_is_asked_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let (log, calibration) = (path(&folder, "run.mcap"), path(&folder, "bench.toml"));
    std::fs::write(&calibration, run(["template", "calibration"]).done()).unwrap();
    for (talk, why) in [(foreign_frame(), "speaks version"), (foreign_hello(), "has 2.5 V at 16 bits")] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let device = format!("tcp:{}", listener.local_addr().unwrap());
        let board = std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let (mut asked, mut bytes) = (Vec::new(), [0; 4096]);
            let mut decoder = Decoder::<ToBoard>::new();
            while let Ok(count @ 1..) = stream.read(&mut bytes) {
                let mut heard = &bytes[..count];
                asked.extend(std::iter::from_fn(|| decoder.next(&mut heard)));
                let _ = stream.write_all(&talk);
            }
            asked
        });
        let ran = record(&device, &log, &["--calibration", &calibration]);
        assert!(ran.refusal(1).contains(why), "{ran:?}");
        let asked = board.join().unwrap();
        assert!(!asked.is_empty() && asked.iter().all(|item| *item == Ok(ToBoard::Hello)), "{asked:?}");
        assert!(!Path::new(&log).exists());
    }
}
