//! The link to the host: USB, as a serial line (CDC ACM).

use core::cell::RefCell;
use core::sync::atomic::Ordering;

use embassy_futures::join::join4;
use embassy_rp::peripherals::USB;
use embassy_rp::usb::Driver;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::{Duration, Instant, Ticker};
use embassy_usb::class::cdc_acm::{CdcAcmClass, Receiver, Sender, State as CdcState};
use embassy_usb::{Builder, Config, UsbDevice};
use socam_core::{Fault, Refusal, Request};
use socam_wire::{BATCH_SAMPLES, BoardLink, Image, MAX_FRAME};
use static_cell::StaticCell;

use crate::hardware::Count;
use crate::sampling::{self, Answer, Ask, RING_SAMPLES, STATE_AND_FAULT};
use crate::slot::{Filler, Taker};
use crate::watchdog;

/// Raspberry Pi's vendor number, and their product number for a serial line. The host finds the board by its product name.
const VENDOR: u16 = 0x2e8a;
const PRODUCT: u16 = 0x000a;

const PACKET: usize = 64;

/// Size of the queue of bytes to the host.
const OUTGOING: usize = 4096;

/// Interval at which the ring is checked for samples.
const LOOK_EVERY: Duration = Duration::from_millis(1);

/// Longest time that a frame waits for a full batch.
const LATEST_SEND: Duration = Duration::from_millis(20);

/// Interval of statuses.
const STATUS_EVERY: Duration = Duration::from_millis(200);

type Usb = Driver<'static, USB>;
type Outgoing = Pipe<NoopRawMutex, OUTGOING>;

/// The link's end of the slots to the core.
pub(crate) struct Core {
    pub(crate) asks: Filler<'static, Ask>,
    pub(crate) answers: Taker<'static, Answer>,
    pub(crate) image: Image,
}

impl Core {
    /// Passes a request to the core and waits for the answer, at most until after the next conversion.
    fn ask(&mut self, ask: Ask) -> Answer {
        // There is room, because requests are sent one at a time.
        self.asks.put(ask);
        loop {
            sampling::nudge();
            if let Some(answer) = self.answers.take() {
                return answer;
            }
        }
    }

    /// A damaged program grants nothing: its fault can be cleared by a new image only.
    fn request(&mut self, request: Request) -> Result<(), Refusal> {
        if self.image == Image::Damaged {
            return Err(Refusal::Faulted(Fault::ImageDamaged));
        }
        self.ask(Ask::Request(request)).result
    }
}

/// Both ends of the link.
struct Talk {
    link: BoardLink<'static, Count, RING_SAMPLES>,
    core: Core,
}

/// Serves the host for ever.
#[embassy_executor::task]
pub(crate) async fn run(driver: Usb, link: BoardLink<'static, Count, RING_SAMPLES>, core: Core) {
    static OUT: StaticCell<Outgoing> = StaticCell::new();
    let out = OUT.init(Pipe::new());
    let (mut device, line) = build(driver);
    let (sender, receiver) = line.split();
    let talk = RefCell::new(Talk { link, core });
    join4(device.run(), listen(receiver, &talk, out), speak(&talk, out), send(sender, out)).await;
}

fn build(driver: Usb) -> (UsbDevice<'static, Usb>, CdcAcmClass<'static, Usb>) {
    static DESCRIPTOR: StaticCell<[u8; 256]> = StaticCell::new();
    static BOS: StaticCell<[u8; 64]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; 64]> = StaticCell::new();
    static STATE: StaticCell<CdcState<'static>> = StaticCell::new();
    let mut config = Config::new(VENDOR, PRODUCT);
    config.manufacturer = Some("socam");
    config.product = Some("socam board");
    config.serial_number = Some(env!("SOCAM_COMMIT"));
    config.self_powered = true;
    config.max_power = 100;
    config.max_packet_size_0 = PACKET as u8;
    let mut builder = Builder::new(
        driver,
        config,
        DESCRIPTOR.init([0; 256]),
        BOS.init([0; 64]),
        &mut [],
        CONTROL.init([0; 64]),
    );
    let line = CdcAcmClass::new(&mut builder, STATE.init(CdcState::new()), PACKET as u16);
    (builder.build(), line)
}

/// Handles messages of the host. It never waits for the host to read: an answer without room in the queue is dropped.
async fn listen(mut receiver: Receiver<'static, Usb>, talk: &RefCell<Talk>, out: &Outgoing) {
    static FRAME: StaticCell<[u8; MAX_FRAME]> = StaticCell::new();
    let frame = FRAME.init([0; MAX_FRAME]);
    let mut packet = [0; PACKET];
    loop {
        receiver.wait_connection().await;
        while let Ok(len) = receiver.read_packet(&mut packet).await {
            let mut bytes = packet.get(..len).unwrap_or_default();
            let Talk { link, core } = &mut *talk.borrow_mut();
            while let Some(len) = link.receive(&mut bytes, frame, |request| core.request(request)) {
                put(out, frame.get(..len).unwrap_or_default());
            }
        }
    }
}

/// Sends samples and statuses.
async fn speak(talk: &RefCell<Talk>, out: &Outgoing) {
    static FRAME: StaticCell<[u8; MAX_FRAME]> = StaticCell::new();
    let frame = FRAME.init([0; MAX_FRAME]);
    let mut ticker = Ticker::every(LOOK_EVERY);
    let (mut sent, mut status_sent) = (Instant::now(), Instant::now());
    let mut told = STATE_AND_FAULT.load(Ordering::Relaxed);
    let mut layout = None;
    loop {
        ticker.next().await;
        watchdog::link_is_at_work();
        let Talk { link, core } = &mut *talk.borrow_mut();
        let state_and_fault = STATE_AND_FAULT.load(Ordering::Relaxed);
        let has_changed = state_and_fault != told;
        let is_late = sent.elapsed() >= LATEST_SEND;
        let at_least = if is_late || has_changed { 1 } else { BATCH_SAMPLES };
        let asked = (has_changed || status_sent.elapsed() >= STATUS_EVERY || layout.is_none())
            .then(|| core.ask(Ask::Status));
        layout = asked.as_ref().map(|answer| answer.layout).or(layout);
        while out.free_capacity() >= MAX_FRAME
            && let Some(layout) = layout
            && let Some(len) = link.samples(layout, at_least, frame)
        {
            put(out, frame.get(..len).unwrap_or_default());
            sent = Instant::now();
        }
        if let Some(Answer { status, .. }) = asked
            && out.free_capacity() >= MAX_FRAME
            && let Some(len) = link.status(status, frame)
        {
            put(out, frame.get(..len).unwrap_or_default());
            (told, status_sent) = (state_and_fault, Instant::now());
        }
    }
}

/// Queues a whole frame or nothing.
fn put(out: &Outgoing, mut frame: &[u8]) {
    if out.free_capacity() < frame.len() {
        return;
    }
    while let Ok(len) = out.try_write(frame)
        && len > 0
    {
        frame = frame.get(len..).unwrap_or_default();
    }
}

/// Sends the queue. Bytes that no host has read are dropped when the line is opened again.
async fn send(mut sender: Sender<'static, Usb>, out: &Outgoing) {
    let mut packet = [0; PACKET];
    loop {
        sender.wait_connection().await;
        out.clear();
        loop {
            let len = out.read(&mut packet).await;
            if sender.write_packet(packet.get(..len).unwrap_or_default()).await.is_err() {
                break;
            }
            // A transfer that ends with a full packet must be ended by an empty one.
            if len == PACKET && out.is_empty() && sender.write_packet(&[]).await.is_err() {
                break;
            }
        }
    }
}
