//! The functions of FMI 3.0 for model exchange: the importer integrates. There are no events: jumps of laws are rounded over a transition.

use std::ffi::{c_char, c_void};

use super::pointers::{Instance, LogMessage, OK, Status, array, put, refuse, within};
use super::{FmuError, Simulation, instantiate};

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging_on: bool,
    environment: *mut c_void,
    message: LogMessage,
) -> *mut Instance {
    // SAFETY: texts of the importer.
    unsafe { instantiate(token, resources, environment, message, Simulation::check_exchange) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterEventMode(instance: *mut Instance) -> Status {
    // SAFETY: an instance.
    unsafe { within(instance, |_| Ok(())) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterContinuousTimeMode(instance: *mut Instance) -> Status {
    // SAFETY: an instance.
    unsafe { within(instance, |_| Ok(())) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3UpdateDiscreteStates(
    _instance: *mut Instance,
    needs_update: *mut bool,
    terminate: *mut bool,
    nominals_changed: *mut bool,
    states_changed: *mut bool,
    next_event_defined: *mut bool,
    next_event_s: *mut f64,
) -> Status {
    // SAFETY: variables of the importer.
    unsafe {
        for flag in [needs_update, terminate, nominals_changed, states_changed, next_event_defined] {
            put(flag, false);
        }
        put(next_event_s, 0.0);
    }
    OK
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3CompletedIntegratorStep(
    _instance: *mut Instance,
    _no_restore_before: bool,
    event_mode: *mut bool,
    terminate: *mut bool,
) -> Status {
    // SAFETY: variables of the importer.
    unsafe {
        put(event_mode, false);
        put(terminate, false);
    }
    OK
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetTime(instance: *mut Instance, time_s: f64) -> Status {
    // SAFETY: an instance.
    unsafe { within(instance, |simulation| simulation.set_time(time_s)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetContinuousStates(
    instance: *mut Instance,
    states: *const f64,
    count: usize,
) -> Status {
    // SAFETY: an instance and an array of this length.
    unsafe { within(instance, |simulation| simulation.set_states(array(states, count))) }
}

/// Writes as many values as the importer has room for.
unsafe fn fill(values: &[f64], target: *mut f64, count: usize) -> Result<(), FmuError> {
    if values.len() != count || (target.is_null() && count > 0) {
        return Err(refuse(format!("room for {count} values of the {} states", values.len())));
    }
    // SAFETY: an array of `count` values.
    values.iter().enumerate().for_each(|(index, value)| unsafe { target.add(index).write(*value) });
    Ok(())
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetContinuousStates(
    instance: *mut Instance,
    states: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: an instance and an array of this length.
    unsafe { within(instance, |simulation| fill(&simulation.snapshot().state, states, count)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetContinuousStateDerivatives(
    instance: *mut Instance,
    derivatives: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: an instance and an array of this length.
    unsafe { within(instance, |simulation| fill(&simulation.derivatives()?, derivatives, count)) }
}

/// No state has a size that is known before the simulation.
#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNominalsOfContinuousStates(
    instance: *mut Instance,
    nominals: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: an instance and an array of this length.
    unsafe { within(instance, |s| fill(&vec![1.0; s.snapshot().state.len()], nominals, count)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNumberOfContinuousStates(instance: *mut Instance, count: *mut usize) -> Status {
    // SAFETY: an instance and a variable of the importer.
    unsafe {
        within(instance, |simulation| {
            put(count, simulation.snapshot().state.len());
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNumberOfEventIndicators(_instance: *mut Instance, count: *mut usize) -> Status {
    // SAFETY: a variable of the importer.
    unsafe { put(count, 0) };
    OK
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetEventIndicators(
    _instance: *mut Instance,
    _indicators: *mut f64,
    _count: usize,
) -> Status {
    OK
}
