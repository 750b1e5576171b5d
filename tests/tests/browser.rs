//! The dashboard as a web page, in a real browser: a recording that is dropped into it looks as `--screenshot` draws it, and what is no
//! recording says so in place.

use std::collections::HashMap;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::time::Duration;

use socam_tests::{firmware, run, skip, socam_host};

const TARGET: &str = "wasm32-unknown-unknown";

/// The page, up to date; `None`, with the reason said, where it cannot be built here.
fn page() -> Option<PathBuf> {
    if !firmware::has_target(TARGET) {
        skip(&format!("Rust here has no target {TARGET}, which the web page is built for"));
        return None;
    }
    let build = Path::new(env!("CARGO_MANIFEST_DIR")).join("../web/build");
    let target = firmware::kept("");
    let built = Command::new(build)
        .arg(target)
        .env("CARGO", env!("CARGO"))
        .stdin(Stdio::null())
        .output()
        .expect("bash");
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success() && said.is_empty(), "{said}");
    Some(PathBuf::from(String::from_utf8(built.stdout).expect("a path").trim()))
}

/// A browser; `None`, with the reason said, where there is none.
fn browser() -> Option<OsString> {
    let names = ["chromium", "chromium-browser", "google-chrome"].map(OsString::from);
    let starts = |name: &OsString| {
        Command::new(name)
            .arg("--version")
            .stdin(Stdio::null())
            .output()
            .is_ok_and(|said| said.status.success())
    };
    let found = std::env::var_os("SOCAM_BROWSER").into_iter().chain(names).find(starts);
    if found.is_none() {
        skip("no Chromium is here (SOCAM_BROWSER names another place), in which the web page is tried");
    }
    found
}

/// Actions of a user on the page: drops two files, looks at the picture, opens the spectra. The results are sent to the server.
const VISITOR: &str = r#"
<script>
const wait = ms => new Promise(resolve => setTimeout(resolve, ms));
const words = () => document.getElementById("words").textContent;
const answer = (name, body) => fetch(name, { method: "POST", body });
async function until(text) {
  for (let n = 0; n < 2400 && !words().includes(text); n++) await wait(25);
  if (!words().includes(text)) throw `waited for ${text}, seen is: ${words()} ${document.getElementById("problem").textContent}`;
  return words();
}
function drop(name, content) {
  const data = new DataTransfer();
  data.items.add(new File([content], name));
  document.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
}
const press = key => canvas.dispatchEvent(new KeyboardEvent("keydown", { key, ctrlKey: true, bubbles: true }));
async function visit() {
  await until("No recording is open");
  drop("run.mcap", await (await fetch("run.mcap")).arrayBuffer());
  await answer("time", await until("Chart torque_out"));
  await wait(500);
  await answer("size", `${canvas.width}x${canvas.height}`);
  await answer("picture", await new Promise(resolve => canvas.toBlob(resolve)));
  drop("foreign.mcap", "this is no log at all");
  await answer("foreign", await until("foreign.mcap"));
  press("2");
  await answer("frequency", await until("per sqrt(Hz)"));
  press("3");
  await answer("check", await until("fit for use"));
  drop("fit.json", IDENTIFICATION);
  await answer("parameters", await until("133.35"));
  drop("diagnosis.json", DIAGNOSIS);
  await answer("diagnosis", await until("1. Coulomb friction at load_bearing"));
  const leaving = new Promise(resolve => URL.createObjectURL = blob => (resolve(blob), "blob:none"));
  press("e");
  await answer("export", await leaving);
}
addEventListener("load", () => visit().then(() => answer("end", "reached"), error => answer("end", `${error}`)));
</script>
</html>"#;

/// Serves files by name and forwards the results that the browser posts, until the receiver is dropped.
fn serve(listener: TcpListener, files: HashMap<&'static str, Vec<u8>>) -> Receiver<(String, Vec<u8>)> {
    let (answers, heard) = std::sync::mpsc::channel();
    let files = Arc::new(files);
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let (answers, files) = (answers.clone(), files.clone());
            // A connection each: browsers open some that they never use.
            std::thread::spawn(move || attend(stream, &files, &answers));
        }
    });
    heard
}

fn attend(
    stream: TcpStream,
    files: &HashMap<&str, Vec<u8>>,
    answers: &Sender<(String, Vec<u8>)>,
) -> std::io::Result<()> {
    let mut reader = BufReader::new(&stream);
    let mut line = String::new();
    reader.read_line(&mut line)?;
    let name = line.split(' ').nth(1).unwrap_or_default().trim_start_matches('/').to_owned();
    let is_answer = line.starts_with("POST");
    let mut length = 0;
    while line.trim() != "" {
        line.clear();
        reader.read_line(&mut line)?;
        if let Some(value) = line.to_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse().unwrap_or(0);
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    let content = files.get(name.as_str()).map_or(&[][..], Vec::as_slice);
    let kind = if name.is_empty() { "text/html; charset=utf-8" } else { "application/octet-stream" };
    let head = format!(
        "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        content.len()
    );
    (&stream).write_all(&[head.as_bytes(), content].concat())?;
    if is_answer {
        let _ = answers.send((name, body));
    }
    Ok(())
}

/// Ends the browser when it is dropped, whatever the result of the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_recording_dropped_into_the_page_looks_as_it_does_on_the_desktop() {
    let (Some(browser), Some(page)) = (browser(), page()) else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let _ = run(["simulate", "--profile", "steps", "--duration", "3s", "-o", path.to_str().unwrap()]).done();
    let text = std::fs::read_to_string(&page).unwrap();
    println!("measured: the dashboard as a web page is {:.1} MB", text.len() as f64 / 1e6);
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/socam-dashboard/tests/panels/sample");
    let sample = |name: &str| std::fs::read_to_string(samples.join(name)).unwrap();
    let visitor = VISITOR
        .replace("IDENTIFICATION", &format!("JSON.stringify({})", sample("identification.json")))
        .replace("DIAGNOSIS", &format!("JSON.stringify({})", sample("diagnosis.json")));
    let visited = text.replace("</html>", &visitor).into_bytes();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let heard = serve(listener, [("", visited), ("run.mcap", std::fs::read(&path).unwrap())].into());
    let _running = Running(
        Command::new(browser)
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1280,900"])
            // Containers have little shared memory; and newer browsers draw without a graphics card only when asked to.
            .args(["--disable-dev-shm-usage", "--enable-unsafe-swiftshader", "--no-first-run"])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .arg(format!("http://{address}/"))
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap(),
    );
    let mut answers = HashMap::new();
    while !answers.contains_key("end") {
        let answer = heard.recv_timeout(Duration::from_secs(120)).expect("the browser answers");
        answers.extend([answer]);
    }
    let answer = |name: &str| String::from_utf8_lossy(answers.get(name).map_or(&[], Vec::as_slice));
    assert_eq!(answer("end"), "reached");
    for chart in ["Chart command, V", "Chart motor_speed, rad/s", "Chart torque_out, N m"] {
        assert!(answer("time").contains(chart), "{}", answer("time"));
    }
    assert!(answer("foreign").contains("foreign.mcap"), "{}", answer("foreign"));
    // No button that could do nothing here.
    assert!(!answer("time").contains("EMERGENCY STOP"), "{}", answer("time"));
    assert!(answer("check").contains("fit for use"), "{}", answer("check"));
    assert!(
        answer("diagnosis").contains("load_bearing: bearing with damping; finding 1, Coulomb friction"),
        "{}",
        answer("diagnosis")
    );
    assert!(answers["export"].starts_with(b"\x89PNG"));
    assert!(answer("frequency").contains("Chart motor_speed, rad/s per sqrt(Hz)"), "{}", answer("frequency"));

    let in_page = pixels(&answers["picture"]);
    let target = folder.path().join("desktop.png");
    let drawn = socam_host()
        .args(["dashboard", "run.mcap", "--view", "time", "--dark", "--size", &answer("size")])
        .arg("--screenshot")
        .arg(&target)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    let on_desktop = pixels(&std::fs::read(target).unwrap());
    assert_eq!(in_page.len(), on_desktop.len());
    let differ = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 8);
    // Below the bar, which has no bench here.
    let bar = 40 * answer("size").split_once('x').unwrap().0.parse::<usize>().unwrap();
    let others = in_page[bar..].iter().zip(&on_desktop[bar..]).filter(|(a, b)| differ((a, b))).count();
    assert!(others * 1000 < in_page.len(), "{others} of {} pixels differ", in_page.len());
}

/// Red, green and blue of a PNG file.
fn pixels(file: &[u8]) -> Vec<[u8; 3]> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let channels = info.color_type.samples();
    bytes[..info.buffer_size()].chunks_exact(channels).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}
