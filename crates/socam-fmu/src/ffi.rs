//! The C functions of FMI 3.0: here those of all interfaces and of co-simulation, in `exchange` those of model exchange.
//!
//! This module is the only one with `unsafe` code, because C passes pointers and finds functions by their names. Each function turns its pointers
//! into slices and an instance, and calls [`Simulation`]. A panic becomes `fmi3Fatal`, an error `fmi3Error` with a log message; neither
//! crosses the boundary. Pointers are those that the standard promises: an instance is one that was made here and not freed, an array has
//! the length that is passed beside it.
#![allow(unsafe_code)]

mod absent;
mod exchange;
mod pointers;

use std::ffi::{c_char, c_void};
use std::path::Path;

use socam_model::Model;

use crate::{FmuError, Simulation, Snapshot, description, package};
use pointers::{Instance, Log, LogMessage, OK, Status, array, put, refuse, text, within};

fn open(token: &str, resources: &str) -> Result<Simulation, FmuError> {
    let path = Path::new(resources).join(package::MODEL_FILE);
    let read = std::fs::read_to_string(&path);
    let model_text = read.map_err(|source| FmuError::File { path, source })?;
    if token != description::token(&model_text) {
        let problem =
            "the instantiation token is not that of the model file in the resources; write the FMU again";
        return Err(refuse(problem));
    }
    Simulation::new(Model::parse(&model_text)?)
}

/// An instance that passes `check`; null, and a message, where there is none.
unsafe fn instantiate(
    token: *const c_char,
    resources: *const c_char,
    environment: *mut c_void,
    message: LogMessage,
    check: impl FnOnce(&Simulation) -> Result<(), FmuError>,
) -> *mut Instance {
    let log = Log { environment, message };
    // SAFETY: texts of the importer.
    let (token, resources) = unsafe { (text(token), text(resources)) };
    let opened = log.guard(|| {
        let simulation = open(token, resources)?;
        check(&simulation)?;
        Ok(simulation)
    });
    opened.map_or(std::ptr::null_mut(), |simulation| Box::into_raw(Box::new(Instance { simulation, log })))
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetDebugLogging(
    _instance: *mut Instance,
    _logging_on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> Status {
    OK
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging_on: bool,
    event_mode_used: bool,
    _early_return_allowed: bool,
    _intermediate: *const u32,
    intermediate_count: usize,
    environment: *mut c_void,
    message: LogMessage,
    _intermediate_update: *const c_void,
) -> *mut Instance {
    let is_plain = !event_mode_used && intermediate_count == 0;
    let missing = || refuse("there is neither an event mode nor an intermediate update");
    let check = |_: &Simulation| is_plain.then_some(()).ok_or_else(missing);
    // SAFETY: texts of the importer.
    unsafe { instantiate(token, resources, environment, message, check) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeInstance(instance: *mut Instance) {
    if !instance.is_null() {
        // SAFETY: made by `Box::into_raw` and not freed before.
        drop(unsafe { Box::from_raw(instance) });
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut Instance,
    _tolerance_defined: bool,
    _tolerance: f64,
    start_s: f64,
    _stop_defined: bool,
    _stop_s: f64,
) -> Status {
    // SAFETY: an instance.
    unsafe { within(instance, |simulation| simulation.start_at(start_s)) }
}

/// Computes the outputs, so that parameters without equations are refused here.
#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut Instance) -> Status {
    // SAFETY: an instance.
    unsafe { within(instance, |simulation| simulation.outputs().map(drop)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3Terminate(instance: *mut Instance) -> Status {
    // SAFETY: an instance.
    unsafe { within(instance, |_| Ok(())) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3Reset(instance: *mut Instance) -> Status {
    let reset = |simulation: &mut Simulation| {
        simulation.reset();
        Ok(())
    };
    // SAFETY: an instance.
    unsafe { within(instance, reset) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> Status {
    // SAFETY: an instance and two arrays of the lengths that are checked.
    unsafe {
        within(instance, |simulation| {
            if count != value_count || (values.is_null() && count > 0) {
                return Err(refuse(format!("{count} value references for {value_count} values")));
            }
            let references: Vec<usize> = array(references, count).iter().map(|r| *r as usize).collect();
            let found = simulation.get(&references)?;
            found.iter().enumerate().for_each(|(index, value)| values.add(index).write(*value));
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut Instance,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> Status {
    // SAFETY: an instance and two arrays of these lengths.
    unsafe {
        within(instance, |simulation| {
            if count != value_count {
                return Err(refuse(format!("{count} value references for {value_count} values")));
            }
            let pairs = array(references, count).iter().zip(array(values, count));
            pairs.into_iter().try_for_each(|(reference, value)| simulation.set(*reference as usize, *value))
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DoStep(
    instance: *mut Instance,
    from_s: f64,
    step_s: f64,
    _no_restore_before: bool,
    event_needed: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_s: *mut f64,
) -> Status {
    // SAFETY: an instance and four variables of the importer.
    unsafe {
        put(event_needed, false);
        put(terminate, false);
        put(early_return, false);
        within(instance, |simulation| {
            let now_s = simulation.snapshot().time_s;
            // Importers add up step sizes or multiply them, with another rounding.
            let is_here = (from_s - now_s).abs() <= 1e-6 * step_s.abs();
            let stepped = if is_here {
                simulation.step(step_s)
            } else {
                Err(refuse(format!("a step from {from_s} s was asked for, but the time is {now_s} s")))
            };
            put(last_s, simulation.snapshot().time_s);
            stepped
        })
    }
}

/// The present state, into `state` if that is one already.
#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFMUState(instance: *mut Instance, state: *mut *mut Snapshot) -> Status {
    // SAFETY: an instance, and a variable that is null or a state that was made here and not freed.
    unsafe {
        within(instance, |simulation| {
            let slot = state.as_mut().ok_or_else(|| refuse("there is no place for the state"))?;
            match slot.as_mut() {
                Some(kept) => kept.clone_from(simulation.snapshot()),
                None => *slot = Box::into_raw(Box::new(simulation.snapshot().clone())),
            }
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFMUState(instance: *mut Instance, state: *const Snapshot) -> Status {
    // SAFETY: an instance, and null or a state that was made here and not freed.
    unsafe {
        within(instance, |simulation| {
            simulation.restore(state.as_ref().ok_or_else(|| refuse("there is no state to restore"))?)
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeFMUState(instance: *mut Instance, state: *mut *mut Snapshot) -> Status {
    // SAFETY: an instance, and a variable that is null or a state that was made here and not freed.
    unsafe {
        within(instance, |_| {
            if let Some(slot) = state.as_mut()
                && !slot.is_null()
            {
                drop(Box::from_raw(std::mem::replace(slot, std::ptr::null_mut())));
            }
            Ok(())
        })
    }
}
