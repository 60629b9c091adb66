//! Calls of code that may panic.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::report::{Finding, Law, Tally};

/// After this many panics nothing is called any more: each of them prints a message.
const ENOUGH: usize = 8;

/// How many calls are guarded together.
const BLOCK: usize = 4096;

/// Catches panics and remembers them.
#[derive(Debug, Default)]
pub(super) struct Calls {
    made: Cell<u64>,
    /// What is being called, for calls that are guarded together.
    name: Cell<&'static str>,
    panics: RefCell<Vec<String>>,
}

impl Calls {
    /// What `f` returns; nothing if it panics, or after too many panics.
    pub(super) fn try_call<T>(
        &self,
        what: impl FnOnce() -> String,
        f: impl FnOnce() -> T,
    ) -> Option<T> {
        if self.given_up() {
            return None;
        }
        self.made.set(self.made.get() + 1);
        match catch_unwind(AssertUnwindSafe(f)) {
            Ok(value) => Some(value),
            Err(payload) => {
                let text = format!("{} panicked: {}", what(), message(&*payload));
                self.panics.borrow_mut().push(text);
                // Dropping a payload may panic as well.
                std::mem::forget(payload);
                None
            }
        }
    }

    /// What `f` returns at every one of `xs`, NaN where it panics.
    ///
    /// Blocks are guarded as a whole, and number by number only where one of them panics.
    pub(super) fn numbers(&self, name: &str, xs: &[f64], f: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut values = Vec::with_capacity(xs.len());
        for block in xs.chunks(BLOCK) {
            let before = values.len();
            let all = AssertUnwindSafe(|| values.extend(block.iter().map(|x| f(*x))));
            if self.given_up() || catch_unwind(all).is_err() {
                values.truncate(before);
                values.extend(block.iter().map(|x| self.number(name, *x, &f)));
            } else {
                self.made.set(self.made.get() + block.len() as u64);
            }
        }
        values
    }

    /// What `f` returns at `x`; NaN if it panics.
    pub(super) fn number(&self, name: &str, x: f64, f: impl FnOnce(f64) -> f64) -> f64 {
        self.try_call(|| format!("{name}({x:?})"), || f(x)).unwrap_or(f64::NAN)
    }

    /// Says what is called next.
    pub(super) fn enter(&self, name: &'static str) {
        self.made.set(self.made.get() + 1);
        self.name.set(name);
    }

    /// What was called last.
    pub(super) fn name(&self) -> &'static str {
        self.name.get()
    }

    pub(super) fn given_up(&self) -> bool {
        self.panics.borrow().len() >= ENOUGH
    }

    /// The law that nothing panics.
    pub(super) fn finding(&self) -> Finding {
        let mut tally = Tally::new(Law::Panics);
        let panics = self.panics.borrow();
        for text in panics.iter() {
            tally.holds(false, || text.clone());
        }
        let mut finding = tally.finding();
        if let Some(first) = panics.first() {
            let (n, made) = (panics.len(), self.made.get());
            let end = if n < ENOUGH { "" } else { "; not called any more" };
            finding.detail = format!("{first} ({n} of {made} calls{end})");
        }
        finding
    }
}

fn message(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message")
}
