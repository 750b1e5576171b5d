//! The guard below the stack.

/// Base of the guarded region: 64 KiB below the memory, where the stack begins (`memory.x`). No frame of this program is larger.
const BELOW_MEMORY: u32 = 0x1fff_0000;

/// Region number is in the base register.
const VALID: u32 = 1 << 4;
/// Execution and all access forbidden, 2^16 bytes, enabled.
const NO_ACCESS: u32 = 1 << 28 | 15 << 1 | 1;
/// The default map elsewhere, and the unit enabled.
const DEFAULT_MAP: u32 = 1 << 2 | 1;

/// Makes a stack that overflows a fault. Where the fault cannot be handled, because handling it needs the stack, the processor
/// locks up, and the watchdog resets it.
pub(crate) fn set(mpu: &cortex_m::peripheral::MPU) {
    // SAFETY: the region holds nothing.
    unsafe {
        mpu.rbar.write(BELOW_MEMORY | VALID);
        mpu.rasr.write(NO_ACCESS);
        mpu.ctrl.write(DEFAULT_MAP);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
