//! One processor core or two: halves of a pair's work that share no memory they write to.
//!
//! In: two halves of a step. Out: both are done. What a run finds does not depend on who does which
//! half, nor when.

/// Two cores of a processor, as `rayon::join`: how a caller lends the second one to
/// [`Matcher::run_on`](crate::Matcher::run_on).
///
/// ```
/// use linestereo::Cores;
/// struct Threads;
/// impl Cores for Threads {
///     fn join(&mut self, here: &mut (dyn FnMut() + Send), there: &mut (dyn FnMut() + Send)) {
///         std::thread::scope(|scope| {
///             scope.spawn(there);
///             here();
///         });
///     }
/// }
/// ```
pub trait Cores {
    /// Calls both once, in any order or at the same time, and returns when both have returned. What
    /// either has written is seen afterwards, as after the end of a thread. Some 100 calls a pair.
    fn join(&mut self, here: &mut (dyn FnMut() + Send), there: &mut (dyn FnMut() + Send));
}

impl<C: Cores + ?Sized> Cores for &mut C {
    fn join(&mut self, here: &mut (dyn FnMut() + Send), there: &mut (dyn FnMut() + Send)) {
        (**self).join(here, there);
    }
}

/// One core: both halves, one after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct OneCore;

impl Cores for OneCore {
    fn join(&mut self, here: &mut (dyn FnMut() + Send), there: &mut (dyn FnMut() + Send)) {
        here();
        there();
    }
}

/// Calls both on the cores; without these one after the other.
#[inline(always)] // a call of its closures where there is one core
pub(crate) fn join(
    cores: Option<&mut dyn Cores>,
    mut here: impl FnMut() + Send,
    mut there: impl FnMut() + Send,
) {
    match cores {
        Some(cores) => cores.join(&mut here, &mut there),
        None => {
            here();
            there();
        }
    }
}

/// The cores, for a time.
#[inline(always)]
pub(crate) fn lend<'s>(cores: &'s mut Option<&mut dyn Cores>) -> Option<&'s mut dyn Cores> {
    match cores {
        Some(cores) => Some(&mut **cores),
        None => None,
    }
}
