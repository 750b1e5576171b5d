//! The functions of FMI 3.0 that no importer calls for these FMUs: other interface types, other types of variables, clocks, events,
//! derivatives. Importers look every function up when they load the library, so all exist.

use std::ffi::c_void;

use super::pointers::{Instance, Status, refuse, within};

/// Functions that answer that they are absent. They take only the first of their arguments: in the calling conventions of all platforms
/// with binaries in FMUs the caller owns the others.
macro_rules! absent {
    ($($name:ident)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name(instance: *mut Instance) -> Status {
            let problem = concat!("this FMU does not provide ", stringify!($name));
            // SAFETY: an instance.
            unsafe { within(instance, |_| Err(refuse(problem))) }
        }
    )*};
}

absent! {
    fmi3ActivateModelPartition
    fmi3DeserializeFMUState
    fmi3EnterConfigurationMode
    fmi3EnterStepMode
    fmi3EvaluateDiscreteStates
    fmi3ExitConfigurationMode
    fmi3GetAdjointDerivative
    fmi3GetBinary
    fmi3GetBoolean
    fmi3GetClock
    fmi3GetDirectionalDerivative
    fmi3GetFloat32
    fmi3GetInt16
    fmi3GetInt32
    fmi3GetInt64
    fmi3GetInt8
    fmi3GetIntervalDecimal
    fmi3GetIntervalFraction
    fmi3GetNumberOfVariableDependencies
    fmi3GetOutputDerivatives
    fmi3GetShiftDecimal
    fmi3GetShiftFraction
    fmi3GetString
    fmi3GetUInt16
    fmi3GetUInt32
    fmi3GetUInt64
    fmi3GetUInt8
    fmi3GetVariableDependencies
    fmi3SerializeFMUState
    fmi3SerializedFMUStateSize
    fmi3SetBinary
    fmi3SetBoolean
    fmi3SetClock
    fmi3SetFloat32
    fmi3SetInt16
    fmi3SetInt32
    fmi3SetInt64
    fmi3SetInt8
    fmi3SetIntervalDecimal
    fmi3SetIntervalFraction
    fmi3SetShiftDecimal
    fmi3SetShiftFraction
    fmi3SetString
    fmi3SetUInt16
    fmi3SetUInt32
    fmi3SetUInt64
    fmi3SetUInt8
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateScheduledExecution(_name: *const c_void) -> *mut Instance {
    std::ptr::null_mut()
}
