//! FMI 3.0's C functions for co-simulation. The signatures are those of `fmi3FunctionTypes.h`.
//!
//! A panic must not cross into C: every function that computes catches it and returns `fmi3Error`. Types that a unit has no variables of are
//! answered with `fmi3Error` unless nothing is asked. Functions of the other interfaces are exported, because importers (FMPy) look up all of
//! them, and answer with `fmi3Error`.

use std::{
    ffi::{CStr, c_char, c_int, c_void},
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    slice,
};

use crate::{description::token, unit::Unit};

type Status = c_int;
const OK: Status = 0;
const ERROR: Status = 3;
type LogMessage = Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// What an `fmi3Instance` points to.
struct Instance {
    unit: Unit,
    text: String,
    environment: *mut c_void,
    log: LogMessage,
}

impl Instance {
    fn say(&self, sentence: &str) {
        say(self.log, self.environment, sentence);
    }
}

fn say(log: LogMessage, environment: *mut c_void, sentence: &str) {
    let text = std::ffi::CString::new(sentence.replace('\0', " "));
    if let (Some(log), Ok(text)) = (log, text) {
        // SAFETY: the importer gave the callback, and both strings end with a zero and outlive the call.
        unsafe { log(environment, ERROR, c"logStatusError".as_ptr(), text.as_ptr()) };
    }
}

/// Runs `action` on an instance.
///
/// # Safety
/// `instance` is null or comes from `fmi3InstantiateCoSimulation`, is not freed and is used by one thread at a time.
unsafe fn with(instance: *mut c_void, action: impl FnOnce(&mut Instance) -> Result<(), String>) -> Status {
    // SAFETY: see above.
    let Some(instance) = (unsafe { instance.cast::<Instance>().as_mut() }) else { return ERROR };
    match catch_unwind(AssertUnwindSafe(|| action(instance))) {
        Ok(Ok(())) => OK,
        Ok(Err(sentence)) => {
            instance.say(&sentence);
            ERROR
        }
        Err(_) => {
            instance.say("the model's computation failed");
            ERROR
        }
    }
}

/// A C string.
///
/// # Safety
/// `text` is null or ends with a zero.
unsafe fn string(text: *const c_char) -> Option<String> {
    // SAFETY: see above.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned())
}

/// `count` values of C.
///
/// # Safety
/// `values` points to `count` values unless `count` is zero.
unsafe fn list<'a, T>(values: *const T, count: usize) -> &'a [T] {
    // SAFETY: see above.
    if values.is_null() || count == 0 { &[] } else { unsafe { slice::from_raw_parts(values, count) } }
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)] // FMI's.
unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    instantiation_token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    _intermediates: usize,
    environment: *mut c_void,
    log: LogMessage,
    _intermediate_update: *const c_void,
) -> *mut c_void {
    // SAFETY: FMI gives strings that end with a zero.
    let (expected, folder) = unsafe { (string(instantiation_token), string(resources)) };
    let made = catch_unwind(|| {
        let path = Path::new(&folder.ok_or("no path of the resources was given")?).join("model.toml");
        let text = std::fs::read_to_string(&path)
            .map_err(|error| format!("cannot read `{}`: {error}", path.display()))?;
        if expected.as_deref() != Some(&token(&text)) {
            return Err("the instantiation token is not that of resources/model.toml".to_owned());
        }
        Ok((Unit::new(&text)?, text))
    });
    match made.unwrap_or_else(|_| Err("the model cannot be read".into())) {
        Ok((unit, text)) => Box::into_raw(Box::new(Instance { unit, text, environment, log })).cast(),
        Err(sentence) => {
            say(log, environment, &sentence);
            std::ptr::null_mut()
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateModelExchange() -> *mut c_void {
    std::ptr::null_mut()
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateScheduledExecution() -> *mut c_void {
    std::ptr::null_mut()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: FMI frees an instance once.
        drop(unsafe { Box::from_raw(instance.cast::<Instance>()) });
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    _has_tolerance: bool,
    _tolerance: f64,
    start_s: f64,
    _has_stop: bool,
    _stop_s: f64,
) -> Status {
    // SAFETY: FMI gives an instance of this library.
    unsafe {
        with(instance, |instance| {
            instance.unit.start(start_s);
            Ok(())
        })
    }
}

/// Start values may be set until here.
#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut c_void) -> Status {
    // SAFETY: FMI gives an instance of this library.
    unsafe {
        with(instance, |instance| {
            instance.unit.start(instance.unit.time_s());
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3Reset(instance: *mut c_void) -> Status {
    // SAFETY: FMI gives an instance of this library.
    unsafe {
        with(instance, |instance| {
            instance.unit = Unit::new(&instance.text)?;
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    _point_s: f64,
    step_s: f64,
    _no_state_before: bool,
    event_needed: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_s: *mut f64,
) -> Status {
    let mut reached_s = f64::NAN;
    // SAFETY: FMI gives an instance of this library.
    let status = unsafe {
        with(instance, |instance| {
            let done = instance.unit.step(step_s);
            reached_s = instance.unit.time_s();
            done
        })
    };
    // SAFETY: FMI gives places of these types, or null.
    unsafe {
        for flag in [event_needed, terminate, early_return] {
            if let Some(flag) = flag.as_mut() {
                *flag = false;
            }
        }
        if let Some(last_s) = last_s.as_mut() {
            *last_s = reached_s;
        }
    }
    status
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut f64,
    places: usize,
) -> Status {
    // SAFETY: FMI gives an instance of this library and arrays of these lengths.
    unsafe {
        with(instance, |instance| {
            let found = instance.unit.get(list(references, count))?;
            if found.len() != places {
                return Err(format!("{places} places for {} values", found.len()));
            }
            if !found.is_empty() && !values.is_null() {
                slice::from_raw_parts_mut(values, places).copy_from_slice(&found);
            }
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const f64,
    places: usize,
) -> Status {
    // SAFETY: FMI gives an instance of this library and arrays of these lengths.
    unsafe {
        with(instance, |instance| {
            let (references, values) = (list(references, count), list(values, places));
            if references.len() != values.len() {
                return Err(format!("{places} values for {count} variables"));
            }
            references
                .iter()
                .zip(values)
                .try_for_each(|(reference, value)| instance.unit.set(*reference, *value))
        })
    }
}

/// Getters and setters of types that no variable has. Further arguments of C are ignored: in the calling conventions of 64-bit platforms the
/// caller removes them.
macro_rules! no_variables {
    ($($name:ident)*) => { $(
        #[unsafe(no_mangle)]
        extern "C" fn $name(_: *mut c_void, _: *const u32, count: usize) -> Status {
            if count == 0 { OK } else { ERROR }
        }
    )* };
}

no_variables! {
    fmi3GetFloat32 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16 fmi3GetUInt16 fmi3GetInt32 fmi3GetUInt32 fmi3GetInt64 fmi3GetUInt64
    fmi3GetBoolean fmi3GetString fmi3GetBinary fmi3GetClock
    fmi3SetFloat32 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetInt32 fmi3SetUInt32 fmi3SetInt64 fmi3SetUInt64
    fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
}

/// Functions that change nothing here: logging is by errors only, and there are neither events nor tunable parameters.
macro_rules! nothing_to_do {
    ($($name:ident)*) => { $(
        #[unsafe(no_mangle)]
        extern "C" fn $name(_: *mut c_void) -> Status {
            OK
        }
    )* };
}

nothing_to_do! { fmi3SetDebugLogging fmi3Terminate }

/// Functions whose capability the description does not claim.
macro_rules! not_offered {
    ($($name:ident)*) => { $(
        #[unsafe(no_mangle)]
        extern "C" fn $name(_: *mut c_void) -> Status {
            ERROR
        }
    )* };
}

not_offered! {
    fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep fmi3SetTime fmi3SetContinuousStates fmi3GetContinuousStateDerivatives
    fmi3GetEventIndicators fmi3GetContinuousStates fmi3GetNominalsOfContinuousStates fmi3GetNumberOfEventIndicators
    fmi3GetNumberOfContinuousStates
    fmi3EnterEventMode fmi3EnterStepMode fmi3EnterConfigurationMode fmi3ExitConfigurationMode fmi3UpdateDiscreteStates fmi3EvaluateDiscreteStates
    fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState fmi3SerializedFMUStateSize
    fmi3SerializeFMUState fmi3DeserializeFMUState fmi3GetDirectionalDerivative fmi3GetAdjointDerivative fmi3GetOutputDerivatives
    fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction fmi3SetIntervalDecimal fmi3SetIntervalFraction
    fmi3SetShiftDecimal fmi3SetShiftFraction fmi3ActivateModelPartition
}
