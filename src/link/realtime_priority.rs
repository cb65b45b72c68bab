//! Threads that must wake up at exact times. Packets of a cyclic connection are due every few milliseconds, and
//! ordinary threads on a busy computer may wait longer than that.

use thread_priority::{Error, ThreadPriority};

/// Asks the system to schedule the calling thread before all ordinary threads until it ends. Returns whether the system
/// agreed, which on Linux requires a permission (`rtprio` among the user's limits).
pub fn wake_before_others() -> bool {
    let asked = ask();
    if let Err(error) = &asked {
        tracing::debug!("a thread of the cyclic connection is an ordinary one: {error}");
    }
    asked.is_ok()
}

/// Requests the lowest real-time priority, which is above all ordinary priorities.
#[cfg(unix)]
fn ask() -> Result<(), Error> {
    use thread_priority::unix::{
        RealtimeThreadSchedulePolicy, ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::RoundRobin);
    set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, policy)
}

#[cfg(not(unix))]
fn ask() -> Result<(), Error> {
    ThreadPriority::Max.set_for_current()
}
