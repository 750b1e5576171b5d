//! Libraries that read formats of other programs may panic at a damaged file: their panics end here, and print nothing.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static IS_FENCED: Cell<bool> = const { Cell::new(false) };
}

/// The result of a function, `None` where it panicked; the panic prints nothing.
pub fn fenced<T>(read: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let usual = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_FENCED.get() {
                usual(panic);
            }
        }));
    });
    IS_FENCED.set(true);
    let result = catch_unwind(AssertUnwindSafe(read));
    IS_FENCED.set(false);
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::fenced;

    #[test]
    fn a_panic_ends_at_the_fence() {
        assert_eq!(fenced(|| 3), Some(3));
        assert_eq!(fenced(|| -> u32 { panic!("a defect of a library") }), None);
    }
}
