mod misbehaving;

use std::io::{self, Read, Write};
use std::time::Duration;

use serialport::{SerialPortInfo, SerialPortType};
use socam_core::Request;
use socam_model::Model;
use socam_recording::{Calibration, Dataset, ProfileFile, Selection};
use socam_sim::{Setup, Truth};

use super::run::{End, Plan, Report, record};
use super::*;
use crate::interrupt::Interrupt;

fn setup(calibration: &Calibration) -> Setup {
    let truth = Truth::new(&Model::builtin("speed-o-cam").unwrap(), &[], &[]).unwrap();
    Setup::new(truth, calibration.clone(), 7)
}

fn plan(calibration: &Calibration, path: &std::path::Path) -> Plan {
    let mut file = ProfileFile::open("steps").unwrap();
    file.duration_s = 2.0;
    Plan {
        profile: file.profile(1000).unwrap(),
        calibration: calibration.clone(),
        period_us: 1000,
        path: path.into(),
        replace: false,
        metadata: [("note".to_owned(), "test".to_owned())].into(),
        attachments: Vec::new(),
        start_unix_ns: 0,
    }
}

fn run_on(stream: Box<dyn Stream>, calibration: &Calibration) -> (anyhow::Result<Report>, Option<Dataset>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut session = Session::open(stream, "test".into(), true).unwrap();
    let report = record(&mut session, plan(calibration, &path), &Interrupt::default());
    let data = path.exists().then(|| Dataset::open_selection(&Selection::whole(&path)).unwrap());
    (report, data)
}

fn in_process(calibration: &Calibration) -> Box<dyn Stream> {
    Box::new(InProcess::start(setup(calibration), Pace::Fast).unwrap())
}

#[test]
fn a_run_is_recorded_from_its_first_sample_to_its_last() {
    let calibration = Calibration::default();
    let (report, data) = run_on(in_process(&calibration), &calibration);
    let (report, data) = (report.unwrap(), data.unwrap());
    assert_eq!((report.end, report.summary.lost), (End::Finished, 0));
    assert_eq!((data.start_s(), data.segments().len()), (0.0, 1));
    let command = data.load(&["command"]).unwrap();
    let last = command.time_s.len() - 1;
    assert_eq!(command.columns[0].get(last), Some(0.0));
    assert!(command.columns[0].get(last - 1).unwrap() > 0.0);
    let log = data.contents().unwrap();
    assert_eq!(log.metadata["note"], "test");
    assert!(log.metadata["board"].contains("virtual bench"));
    assert!(log.events.iter().any(|event| event.kind == "phase"));
}

#[test]
fn a_fault_is_told_in_words_and_what_came_before_it_is_kept() {
    let mut calibration = Calibration::default();
    calibration.channels[0].limit = Some(50.0);
    let (report, data) = run_on(in_process(&calibration), &calibration);
    let (report, data) = (report.unwrap(), data.unwrap());
    let End::Fault(reason) = report.end else { panic!("{report:?}") };
    assert!(reason.contains("motor_speed"), "{reason}");
    assert!(
        data.contents().unwrap().events.iter().any(|event| event.kind == "fault" && event.text == reason)
    );
    let speed = data.load(&["motor_speed"]).unwrap();
    assert!(speed.columns[0].values().last().unwrap() > &50.0);
}

#[test]
fn a_run_that_never_began_leaves_no_file() {
    let calibration = Calibration::default();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut session = Session::open(in_process(&calibration), "test".into(), true).unwrap();
    let mut plan = plan(&calibration, &path);
    plan.profile.limit_micro = 1;
    let problem = format!("{:#}", record(&mut session, plan, &Interrupt::default()).unwrap_err());
    assert!(problem.contains("refuses the profile"), "{problem}");
    assert!(!path.exists());
}

#[test]
fn a_fault_that_was_cleared_before_the_run_does_not_end_it() {
    let calibration = Calibration::default();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut session = Session::open(in_process(&calibration), "test".into(), true).unwrap();
    // The board reports its fault at once; the report is ignored before the run.
    session.request(Request::EmergencyStop).unwrap().unwrap();
    let report = record(&mut session, plan(&calibration, &path), &Interrupt::default()).unwrap();
    assert_eq!(report.end, End::Finished);
}

/// A line that swallows some bytes once samples flow.
struct Lossy {
    inner: Box<dyn Stream>,
    passed: usize,
}

impl Read for Lossy {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        let before = self.passed;
        self.passed += count;
        for (byte, place) in buffer[..count].iter_mut().zip(before..) {
            if (20_000..21_000).contains(&place) {
                *byte = 1;
            }
        }
        Ok(count)
    }
}

impl Write for Lossy {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.inner.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[test]
fn damage_on_the_line_is_counted_as_lost_samples() {
    let calibration = Calibration::default();
    let (report, data) = run_on(Box::new(Lossy { inner: in_process(&calibration), passed: 0 }), &calibration);
    let (report, data) = (report.unwrap(), data.unwrap());
    assert_eq!(report.end, End::Finished);
    assert!((30..200).contains(&report.summary.lost), "{report:?}");
    assert_eq!(data.segments().len(), 2);
    assert_eq!(data.lost_samples(), report.summary.lost);
}

#[test]
fn a_link_that_breaks_keeps_what_was_recorded() {
    struct Broken(Lossy);
    impl Read for Broken {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            if self.0.passed > 20_000 { Ok(0) } else { self.0.read(buffer) }
        }
    }
    impl Write for Broken {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let calibration = Calibration::default();
    let line = Broken(Lossy { inner: in_process(&calibration), passed: 0 });
    let (report, data) = run_on(Box::new(line), &calibration);
    assert_eq!(report.unwrap().end, End::Broken("test closed the link".into()));
    assert!(data.unwrap().rows() > 500);
}

#[test]
fn a_board_that_loses_power_in_a_run_has_not_finished_it() {
    /// A board that is replaced by a new one, just switched on, after some bytes.
    struct PowerCut(Lossy, Calibration);
    impl Read for PowerCut {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            if self.0.passed > 20_000 {
                self.0 = Lossy { inner: in_process(&self.1), passed: 0 };
            }
            self.0.read(buffer)
        }
    }
    impl Write for PowerCut {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let calibration = Calibration::default();
    let line = PowerCut(Lossy { inner: in_process(&calibration), passed: 0 }, calibration.clone());
    let (report, data) = run_on(Box::new(line), &calibration);
    let End::Broken(reason) = report.unwrap().end else { panic!("it is said to have finished") };
    assert!(reason.contains("loss of power"), "{reason}");
    let data = data.unwrap();
    assert!(data.rows() > 100 && data.contents().unwrap().events.iter().any(|event| event.text == reason));
}

/// The virtual board behind a pseudo-terminal.
#[cfg(unix)]
#[test]
fn a_board_on_a_serial_line_is_recorded() {
    let calibration = Calibration::default();
    let (mut line, end) = serialport::TTYPort::pair().unwrap();
    let device = Device::Serial(serialport::SerialPort::name(&end).unwrap());
    drop(end);
    let mut board = InProcess::start(setup(&calibration), Pace::RealTime).unwrap();
    let mut line_out = line.try_clone_native().unwrap();
    serialport::SerialPort::set_timeout(&mut line, Duration::from_millis(1)).unwrap();
    serialport::SerialPort::set_timeout(&mut line_out, Duration::from_secs(5)).unwrap();
    std::thread::spawn(move || {
        let mut buffer = [0; 1024];
        // If either end has nothing to send, or no host has opened the line, there is nothing to forward.
        loop {
            let count = line.read(&mut buffer).unwrap_or(0);
            board.write_all(&buffer[..count]).unwrap();
            let count = board.read(&mut buffer).unwrap_or(0);
            let _ = line_out.write_all(&buffer[..count]);
        }
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut plan = plan(&calibration, &path);
    plan.profile.duration_us = 500_000;
    let report = record(&mut open(&device, None).unwrap(), plan, &Interrupt::default()).unwrap();
    assert_eq!((report.end, report.summary.lost), (End::Finished, 0));
    assert!(report.summary.written > 500);
}

#[test]
fn devices_are_read() {
    assert_eq!("sim".parse(), Ok(Device::Sim));
    assert_eq!("serial:/dev/ttyACM0".parse(), Ok(Device::Serial("/dev/ttyACM0".into())));
    assert_eq!("tcp:127.0.0.1:4000".parse(), Ok(Device::Tcp("127.0.0.1:4000".into(), None)));
    for text in ["", "sim:", "serial:", "tcp:4000", "usb:1", "SIM"] {
        assert!(text.parse::<Device>().is_err(), "{text}");
    }
}

#[test]
fn a_board_is_found_by_what_it_calls_itself() {
    let port = |name: &str, product: &str| SerialPortInfo {
        port_name: name.to_owned(),
        port_type: SerialPortType::UsbPort(serialport::UsbPortInfo {
            vid: 0x2e8a,
            pid: 0x000a,
            serial_number: None,
            manufacturer: None,
            product: Some(product.to_owned()),
        }),
    };
    let other = port("/dev/ttyACM0", "Pico");
    let board = port("/dev/ttyACM1", "socam_board");
    assert_eq!(find_board(&[other.clone(), board.clone()]).unwrap(), "/dev/ttyACM1");
    assert!(find_board(&[other]).unwrap_err().to_string().contains("is it plugged in"));
    let two = find_board(&[board, port("/dev/ttyACM2", "socam board")]).unwrap_err().to_string();
    assert!(two.contains("/dev/ttyACM1, /dev/ttyACM2"), "{two}");
}
