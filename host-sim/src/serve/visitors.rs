//! Events to visitors: a bounded queue for each, and the latest of each group for those that come
//! later.

use core::time::Duration;
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

const MOST_VISITORS: usize = 8;
/// Most texts and bytes that wait for a visitor.
const MOST_WAITING: usize = 64;
const MOST_BYTES: usize = 16 << 20;

/// Everybody who is sent events.
#[derive(Default)]
pub(super) struct Visitors {
    all: Mutex<All>,
}

#[derive(Default)]
struct All {
    queues: Vec<Arc<Queue>>,
    /// The last text of each group, in the order in which they were sent.
    latest: Vec<(&'static str, Arc<str>)>,
    is_over: bool,
}

/// Texts that wait for a visitor.
#[derive(Default)]
pub(super) struct Queue {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Default)]
struct Waiting {
    texts: VecDeque<Arc<str>>,
    bytes: usize,
    /// Texts that were dropped since the visitor was last told.
    dropped: u64,
    is_over: bool,
}

#[derive(Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// A text, behind so many that were dropped.
    Text(Arc<str>, u64),
    /// Nothing yet.
    Silence,
    /// Nothing any more.
    End,
}

/// Locks it; a thread that panicked left nothing half done.
fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Visitors {
    /// One more visitor, unless there are too many.
    pub(super) fn enter(&self) -> Option<Arc<Queue>> {
        let mut all = locked(&self.all);
        if all.queues.len() == MOST_VISITORS || all.is_over {
            return None;
        }
        let queue = Arc::new(Queue::default());
        all.latest.iter().for_each(|(_, text)| queue.push(Arc::clone(text)));
        all.queues.push(Arc::clone(&queue));
        Some(queue)
    }

    pub(super) fn leave(&self, queue: &Arc<Queue>) {
        locked(&self.all).queues.retain(|other| !Arc::ptr_eq(other, queue));
    }

    /// Sends a text to everybody; the last one of a group is kept for those that come later.
    pub(super) fn send(&self, group: &'static str, text: &Arc<str>) {
        let mut all = locked(&self.all);
        all.latest.retain(|(other, _)| *other != group);
        all.latest.push((group, Arc::clone(text)));
        all.queues.iter().for_each(|queue| queue.push(Arc::clone(text)));
    }

    /// No more comes.
    pub(super) fn end(&self) {
        let mut all = locked(&self.all);
        all.is_over = true;
        for queue in &all.queues {
            locked(&queue.waiting).is_over = true;
            queue.changed.notify_one();
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        locked(&self.all).queues.is_empty()
    }
}

impl Queue {
    fn push(&self, text: Arc<str>) {
        let mut waiting = locked(&self.waiting);
        waiting.bytes += text.len();
        waiting.texts.push_back(text);
        while waiting.texts.len() > MOST_WAITING
            || (waiting.bytes > MOST_BYTES && waiting.texts.len() > 1)
        {
            let oldest = waiting.texts.pop_front().map_or(0, |text| text.len());
            waiting.bytes -= oldest;
            waiting.dropped += 1;
        }
        self.changed.notify_one();
    }

    /// Waits for the next text.
    pub(super) fn next(&self, patience: Duration) -> Next {
        let waiting = locked(&self.waiting);
        let is_idle = |waiting: &mut Waiting| waiting.texts.is_empty() && !waiting.is_over;
        let outcome = self.changed.wait_timeout_while(waiting, patience, is_idle);
        let (mut waiting, _) = outcome.unwrap_or_else(PoisonError::into_inner);
        match waiting.texts.pop_front() {
            Some(text) => {
                waiting.bytes -= text.len();
                Next::Text(text, core::mem::take(&mut waiting.dropped))
            }
            None if waiting.is_over => Next::End,
            None => Next::Silence,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_TIME: Duration = Duration::ZERO;

    fn text(length: usize, letter: &str) -> Arc<str> {
        letter.repeat(length).into()
    }

    #[test]
    fn who_is_slow_loses_the_oldest_and_is_told() {
        let visitors = Visitors::default();
        let [slow, quick] = [0; 2].map(|_: u8| visitors.enter().unwrap());
        for number in 0..100 {
            visitors.send("pair", &number.to_string().into());
            assert_eq!(quick.next(NO_TIME), Next::Text(number.to_string().into(), 0));
        }
        assert_eq!(slow.next(NO_TIME), Next::Text("36".into(), 36));
        assert_eq!(slow.next(NO_TIME), Next::Text("37".into(), 0), "told once");
        // By their bytes: 17 of 1 MiB are one too many, and one alone is never dropped.
        let large = visitors.enter().unwrap();
        assert_eq!(large.next(NO_TIME), Next::Text("99".into(), 0), "the latest, at once");
        (0..17).for_each(|_| visitors.send("pair", &text(1 << 20, "x")));
        assert_eq!(large.next(NO_TIME), Next::Text(text(1 << 20, "x"), 1));
        visitors.send("pair", &text(20 << 20, "y"));
        assert_eq!(large.next(NO_TIME), Next::Text(text(20 << 20, "y"), 15));
        assert_eq!(large.next(NO_TIME), Next::Silence);
    }

    #[test]
    fn eight_visitors_enter_and_all_see_the_end() {
        let visitors = Visitors::default();
        visitors.send("pair", &"first".into());
        visitors.send("link", &"second".into());
        visitors.send("pair", &"third".into());
        let mut queues: Vec<_> = (0..MOST_VISITORS).map(|_| visitors.enter().unwrap()).collect();
        assert!(visitors.enter().is_none());
        visitors.leave(&queues.remove(0));
        assert!(visitors.enter().is_some(), "one has gone");
        visitors.end();
        assert!(visitors.enter().is_none());
        for queue in &queues {
            let found = [0; 3].map(|_: u8| queue.next(NO_TIME));
            assert_eq!(
                found,
                [Next::Text("second".into(), 0), Next::Text("third".into(), 0), Next::End]
            );
            visitors.leave(queue);
        }
        assert!(!visitors.is_empty());
    }
}
