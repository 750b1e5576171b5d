//! Functions that the page calls, and the state between calls.

use std::cell::RefCell;
use std::sync::{Mutex, PoisonError};

use egui::{
    ColorImage, Context, Event, Key, Modifiers, MouseWheelUnit, OutputCommand, PointerButton, RawInput, Rect,
    TouchPhase, pos2, vec2,
};
use socam_chart::raster::Raster;
use socam_dashboard::{Dashboard, Layout};

struct Page {
    ctx: Context,
    dashboard: Dashboard,
    raster: Raster,
    picture: ColorImage,
    events: Vec<Event>,
    modifiers: Modifiers,
    size: [f32; 2],
    scale: f32,
    /// Requests to the page.
    wishes: Vec<Wish>,
    /// The last layout that was given to the page to store.
    kept: String,
    /// The last text for screen readers.
    words: String,
}

/// A request that only the page can fulfil. The page uses the same numbers.
struct Wish {
    kind: u32,
    name: String,
    bytes: Vec<u8>,
}

const COPY: u32 = 1;
const DOWNLOAD: u32 = 2;
const ASK_FOR_FILES: u32 = 3;
const KEEP_LAYOUT: u32 = 4;
const WORDS: u32 = 5;

thread_local! {
    static ROOM: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static PAGE: RefCell<Option<Page>> = const { RefCell::new(None) };
}

/// The panic message, for the page to show.
static FAILURE: Mutex<String> = Mutex::new(String::new());

fn with<T: Default>(use_it: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(|page| page.as_mut().map(use_it).unwrap_or_default())
}

/// The bytes that the page wrote into the buffer.
fn given(length: usize) -> Vec<u8> {
    ROOM.with_borrow_mut(|room| {
        let mut bytes = std::mem::take(room);
        bytes.truncate(length);
        bytes
    })
}

fn given_text(length: usize) -> String {
    String::from_utf8_lossy(&given(length)).into_owned()
}

/// A buffer of `length` bytes for the page; the function that the page calls next reads it.
#[unsafe(no_mangle)]
extern "C" fn room(length: usize) -> *mut u8 {
    ROOM.with_borrow_mut(|room| {
        room.clear();
        room.resize(length, 0);
        room.as_mut_ptr()
    })
}

/// Starts the dashboard; the stored layout is in the buffer.
#[unsafe(no_mangle)]
extern "C" fn start(layout: usize) {
    std::panic::set_hook(Box::new(|info| {
        *FAILURE.lock().unwrap_or_else(PoisonError::into_inner) = info.to_string();
    }));
    let layout: Layout = serde_json::from_slice(&given(layout)).unwrap_or_default();
    let ctx = Context::default();
    let dashboard = Dashboard::new(layout);
    dashboard.set_up(&ctx);
    ctx.enable_accesskit();
    let page = Page {
        ctx,
        dashboard,
        raster: Raster::default(),
        picture: ColorImage::default(),
        events: Vec::new(),
        modifiers: Modifiers::NONE,
        size: [0.0; 2],
        scale: 1.0,
        wishes: Vec::new(),
        kept: String::new(),
        words: String::new(),
    };
    PAGE.set(Some(page));
}

/// The canvas' size in points, and pixels per point.
#[unsafe(no_mangle)]
extern "C" fn resize(width: f32, height: f32, scale: f32) {
    with(|page| (page.size, page.scale) = ([width, height], scale));
}

/// Bits: 1 Shift, 2 Ctrl, 4 Alt, 8 the Mac's command key.
fn modifiers(bits: u32) -> Modifiers {
    let [shift, ctrl, alt, mac_cmd] = [1, 2, 4, 8].map(|bit| bits & bit != 0);
    Modifiers { alt, ctrl, shift, mac_cmd, command: ctrl || mac_cmd }
}

fn push(bits: u32, event: impl FnOnce(Modifiers) -> Event) {
    with(|page| {
        let now = modifiers(bits);
        if std::mem::replace(&mut page.modifiers, now) != now {
            page.events.push(Event::ModifiersChanged(now));
        }
        page.events.push(event(now));
    });
}

/// The pointer moved.
#[unsafe(no_mangle)]
extern "C" fn pointer_moved(x: f32, y: f32, bits: u32) {
    push(bits, |_| Event::PointerMoved(pos2(x, y)));
}

/// The pointer left the canvas.
#[unsafe(no_mangle)]
extern "C" fn pointer_gone() {
    push(0, |_| Event::PointerGone);
}

/// A button of the pointer was pressed or released; numbers as in DOM events.
#[unsafe(no_mangle)]
extern "C" fn pointer_button(x: f32, y: f32, button: u32, pressed: bool, bits: u32) {
    let button = match button {
        0 => PointerButton::Primary,
        1 => PointerButton::Middle,
        _ => PointerButton::Secondary,
    };
    push(bits, |modifiers| Event::PointerButton { pos: pos2(x, y), button, pressed, modifiers });
}

/// The wheel turned, in points.
#[unsafe(no_mangle)]
extern "C" fn wheel(x: f32, y: f32, bits: u32) {
    push(bits, |modifiers| Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(-x, -y),
        phase: TouchPhase::Move,
        modifiers,
        source: egui::MouseWheelSource::Wheel,
    });
}

/// A key was pressed or released; its name is in the buffer.
#[unsafe(no_mangle)]
extern "C" fn key(name: usize, pressed: bool, repeat: bool, bits: u32) {
    if let Some(key) = Key::from_name(&given_text(name)) {
        push(bits, |modifiers| Event::Key { key, physical_key: None, pressed, repeat, modifiers });
    }
}

/// Text was typed (0) or pasted (1), or should be copied (2) or cut (3).
#[unsafe(no_mangle)]
extern "C" fn text(length: usize, how: u32) {
    let text = given_text(length);
    push(0, |_| match how {
        0 => Event::Text(text),
        1 => Event::Paste(text),
        2 => Event::Copy,
        _ => Event::Cut,
    });
}

/// A file was dropped or chosen: its name and then its content are in the buffer.
#[unsafe(no_mangle)]
extern "C" fn file(name: usize, length: usize) {
    let mut bytes = given(name + length);
    let content = bytes.split_off(name.min(bytes.len()));
    let name = String::from_utf8_lossy(&bytes).into_owned();
    with(|page| page.dashboard.take_file(&page.ctx, &name, content));
}

/// Draws a pass. Returns the delay until the next one, ms, at most one hour.
#[unsafe(no_mangle)]
extern "C" fn frame(time_s: f64) -> u32 {
    with(|page| page.frame(time_s))
}

impl Page {
    fn frame(&mut self, time_s: f64) -> u32 {
        let size = vec2(self.size[0], self.size[1]);
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), size / self.ctx.zoom_factor())),
            time: Some(time_s),
            focused: true,
            events: std::mem::take(&mut self.events),
            ..RawInput::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&input.viewport_id) {
            viewport.native_pixels_per_point = Some(self.scale);
        }
        let ctx = self.ctx.clone();
        let mut output = ctx.run_ui(input, |ui| self.dashboard.ui(ui));
        self.raster.take(&mut output.textures_delta);
        let pixels = self.size.map(|points| (points * self.scale).round() as usize);
        let ground = ctx.global_style().visuals.panel_fill;
        self.picture = self.raster.draw(&ctx, output.shapes, output.pixels_per_point, pixels, ground);
        for command in output.platform_output.commands {
            if let OutputCommand::CopyText(text) = command {
                self.wish(COPY, "", text.into_bytes());
            }
        }
        for (name, bytes) in self.dashboard.take_leaving() {
            self.wish(DOWNLOAD, &name, bytes);
        }
        if self.dashboard.take_wish_for_files() {
            self.wish(ASK_FOR_FILES, "", Vec::new());
        }
        if let Some(update) = output.platform_output.accesskit_update {
            let words: Vec<&str> =
                update.nodes.iter().filter_map(|(_, node)| node.label().or(node.value())).collect();
            let words = words.join("\n");
            if words != self.words {
                self.wish(WORDS, "", words.clone().into_bytes());
                self.words = words;
            }
        }
        let layout = serde_json::to_string(&self.dashboard.layout).unwrap_or_default();
        if layout != self.kept {
            self.wish(KEEP_LAYOUT, "", layout.clone().into_bytes());
            self.kept = layout;
        }
        let delay = output.viewport_output.values().map(|viewport| viewport.repaint_delay).min();
        delay.map_or(3_600_000, |delay| delay.as_millis().min(3_600_000) as u32)
    }

    fn wish(&mut self, kind: u32, name: &str, bytes: Vec<u8>) {
        self.wishes.push(Wish { kind, name: name.to_owned(), bytes });
    }
}

/// The picture's pixels, red, green, blue and alpha, row by row; width and height are those of the canvas in pixels.
#[unsafe(no_mangle)]
extern "C" fn pixels() -> *const u8 {
    PAGE.with_borrow(|page| {
        page.as_ref().map_or(std::ptr::null(), |page| page.picture.pixels.as_ptr().cast())
    })
}

/// Width of the picture, pixels.
#[unsafe(no_mangle)]
extern "C" fn width() -> usize {
    with(|page| page.picture.size[0])
}

/// Height of the picture, pixels.
#[unsafe(no_mangle)]
extern "C" fn height() -> usize {
    with(|page| page.picture.size[1])
}

/// Kind of the next request; 0 for none. Its name and content are at [`wish_at`] until [`wish_done`].
#[unsafe(no_mangle)]
extern "C" fn wish() -> u32 {
    with(|page| page.wishes.first().map_or(0, |wish| wish.kind))
}

/// Address of the name (0) or content (1) of the request.
#[unsafe(no_mangle)]
extern "C" fn wish_at(part: u32) -> *const u8 {
    PAGE.with_borrow(|page| {
        let wish = page.as_ref().and_then(|page| page.wishes.first());
        wish.map_or(std::ptr::null(), |wish| if part == 0 { wish.name.as_ptr() } else { wish.bytes.as_ptr() })
    })
}

/// Length of the name (0) or content (1) of the request, bytes.
#[unsafe(no_mangle)]
extern "C" fn wish_length(part: u32) -> usize {
    with(|page| {
        page.wishes.first().map_or(0, |wish| if part == 0 { wish.name.len() } else { wish.bytes.len() })
    })
}

/// Removes the next request, which the page has fulfilled.
#[unsafe(no_mangle)]
extern "C" fn wish_done() {
    with(|page| drop(page.wishes.drain(..page.wishes.len().min(1))));
}

/// Address of the panic message, of [`failure_length`] bytes.
#[unsafe(no_mangle)]
extern "C" fn failure() -> *const u8 {
    FAILURE.lock().unwrap_or_else(PoisonError::into_inner).as_ptr()
}

/// Length of the panic message, bytes.
#[unsafe(no_mangle)]
extern "C" fn failure_length() -> usize {
    FAILURE.lock().unwrap_or_else(PoisonError::into_inner).len()
}
