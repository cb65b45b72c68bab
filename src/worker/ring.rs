//! A bounded ring for data that may be dropped, such as samples and trace frames. The writer never waits for the
//! reader: if the ring is full, the oldest entries are dropped and counted.

use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A bounded ring buffer, shared by all clones.
pub struct Ring<T>(Arc<Mutex<State<T>>>);

struct State<T> {
    items: VecDeque<T>,
    capacity: usize,
    /// Maximum total size of the entries in bytes, as measured by `size_of`.
    byte_limit: usize,
    size: usize,
    size_of: fn(&T) -> usize,
    dropped: u64,
}

impl<T> State<T> {
    fn drop_oldest(&mut self) -> Option<T> {
        let oldest = self.items.pop_front()?;
        self.size -= (self.size_of)(&oldest);
        self.dropped += 1;
        Some(oldest)
    }
}

impl<T> Ring<T> {
    /// Creates an empty ring for at most `capacity` entries. A capacity of 0 counts as 1.
    pub fn new(capacity: usize) -> Self {
        Ring::with_byte_limit(capacity, usize::MAX, |_| 0)
    }

    /// Creates an empty ring that is also limited to `byte_limit` bytes, as measured by `size_of`. The newest entry is
    /// always kept.
    pub fn with_byte_limit(capacity: usize, byte_limit: usize, size_of: fn(&T) -> usize) -> Self {
        let (items, capacity) = (VecDeque::new(), capacity.max(1));
        Ring(Arc::new(Mutex::new(State { items, capacity, byte_limit, size: 0, size_of, dropped: 0 })))
    }

    /// Appends an entry. A full ring drops its oldest entry.
    pub fn push(&self, item: T) {
        let mut state = self.lock();
        let size = (state.size_of)(&item);
        let mut oldest = if state.items.len() >= state.capacity { state.drop_oldest() } else { None };
        while state.size + size > state.byte_limit && !state.items.is_empty() {
            oldest = state.drop_oldest();
        }
        state.size += size;
        state.items.push_back(item);
        // Dropping an entry may take time and does not need the lock.
        drop(state);
        drop(oldest);
    }

    /// Takes all entries, oldest first, and the number of entries dropped since the previous call.
    pub fn drain(&self) -> (Vec<T>, u64) {
        let mut state = self.lock();
        let items = std::mem::take(&mut state.items);
        let dropped = std::mem::take(&mut state.dropped);
        state.size = 0;
        drop(state);
        (items.into(), dropped)
    }

    fn lock(&self) -> MutexGuard<'_, State<T>> {
        // Code that holds this lock cannot panic half-way, so a poisoned lock is still valid.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T> Clone for Ring<T> {
    fn clone(&self) -> Self {
        Ring(self.0.clone())
    }
}

impl<T> fmt::Debug for Ring<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let state = self.lock();
        write!(f, "Ring({} of {}, {} dropped)", state.items.len(), state.capacity, state.dropped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drains_items_once_in_order() {
        let ring = Ring::new(3);
        assert_eq!(ring.drain(), (vec![], 0));
        ring.push(1);
        ring.clone().push(2);
        assert_eq!(ring.drain(), (vec![1, 2], 0));
        assert_eq!(ring.drain(), (vec![], 0));
    }

    #[test]
    fn full_ring_drops_oldest() {
        let ring = Ring::new(3);
        (0..10).for_each(|item| ring.push(item));
        assert_eq!(format!("{ring:?}"), "Ring(3 of 3, 7 dropped)");
        assert_eq!(ring.drain(), (vec![7, 8, 9], 7));
        ring.push(10);
        assert_eq!(ring.drain(), (vec![10], 0), "the count begins anew");
    }

    #[test]
    fn zero_capacity_keeps_newest() {
        let ring = Ring::new(0);
        ring.push('a');
        ring.push('b');
        assert_eq!(ring.drain(), (vec!['b'], 1));
    }

    #[test]
    fn newest_items_fit_byte_limit() {
        let ring = Ring::with_byte_limit(9, 8, Vec::len);
        for item in [vec![1; 3], vec![2; 3], vec![3; 4], vec![4; 1]] {
            ring.push(item);
        }
        assert_eq!(ring.drain(), (vec![vec![2; 3], vec![3; 4], vec![4; 1]], 1));
        ring.push(vec![5; 4]);
        ring.push(vec![6; 99]);
        assert_eq!(ring.drain(), (vec![vec![6; 99]], 1), "one alone may be larger");
        ring.push(vec![7; 8]);
        assert_eq!(ring.drain(), (vec![vec![7; 8]], 0));
    }

    #[test]
    fn counts_losses_between_threads() {
        let ring = Ring::new(16);
        let (mut taken, mut dropped) = (0, 0);
        std::thread::scope(|scope| {
            let producer = scope.spawn(|| (0..10_000).for_each(|item| ring.push(item)));
            while !producer.is_finished() {
                let (items, lost) = ring.drain();
                assert!(items.windows(2).all(|pair| pair[0] < pair[1]));
                taken += items.len() as u64;
                dropped += lost;
            }
        });
        let (items, lost) = ring.drain();
        assert_eq!(taken + items.len() as u64 + dropped + lost, 10_000);
    }
}
