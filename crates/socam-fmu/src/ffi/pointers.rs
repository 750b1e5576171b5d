//! Conversion of values that C passes to Rust: instances, arrays, texts; and a barrier that stops panics.

use std::ffi::{CStr, CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::{FmuError, Simulation};

/// `fmi3Status`.
pub(super) type Status = i32;
pub(super) const OK: Status = 0;
pub(super) const ERROR: Status = 3;
const FATAL: Status = 4;

pub(super) type LogMessage = Option<
    unsafe extern "C" fn(
        environment: *mut c_void,
        status: Status,
        category: *const c_char,
        message: *const c_char,
    ),
>;

/// Object to which `fmi3Instance` points.
pub(super) struct Instance {
    pub(super) simulation: Simulation,
    pub(super) log: Log,
}

/// Destination of messages.
pub(super) struct Log {
    pub(super) environment: *mut c_void,
    pub(super) message: LogMessage,
}

impl Log {
    pub(super) fn write(&self, status: Status, message: &str) {
        let text = CString::new(message.replace('\0', " "));
        if let (Some(write), Ok(text)) = (self.message, text) {
            // SAFETY: the importer's own function, with its own environment; both texts end with a zero and outlive the call.
            unsafe { write(self.environment, status, c"logStatusError".as_ptr(), text.as_ptr()) };
        }
    }

    /// The value of a computation, or its error as a message and a status.
    pub(super) fn guard<T>(&self, compute: impl FnOnce() -> Result<T, FmuError>) -> Result<T, Status> {
        match catch_unwind(AssertUnwindSafe(compute)) {
            Ok(Ok(value)) => Ok(value),
            Ok(Err(error)) => {
                self.write(ERROR, &error.to_string());
                Err(ERROR)
            }
            Err(_) => {
                self.write(FATAL, "socam has a defect: the simulation ended in a panic");
                Err(FATAL)
            }
        }
    }
}

/// Calls into an instance. A null pointer is an error.
pub(super) unsafe fn within(
    instance: *mut Instance,
    call: impl FnOnce(&mut Simulation) -> Result<(), FmuError>,
) -> Status {
    // SAFETY: null, or an instance that was made here and that the importer does not use from two threads at once.
    let Some(Instance { simulation, log }) = (unsafe { instance.as_mut() }) else { return ERROR };
    log.guard(|| call(simulation)).map_or_else(|status| status, |()| OK)
}

/// An array of C. The pointer of an empty one may be null.
pub(super) unsafe fn array<'a, T>(first: *const T, count: usize) -> &'a [T] {
    // SAFETY: the importer passes `count` values at a pointer that is not null.
    if count == 0 || first.is_null() { &[] } else { unsafe { std::slice::from_raw_parts(first, count) } }
}

pub(super) unsafe fn text<'a>(text: *const c_char) -> &'a str {
    // SAFETY: null, or a text that ends with a zero.
    if text.is_null() { "" } else { unsafe { CStr::from_ptr(text) }.to_str().unwrap_or_default() }
}

/// Writes where the importer wants a value.
pub(super) unsafe fn put<T>(target: *mut T, value: T) {
    if !target.is_null() {
        // SAFETY: a variable of the importer.
        unsafe { target.write(value) };
    }
}

pub(super) fn refuse(problem: impl Into<String>) -> FmuError {
    FmuError::Argument(problem.into())
}
